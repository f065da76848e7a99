"""Where recalibration of passages begins: what is looked for first is looked for again."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from permway.diagnosis.hypothesis import linear_free
from permway.diagnosis.speeds import GRID, LIMITS, OF_BODIES, _looked, _misfit, _settled

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
def test_no_value_of_the_first_is_better_beside_what_the_second_was(order: tuple[int, int]) -> None:
    better = 0
    for seed in range(60):
        problem: Any = Valleys(seed)
        once, far = _looked(problem, np.zeros(2), order, COARSE)
        found, least = _settled(problem, np.zeros(2), order, COARSE)
        assert least == _misfit(problem.residuals(found)[0], found)
        for value in np.linspace(-LIMITS, LIMITS, OF_BODIES if order[0] in COARSE else GRID):
            tried = once.copy()
            tried[order[0]] = value
            assert least <= _misfit(problem.residuals(tried)[0], tried)
        better += least < far
    # Once over all grids is not enough.
    assert better > 5
