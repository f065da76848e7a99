"""Parameters that the records tell together alone: a fit comes to rest where priors want it, not on the way."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import with_fields
from permway.diagnosis.fit import Fit, free_parameters
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import log_free
from permway.diagnosis.recalibrate import recalibrate
from permway.model.bodies import Beam
from simulated import simulate

MORE = log_free("more", "kg/m", 300.0, 2.0)
DENSITY = log_free("density", "kg/m3", 2500.0, 1.05)
"""Together they are the deck's mass; the one is free in its logarithm, so what the records allow is a curve."""


def _predicted(fit: Fit) -> float:
    """What one step by the slopes at the end would lower the objective by."""
    whitener = fit.observations.whitener
    inner = whitener.reduce(fit.jacobian).T @ whitener.reduce(fit.residuals)
    slope = (fit.jacobian.T @ fit.residuals - inner) / fit.inflation + fit.z
    return float(slope @ fit.covariance @ slope)


@pytest.mark.parametrize("noise", [0.01, 0.001])
def test_all_starts_lead_to_the_same_place(tmp_path: Path, noise: float) -> None:
    campaign = simulate(tmp_path / "c", 8, noise=noise, smooth=0.0).campaign
    observations = gather(campaign, threads=1)
    free = (*free_parameters(campaign), MORE, DENSITY)

    def build(values: Mapping[str, float]) -> Campaign:
        own = {name: value for name, value in values.items() if name in campaign.parameters.known}
        made = campaign.with_values(own)
        deck = made.model.line.bodies["deck"]
        assert isinstance(deck, Beam)
        dense = values["density"] + values["more"] / deck.area_m2
        return with_fields(made, "deck", density_kg_per_m3=dense)

    begun = recalibrate(observations).z
    fits = [
        recalibrate(observations, build=build, free=free, start=np.array([*begun, *z]))
        for z in ((-6.0, -0.1), (-4.0, 0.0), (0.0, -1.6), (2.0, -1.0))
    ]
    for fit in fits:
        assert _predicted(fit) < 0.5
        assert fit.objective == pytest.approx(min(f.objective for f in fits), abs=0.5)
