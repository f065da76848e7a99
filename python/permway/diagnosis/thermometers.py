"""How much less parameters are known because no thermometer is exact.

How much stiffer a rubber is in the cold is told for every kelvin that was read: by thousands of lines to some
ten-thousandths, where two thermometers agree to half a kelvin at best.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.fit import Build, Fit
from permway.diagnosis.quick import stacked
from permway.diagnosis.search import Finalist
from permway.recordings.campaign import Campaign

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
    read = {c.temperature_C for c in evidence.campaign.said.conditions} - {None}
    values, reduced = fit.values(), evidence.whitener.reduce(fit.jacobian)
    solved = evidence.predicted(_built(evidence.campaign, None, accepted)(values))
    plain = evidence.deviations(solved.datasets)
    for temperature in sorted(t for t in read if t is not None):
        after = evidence.predicted(_built(evidence.campaign, temperature, accepted)(values), solved)
        off = (evidence.deviations(after.datasets) - plain) * (OFF_K / STEP_K)
        slope = (fit.jacobian.T @ off - reduced.T @ evidence.whitener.reduce(off)) / fit.heat
        found += (fit.covariance @ slope) ** 2
    return found


def _warmer(campaign: Campaign, temperature_C: float | None) -> Campaign:
    """As if it had been a little warmer wherever this was read; as it is without one."""
    if temperature_C is None:
        return campaign
    conditions = tuple(
        c.model_copy(update={"temperature_C": temperature_C + STEP_K}) if c.temperature_C == temperature_C else c
        for c in campaign.said.conditions
    )
    said = campaign.said.model_copy(update={"conditions": conditions})
    return Campaign(said, campaign.model, campaign.folder, campaign.parameters)


def _built(campaign: Campaign, temperature_C: float | None, accepted: Sequence[Finalist]) -> Build:
    """From values to the campaign with the effects, a little warmer before they are put in."""

    def base(values: Mapping[str, float]) -> Campaign:
        return _warmer(campaign.with_values(values), temperature_C)

    build: Build = base
    for one in accepted:
        build, _ = stacked(build, one.hypothesis, one.prefix)
    return build
