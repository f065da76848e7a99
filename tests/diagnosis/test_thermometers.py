"""By how much parameters come out wrong where thermometers are off."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue import pad_temperature
from permway.diagnosis.compete import Ring
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.thermometers import OFF_K, misread
from permway.errors import InputError
from simulated_train import measured, tables, written

TRUE = {"softening_per_K": 0.006, "reference_factor": 1.0, "loss_ratio": 1.0}
APART_K = 27.0


def _read_off(campaign: Campaign, off_K: float) -> Campaign:
    """The test in the cold was so much warmer than was read."""
    conditions = tuple(
        c.model_copy(update={"temperature_C": (c.temperature_C or 0.0) + off_K}) if c.name == "cold" else c
        for c in campaign.stated.conditions
    )
    said = campaign.stated.model_copy(update={"conditions": conditions})
    return Campaign(said, campaign.model, campaign.folder, campaign.parameters)


def test_what_is_told_by_two_temperatures_is_as_sure_as_their_thermometers(tmp_path: Path) -> None:
    campaign = written(tmp_path, *tables())
    situation = Situation(recalibrate(gather(campaign, measured(campaign, 1), threads=1), learn=False), ())
    hypothesis = next(h for h in pad_temperature.hypotheses(situation) if not h.variant)
    one = cast(Any, SimpleNamespace(hypothesis=hypothesis, prefix=""))

    def ending(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        """As of a law that is known up to the warmest temperature that was read, and no further."""
        warmest = max(c.temperature_C or 0.0 for c in campaign.stated.conditions)
        if warmest > 12.0:
            raise InputError("is known up to 12 degC", where="law", value=warmest)
        return hypothesis.amend(campaign, values)

    def found(off_K: float) -> tuple[float, float, Any]:
        records = measured(_read_off(campaign, off_K), 2, lambda c: hypothesis.amend(c, TRUE))
        fit = recalibrate(gather(campaign, records, threads=1), learn=False)
        full = Ring(fit).full(Ring(fit).quick(hypothesis))
        place = [f.name for f in full.free].index("softening_per_K")
        slope = full.free[place].value(1.0) - full.free[place].value(0.0)
        more = misread(full, [one])
        ended = cast(Any, SimpleNamespace(hypothesis=replace(hypothesis, amend=ending), prefix=""))
        np.testing.assert_allclose(misread(full, [ended]), more, rtol=0.01, atol=1e-7)
        # What no temperature acts on is known as before.
        others = [i for i, f in enumerate(full.free) if f.name.startswith("vehicle.")]
        assert np.sqrt(more[others] / np.diag(full.covariance)[others]).max() < 0.2
        return full.values()["softening_per_K"], slope * float(np.sqrt(more[place])), full

    right, sigma, _ = found(0.0)
    assert sigma == pytest.approx(right * np.sqrt(2.0) * OFF_K / APART_K, rel=0.15)
    # A cold test that is warmer by two thirds of a kelvin: softer by a fortieth.
    wrong = found(2.0 / 3.0)[0]
    assert wrong - right == pytest.approx(-right * 2.0 / 3.0 / APART_K, rel=0.3)
