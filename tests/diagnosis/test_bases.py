"""The base that a search begins from."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from permway.diagnosis import bases as module
from permway.diagnosis.bases import bases
from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.catalogue import sensor_gain
from permway.diagnosis.clock import Clock
from permway.diagnosis.compete import Ring
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.recalibrate import recalibrate
from simulated import simulate


def stale(fit: Fit) -> float:
    """How far what stands for the hidden lines is from what the fit predicts itself."""
    (prediction,) = fit.evidence.selected(fit.evidence.records[:1]).predicted(fit.campaign).datasets
    block = fit.evidence.blocks[0]
    assert isinstance(block, FrfBlock)
    return float(np.median(np.abs(block._reference["frf"].values / prediction["frf"].values - 1.0)))


@pytest.mark.parametrize("astray", [(), (2,), (1, 2, 3)])
def test_a_base_that_fits_is_searched_itself_and_weighed_by_its_own_predictions(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, astray: tuple[int, ...]
) -> None:
    """Also if a fit goes astray, or all of the first start, and another start finds the way: a blunter one."""
    evidence = gather(simulate(tmp_path / "c", 4).campaign, threads=1)
    calls, floors = 0, list[object]()

    def lost_at_first(*args: object, **options: object) -> Fit:
        nonlocal calls
        calls += 1
        floors.append(args[0].blocks[0].floor)  # type: ignore[attr-defined]
        if calls in astray:
            # Far off, and no step to come back.
            options |= {"start": np.full(5, 3.0), "most_steps": 0, "learn": False}
        return recalibrate(*args, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(module, "recalibrate", lost_at_first)
    base, searched = bases(evidence, Clock(None))
    assert any(np.all(floor == module.BLUNTER) for floor in floors) == (len(astray) == 3)
    assert base is searched
    assert base.heat < 1.2
    assert stale(base) < 0.01


def test_what_was_screened_about_a_base_of_other_lines_is_screened_again(tmp_path: Path) -> None:
    """A base that did not fit may have weighed other lines of the spectra than the one that follows."""
    fit = recalibrate(gather(simulate(tmp_path / "c", 4).campaign, threads=1))
    ring = Ring(fit)
    (hypothesis, *_) = sensor_gain.hypotheses(Situation(fit, ()))
    quick = ring.screen(hypothesis)
    assert quick.direction is not None
    assert np.isfinite(ring.promise(quick))
    other = replace(quick, columns=None, direction=quick.direction[:-3])
    assert ring.promise(other) == np.inf


def test_a_fit_begins_with_the_base_as_it_was_where_a_straight_line_led_astray(tmp_path: Path) -> None:
    fit = recalibrate(gather(simulate(tmp_path / "c", 4).campaign, threads=1))
    ring = Ring(fit)
    (hypothesis, *_) = sensor_gain.hypotheses(Situation(fit, ()))
    quick = ring.quick(hypothesis)
    count = fit.z.size
    near = ring.full(replace(quick, columns=None), most_steps=0)
    np.testing.assert_array_equal(near.z[:count], quick.base_z)
    astray = replace(quick, columns=None, base_z=quick.base_z + 3.0)
    np.testing.assert_array_equal(ring.full(astray, most_steps=0).z[:count], fit.z)
