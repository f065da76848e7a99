"""What an amended model predicts of records that were left out."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._interval import weakened
from permway.diagnosis.gather import gather
from permway.posterior.cells import cells, coordinate
from permway.posterior.fit import grown
from permway.posterior.fitter import Fitter
from permway.posterior.held_out import gains
from permway.posterior.recalibrated import recalibrated
from simulated import simulate

LOST = {"centre_m": 6.0, "length_m": 1.2, "factor": 0.1}


def lost(campaign: Campaign) -> Campaign:
    return weakened(campaign, "pad", LOST["centre_m"], LOST["length_m"], LOST["factor"])


def test_a_stretch_stays_where_it_is_when_a_sensor_is_left_out(tmp_path: Path) -> None:
    """Its ends have no slope between joints; the prior of a stretch elsewhere does not draw them away."""
    base = recalibrated(gather(simulate(tmp_path, 31, amend=lost).campaign, threads=1))
    far, z = 0.0, None
    for cell in cells(base):
        if cell.hypothesis.entry == "fastener_loss" and {f.name for f in cell.hypothesis.free} == set(LOST):
            at = [coordinate(free, LOST[free.name]) for free in cell.hypothesis.free]
            if None not in at and far < abs(at[0]) < 3.0:
                far, z, hypothesis = abs(at[0]), np.array(at), cell.hypothesis
    assert z is not None
    assert far > 1.0
    fitter = Fitter(base.frame)
    start = fitter.begin(grown(base, hypothesis, "1."), np.concatenate([base.z, z]), base.hyper.exact())
    amended = fitter.settled(fitter.fit(start, steps=8))
    levels = base.frame.observations.levels_dB(amended.state.solved.datasets)
    of = base.frame.observations.rows.sensor
    for gain in gains(base, amended):
        if gain.axis == "sensor":
            own = levels[(of == gain.name) & np.isfinite(levels)]
            assert gain.after_dB < 1.2 * float(np.sqrt(np.mean(own**2))) < gain.before_dB
