"""Where recalibration of passages begins: at rest, whichever of stiffness and time is looked for first."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from permway.diagnosis.hypothesis import linear_free
from permway.diagnosis.speeds import GRID, LIMITS, OF_BODIES, _at_rest, _looked, _misfit

COARSE = (0,)


class Valleys:
    """Residuals that turn with both of two values, as phases do with a stiffness and a time."""

    def __init__(self, seed: int) -> None:
        random = np.random.default_rng(seed)
        self.free = tuple(linear_free(name, "1", 0.0, 1.0, -9.0, 9.0) for name in "ab")
        self.turns, self.true = random.uniform(0.3, 2.0, (40, 2)), random.uniform(-3.0, 3.0, 2)

    def residuals(self, z: np.ndarray, near: Any = None) -> tuple[np.ndarray, None]:
        return 10.0 * np.abs(np.exp(1j * self.turns @ (z - self.true)) - 1.0), None

    def at(self, z: np.ndarray) -> Any:
        return SimpleNamespace(residuals=self.residuals(z)[0], solved=None)


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_no_value_on_the_grid_of_one_is_better_than_where_it_ends(order: tuple[int, int]) -> None:
    again = 0
    for seed in range(60):
        problem: Any = Valleys(seed)
        found, least = _at_rest(problem, np.zeros(2), order, COARSE)
        assert least == _misfit(problem.residuals(found)[0], found)
        for index in order:
            for value in np.linspace(-LIMITS, LIMITS, OF_BODIES if index in COARSE else GRID):
                tried = found.copy()
                tried[index] = value
                assert _misfit(problem.residuals(tried)[0], tried) >= least
        again += _looked(problem, np.zeros(2), order, COARSE)[1] > least
    # Once over all grids is not enough.
    assert again > 5
