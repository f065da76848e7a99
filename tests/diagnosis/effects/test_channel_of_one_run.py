"""A channel that one run has and another has not, as where screening found one of its records bad."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from permway.diagnosis.catalogue import hypotheses
from permway.diagnosis.catalogue._runs import combs, excesses
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.recalibrate import recalibrate
from trains import ON_BOARD, campaign_in, drawn

MISSING = "floor"


def test_every_effect_is_offered_and_the_other_run_constrains_the_channel(tmp_path: Path) -> None:
    nominal_campaign = campaign_in(tmp_path)
    datasets = drawn(nominal_campaign, 5)
    left = [name for name in ON_BOARD if name != MISSING]
    last = datasets[-1]
    datasets[-1] = replace(last, data=last.data.sel(channel=left, channel2=left))
    situation = Situation(recalibrate(gather(nominal_campaign, datasets, threads=1)), ())
    whole, part = excesses(situation)
    at = np.array([20.0, 40.0])
    assert np.isfinite(whole.score_at(at, MISSING)).all()
    assert np.isnan([part.score_at(at, MISSING), part.neper_at(at, MISSING)]).all()
    (alone,) = combs([whole], [0.3], harmonics=None, decay=1.0, most=1, channel=MISSING)
    assert combs([whole, part], [0.3], harmonics=None, decay=1.0, most=1, channel=MISSING) == [alone]
    names = {hypothesis.entry for hypothesis in hypotheses(situation)}
    assert {"mains_lines", "wheel_polygon", "sensor_gain"} <= names
