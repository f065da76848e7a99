"""Elements of no catalogue: what a rod that stands on a body answers, against its closed form."""

from __future__ import annotations

import numpy as np
import pytest
from permway.diagnosis.elements import STANDING


@pytest.mark.parametrize("loss_factor", [0.02, 0.3])
def test_a_standing_rod_is_its_mass_at_low_frequency_and_resonates_at_odd_quarter_waves(
    loss_factor: float,
) -> None:
    (rod,) = STANDING
    mass, quarter = 1.2e4, 33.9
    law = rod.law({"mass_kg": mass, "frequency_Hz": quarter, "loss_factor": loss_factor})
    f = np.linspace(0.1, 250.0, 5000)
    found = law.complex(f, 20.0)
    b = 0.5 * np.pi * f / quarter / np.sqrt(1.0 + 1j * loss_factor)
    assert found == pytest.approx(-mass * (2.0 * np.pi * f) ** 2 * np.tan(b) / b, rel=1e-9)
    assert found[0] == pytest.approx(-mass * (2.0 * np.pi * f[0]) ** 2, rel=1e-4)
    # It gives no energy.
    assert (found.imag >= 0.0).all()
    if loss_factor < 0.1:
        lossy = found.imag / f**2
        peaks = f[1:-1][(lossy[1:-1] > lossy[:-2]) & (lossy[1:-1] > lossy[2:])]
        assert peaks == pytest.approx(quarter * np.array([1, 3, 5, 7]), rel=0.01)
