"""A hypothesis as far as it was followed while the base moves linearly, and with the base under it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from scipy import optimize

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.fit import Build, Free
from permway.diagnosis.hypothesis import Hypothesis


@dataclass(frozen=True)
class Quick:
    """What a hypothesis gains while the base moves linearly.

    Attributes
    ----------
    hypothesis : Hypothesis
    z : ndarray
        Of the effect's parameters.
    base_z : ndarray
        Of the base's parameters, moved along.
    gain : float
        Of the heated objective; minus infinity if the amended model cannot be solved.
    columns : ndarray of float32, shape (n, p), optional
        Derivative of the deviations by z, where it was last taken.
    direction : ndarray of float32, shape (n,), optional
        What the start that it was screened from does to the deviations.
    start : ndarray, optional
        Coordinates of that start.
    promise : float
        What the change that the start makes would gain, if it could be taken in any measure.
    """

    hypothesis: Hypothesis
    z: Reals
    base_z: Reals
    gain: float
    columns: np.ndarray | None = None
    direction: np.ndarray | None = None
    start: Reals | None = None
    promise: float = 0.0

    @property
    def numbers(self) -> dict[str, Any]:
        """All but the hypothesis, by name."""
        return {one.name: getattr(self, one.name) for one in fields(self) if one.name != "hypothesis"}

    @property
    def values(self) -> dict[str, float]:
        """Of the effect's parameters, by name."""
        return {f.name: f.value(float(v)) for f, v in zip(self.hypothesis.free, self.z, strict=True)}


def stacked(
    build: Build, hypothesis: Hypothesis, prefix: str, campaign: Campaign | None = None
) -> tuple[Build, tuple[Free, ...]]:
    """A base with an effect on top: from values to the campaign, and the effect's parameters by their new names.

    Parameters
    ----------
    build : callable
        The base's.
    hypothesis : Hypothesis
    prefix : str
        Before the names of the effect's parameters, as "1.": two effects may be of one kind.
    campaign : Campaign, optional
        Whose nominal parameters a hypothesis may move.
    """
    names = {prefix + f.name: f.name for f in hypothesis.free}

    def made(values: Mapping[str, float]) -> Campaign:
        nominal = {k: v for k, v in values.items() if k not in names}
        if hypothesis.moves and campaign is not None:
            known = campaign.parameters.known[hypothesis.moves]
            shift = values[prefix + hypothesis.free[0].name]
            nominal[hypothesis.moves] = known.value(known.z(nominal[hypothesis.moves]) + shift)
        base = build(nominal)
        return hypothesis.amend(base, {names[k]: v for k, v in values.items() if k in names})

    free = tuple(Free(prefix + f.name, f.unit, f.value, f.limits) for f in hypothesis.free)
    return made, free


def weaker(hypothesis: Hypothesis, z: Reals, share: float) -> list[Reals]:
    """The same with a size so much nearer to none; nothing where an effect has no such size.

    Parameters
    ----------
    hypothesis : Hypothesis
    z : ndarray
        Of its parameters.
    share : float
        Of how far the size is from none.
    """
    names = [f.name for f in hypothesis.free]
    if not 0.0 < share < 1.0 or hypothesis.size not in names or np.isinf(hypothesis.none):
        return []
    place = names.index(hypothesis.size)
    free = hypothesis.free[place]
    size = hypothesis.none + share * (free.value(float(z[place])) - hypothesis.none)
    low, high = free.limits
    if (free.value(low) - size) * (free.value(high) - size) >= 0.0:
        return []
    found = z.copy()
    found[place] = optimize.brentq(lambda one: free.value(one) - size, low, high)
    return [found]
