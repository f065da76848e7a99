"""What rivals foretell of records that are left out: all of the same parts, against the diagnosis' own base.

What a rival names is fitted once more on records whose errors are smooth, so that all are asked the same: whether
it foretells more than a recalibrated model. By their own lights, with errors that know nothing of their
neighbours, they would foretell nothing.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from permway.diagnosis.discrepancy import Discrepancy, beyond
from permway.diagnosis.fit import Fit
from permway.diagnosis.heldout import Part, Rest, Scored, error_dB, gain, parts
from permway.diagnosis.recalibrate import recalibrate

MOST_STEPS = 8
"""Of a rival's fit, which begins near its end."""

HeldOut = dict[str, dict[str, float | None]]
"""By part, as a verdict has it."""


class LeftOut:
    """Parts that are left out in turn, and how well a base that is fitted to the rest foretells them.

    Parameters
    ----------
    base : Fit
        Recalibrated, as a diagnosis begins.
    """

    def __init__(self, base: Fit) -> None:
        self._base, rest = base, Rest(base)
        self._before = [(part, rest.scored(part.rows)) for part in parts(base.evidence)]

    def base(self) -> HeldOut:
        """Of a method that amends nothing."""
        return self._told((part, before, before) for part, before in self._before)

    def amended(self, fit: Fit) -> HeldOut:
        """Of an amended model, fitted to the rest as well."""
        known = recalibrate(
            self._base.evidence,
            build=fit.build,
            free=fit.free,
            start=fit.z,
            learn=False,
            reweigh=False,
            most_steps=MOST_STEPS,
        )
        rest = Rest(known)
        return self._told((part, before, rest.scored(part.rows)) for part, before in self._before)

    def with_discrepancy(self, found: Discrepancy) -> HeldOut:
        """Of a model with a discrepancy, which the rest tells of.

        Where a pair's other lines are among the rest, its density is told too well: a pair's errors are taken out
        of all its lines together.
        """
        evidence = found.on(self._base.evidence)
        fit = recalibrate(evidence, start=self._base.z, learn=False, reweigh=False, most_steps=MOST_STEPS)
        rest = Rest(fit)

        def scored(part: Part) -> Scored:
            _, _, levels = rest.fitted(~part.rows)
            after = error_dB(evidence, beyond(evidence, levels, ~part.rows), part.rows)
            return replace(rest.scored(part.rows), error_dB=after)

        return self._told((part, before, scored(part)) for part, before in self._before)

    def _told(self, each: Iterator[tuple[Part, Scored, Scored]]) -> HeldOut:
        told: HeldOut = {}
        for part, before, after in each:
            one = gain(part, before, after)
            told[_key(part)] = {
                "gain_nats": one.nats,
                "standard_error": one.standard_error,
                "db_before": _number(one.before_dB),
                "db_after": _number(one.after_dB),
            }
        return told


def _key(part: Part) -> str:
    return f"{part.axis}: {part.name}"


def _number(value: float) -> float | None:
    """What JSON can hold."""
    return value if np.isfinite(value) else None
