"""Intervals by how parameters move when records are left out."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from permway.diagnosis.heldout import Gain, Part
from permway.diagnosis.unsteady import unsteady

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
    return 1.0 / SIZE, unsteady(cast(Any, fit), found), float(values.mean() ** 2)


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
    assert unsteady(cast(Any, fit), [loose])[0] == pytest.approx(0.0)
