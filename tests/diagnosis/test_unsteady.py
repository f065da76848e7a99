"""Intervals by how parameters move when records are left out."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from permway.diagnosis.fit import WIDTH
from permway.diagnosis.heldout import Gain, Part
from permway.diagnosis.unsteady import by_octaves, by_parts

SIZE, PARTS = 400, 4


def line_fits(bend: float, seed: int) -> tuple[float, np.ndarray, float]:
    """A constant fitted to values that rise by `bend`: variance of the fit, what is added, error squared."""
    random = np.random.default_rng(seed)
    values = bend * (np.linspace(-1.0, 1.0, SIZE) + 0.5) + random.standard_normal(SIZE)
    fit = SimpleNamespace(z=np.array([values.mean()]), covariance=np.array([[1.0 / SIZE]]))
    found = []
    for part in np.array_split(np.arange(SIZE), PARTS):
        rest = np.delete(values, part)
        place = Part("band", "", np.isin(np.arange(SIZE), part))
        z, sigma = np.array([rest.mean()]), np.array([1.0 / np.sqrt(rest.size)])
        found.append(Gain(place, 1.0, 1.0, 1.0, 1.0, z, sigma))
    return 1.0 / SIZE, by_parts(cast(Any, fit), found), float(values.mean() ** 2)


def test_a_right_model_hardly_loses() -> None:
    more = [line_fits(0.0, seed)[1][0] for seed in range(200)]
    assert np.median(more) < 1.0 / SIZE
    covered = [
        error < 1.6449**2 * (own + extra[0]) for own, extra, error in (line_fits(0.0, s) for s in range(400))
    ]
    assert 0.88 <= np.mean(covered) <= 0.98


def test_a_wrong_one_is_known_less() -> None:
    for seed in range(20):
        own, more, _ = line_fits(2.0, seed)
        assert np.sqrt(more[0]) > 3.0 * np.sqrt(own)


def test_what_the_rest_does_not_tell_widens_nothing() -> None:
    fit = SimpleNamespace(z=np.zeros(1), covariance=np.array([[0.01]]))
    part = Part("place", "", np.ones(2, dtype=bool))
    loose = Gain(part, 1.0, 1.0, 1.0, 1.0, np.array([0.8]), np.array([1.0]))
    assert by_parts(cast(Any, fit), [loose])[0] == pytest.approx(0.0)


def octave_fit(shift: float, seed: int, octaves: int = 7) -> tuple[float, float, float]:
    """A constant fitted to values that each octave shifts: variance of the fit, what is added, error squared."""
    random = np.random.default_rng(seed)
    hertz = np.repeat(2.0 ** np.arange(2, 2 + octaves), 40) * random.uniform(1.0, 1.99, 40 * octaves)
    values = random.standard_normal(hertz.size) + shift * np.repeat(random.standard_normal(octaves), 40)
    own = 1.0 / hertz.size
    fit = SimpleNamespace(
        evidence=SimpleNamespace(
            rows=SimpleNamespace(frequency_Hz=hertz),
            whitener=SimpleNamespace(reduce=lambda slopes: np.zeros((1, slopes.shape[1]))),
        ),
        covariance=np.array([[own]]),
        jacobian=-np.ones((hertz.size, 1)),
        clean=values - values.mean(),
        heat=1.0,
    )
    return own, float(by_octaves(cast(Any, fit))[0]), float(values.mean() ** 2)


@pytest.mark.parametrize("shift", [0.0, 0.3, 3.0])
def test_intervals_hold_the_truth_whether_octaves_agree_or_not(shift: float) -> None:
    found = [octave_fit(shift, seed) for seed in range(500)]
    covered = np.mean([error < WIDTH**2 * (own + more) for own, more, error in found])
    assert 0.86 <= covered <= 0.965
    plain = np.mean([error < WIDTH**2 * own for own, _, error in found])
    assert plain < 0.75 if shift else plain > 0.86


def test_few_octaves_tell_nothing_of_how_they_disagree() -> None:
    assert octave_fit(3.0, 1, octaves=5)[1] == 0.0
