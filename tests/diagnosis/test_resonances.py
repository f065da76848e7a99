"""A resonance that was begun in another valley is found along frequency."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from effects.trains import campaign_in, situation_of
from permway.diagnosis.catalogue import axlebox_absorber
from permway.diagnosis.compete import Ring
from permway.diagnosis.resonances import retuned

TRUE = {"mass_kg": 40.0, "frequency_Hz": 110.0, "loss_factor": 0.1}


@pytest.mark.parametrize("seed", [3, 4])
def test_a_resonance_is_found_from_another_valley(tmp_path: Path, seed: int) -> None:
    """Begun far above it ends as a mass that hangs on almost rigidly, and gains a third of what there is."""
    owner = campaign_in(tmp_path)
    hypothesis = next(iter(axlebox_absorber.hypotheses(situation_of(owner, seed))))
    ring = Ring(situation_of(owner, seed, amend=lambda campaign: hypothesis.amend(campaign, TRUE)).fit)
    begun = ring.quick(replace(hypothesis, starts=((0.0, 2.0, 0.3),)))
    assert begun.values["frequency_Hz"] > 200.0
    found = retuned(ring, begun)
    assert found.gain > 3.0 * begun.gain > 0.0
    assert found.values["frequency_Hz"] == pytest.approx(TRUE["frequency_Hz"], rel=0.03)
    assert found.values["mass_kg"] == pytest.approx(TRUE["mass_kg"], rel=0.15)
    # What is in the right valley stays there.
    assert retuned(ring, found).gain == pytest.approx(found.gain, abs=0.5)
