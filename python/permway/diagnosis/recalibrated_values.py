"""The parameters of the campaign file as a fit has them: the one source for verdict, pages and comparison."""

from __future__ import annotations

from permway.diagnosis.fit import Fit
from permway.diagnosis.verdict_parts import Moved


def recalibrated_of(fit: Fit) -> dict[str, Moved]:
    """Value, z and 90 % interval by name, of those parameters of a fit that the campaign file has."""
    known = fit.observations.campaign.parameters.known
    values, ends = fit.values(), {name: sorted(pair) for name, pair in fit.intervals().items()}
    return {
        f.name: Moved(
            value=values[f.name],
            prior=known[f.name].nominal,
            z=float(z),
            low=ends[f.name][0],
            high=ends[f.name][1],
            unit=known[f.name].parameter.unit,
        )
        for f, z in zip(fit.free, fit.z, strict=True)
        if f.name in known
    }
