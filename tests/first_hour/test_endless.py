"""An effect on a rail without ends, as `permway new` begins a model, is moved to better places too."""

from __future__ import annotations

import numpy as np
import pytest
from permway.diagnosis.fit import Free
from permway.posterior.cells import coordinate


@pytest.mark.parametrize("value", [-7.0, 12.0])
def test_the_coordinate_of_a_place_without_limits(value: float) -> None:
    free = Free("x_m", "m", lambda z: 10.0 + 0.5 * z, (-np.inf, np.inf))
    found = coordinate(free, value)
    assert found is not None
    assert free.value(found) == pytest.approx(value)
