"""Sizes that would have been seen: the evidence that they would have, against the odds that are asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from permway.diagnosis.hypothesis import Hypothesis, Where, linear_free
from permway.posterior.cells import Cell
from permway.posterior.detectable import ODDS, detectable
from permway.posterior.member import tempered
from permway.posterior.screening import Scores

PRIOR, RESIDUALS = -5.0, 3000
GAIN = Hypothesis(
    entry="sensor_gain",
    domain="measurement",
    family="gain",
    free=(linear_free("gain", "1", 1.0, 0.2, 0.1, 10.0),),
    amend=lambda campaign, _: campaign,
    locate=lambda _: Where("", channels=("s1",)),
    starts=((0.05,),),
    law=lambda _: "",
    size="gain",
    none=1.0,
)


def scores(*shown: float) -> Scores:
    return replace(Scores.none(len(shown)), shown=np.array(shown))


def test_the_smallest_size_has_just_the_evidence_that_is_asked_for() -> None:
    """A gain of 1.01 changes the residuals by one standard deviation."""
    found = detectable([Cell(GAIN, np.array([0.05]), PRIOR)], scores(1.0), RESIDUALS)["sensor_gain"]
    assert found.value is not None
    square = ((found.value - 1.0) / 0.01) ** 2
    nats = tempered(0.5 * (square - np.log1p(square)), RESIDUALS) + PRIOR
    assert nats == pytest.approx(np.log(ODDS), abs=0.02)


def test_an_amplitude_that_adds_to_a_density_need_not_be_so_large() -> None:
    """Its change grows by the square: where another must be 16 times as large, four times will do."""
    one = Cell(GAIN, np.array([0.05]), PRIOR)
    squared = replace(one, hypothesis=replace(GAIN, power=2.0))
    linear, square = (detectable([c], scores(1.0), RESIDUALS)["sensor_gain"].value for c in (one, squared))
    assert linear is not None
    assert square is not None
    assert (square - 1.0) / 0.01 == pytest.approx(((linear - 1.0) / 0.01) ** 0.5, rel=1e-6)


def test_of_a_fault_it_is_that_of_the_channel_that_shows_it_least() -> None:
    other = replace(GAIN, locate=lambda _: Where("", channels=("s2",)))
    cells = [Cell(GAIN, np.array([0.05]), PRIOR), Cell(other, np.array([0.05]), PRIOR)]
    alone = detectable(cells[1:], scores(0.25), RESIDUALS)
    assert detectable(cells, scores(1.0, 0.25), RESIDUALS) == alone


def test_what_no_possible_size_shows_is_left_out() -> None:
    assert detectable([Cell(GAIN, np.array([0.05]), PRIOR)], scores(1e-9), RESIDUALS) == {}
    assert detectable([Cell(GAIN, np.array([0.05]), PRIOR)], scores(0.0), RESIDUALS) == {}
