"""How much less parameters are known because no thermometer is exact.

How much stiffer a rubber is in the cold is told for every kelvin that was read: by thousands of lines to some
ten-thousandths, where two thermometers agree to half a kelvin at best.
"""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.evidence import Evidence
from permway.diagnosis.fit import Build, Fit
from permway.diagnosis.quick import stacked
from permway.diagnosis.search import Finalist
from permway.errors import InputError, SolveError

OFF_K = 0.5
"""Standard deviation by which what was read may be off what the structure had."""

STEP_K = 0.01
"""Of finite differences."""


def misread(fit: Fit, accepted: Sequence[Finalist]) -> Reals:
    """Variance of the parameters' z, shape (p,); all that was measured at one temperature is off together.

    Parameters
    ----------
    fit : Fit
        With the effects in it.
    accepted : sequence of Finalist
        The effects, in the order in which they stand on each other.
    """
    evidence, found = fit.evidence, np.zeros(fit.z.size)
    read = {c.temperature_C for c in evidence.campaign.stated.conditions} - {None}
    values, reduced = fit.values(), evidence.whitener.reduce(fit.jacobian)
    solved = evidence.predicted(_built(evidence.campaign, None, accepted)(values))
    plain = evidence.deviations(solved.datasets)
    for temperature in sorted(t for t in read if t is not None):
        moved = _moved(evidence, temperature, accepted, values)
        if moved is None:
            continue
        off = (moved - plain) * (OFF_K / STEP_K)
        slope = (fit.jacobian.T @ off - reduced.T @ evidence.whitener.reduce(off)) / fit.heat
        found += (fit.covariance @ slope) ** 2
    return found


def _moved(
    evidence: Evidence, temperature_C: float, accepted: Sequence[Finalist], values: Mapping[str, float]
) -> Reals | None:
    """Deviations with one temperature a little off; None if no law knows what is beside it."""
    for step in (STEP_K, -STEP_K):
        # A law may end at just this temperature: then from its other side, which counts alike.
        with contextlib.suppress(InputError, SolveError):
            campaign = _built(evidence.campaign, temperature_C, accepted, step)(values)
            return evidence.deviations(evidence.predicted(campaign).datasets)
    return None


def _shifted(campaign: Campaign, temperature_C: float | None, step_K: float) -> Campaign:
    """As if it had been so much warmer wherever this was read; as it is without one."""
    if temperature_C is None:
        return campaign
    conditions = tuple(
        c.model_copy(update={"temperature_C": temperature_C + step_K}) if c.temperature_C == temperature_C else c
        for c in campaign.stated.conditions
    )
    said = campaign.stated.model_copy(update={"conditions": conditions})
    return replace(campaign, stated=said)


def _built(
    campaign: Campaign, temperature_C: float | None, accepted: Sequence[Finalist], step_K: float = 0.0
) -> Build:
    """From values to the campaign with the effects, so much warmer before they are put in."""

    def base(values: Mapping[str, float]) -> Campaign:
        return _shifted(campaign.with_values(values), temperature_C, step_K)

    build: Build = base
    for one in accepted:
        build, _ = stacked(build, one.hypothesis, one.prefix)
    return build
