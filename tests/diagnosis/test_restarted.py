"""A hypothesis that settled in another valley is begun again from each of its starts."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from effects.trains import campaign_in, situation_of
from permway.diagnosis.catalogue import bogie_modes
from permway.diagnosis.compete import Ring
from permway.diagnosis.restarted import restarted

TRUE = {"participation": -0.73, "frequency_Hz": 34.3, "loss_factor": 0.058}


def test_a_bending_frame_is_found_from_another_of_its_starts(tmp_path: Path) -> None:
    """Begun at 98 Hz it stays there, and gains a ninth of what there is."""
    owner = campaign_in(tmp_path)
    frames = next(iter(bogie_modes.hypotheses(situation_of(owner, 3))))
    lacking = situation_of(owner, 3, amend=lambda campaign: frames.amend(campaign, TRUE))
    hypothesis, ring = next(iter(bogie_modes.hypotheses(lacking))), Ring(lacking.fit)
    far = next(start for start in hypothesis.starts if hypothesis.free[1].value(start[1]) > 90.0)
    begun = replace(ring.quick(replace(hypothesis, starts=(far,))), hypothesis=hypothesis)
    assert begun.values["frequency_Hz"] > 90.0
    found = restarted(ring, begun)
    assert found.hypothesis is hypothesis
    assert found.gain > 5.0 * begun.gain > 0.0
    assert found.values == pytest.approx(TRUE, rel=0.05)
    # What is in the right valley stays there, and what changes the line is left as it is.
    assert restarted(ring, found) is found
    line = replace(begun, hypothesis=replace(hypothesis, domain="path"))
    assert restarted(ring, line) is line
