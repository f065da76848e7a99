"""Elements of the grammar by closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from permway.diagnosis.grammar import ELEMENTS

ROD = next(e for e in ELEMENTS if e.name == "rod")


@pytest.mark.parametrize("first_Hz", [12.0, 34.0])
def test_a_rod_is_its_wave_equation(first_Hz: float) -> None:
    """Held below and free above: -M w^2 tan(b)/b with b = (pi/2) (f/f1) / sqrt(1 + i eta)."""
    mass, eta = 1.2e4, 0.04
    frequency = np.linspace(0.5, 3.6 * first_Hz, 400)
    law = ROD.law({"mass_kg": mass, "frequency_Hz": first_Hz, "loss_factor": eta})
    angle = 0.5 * np.pi * frequency / first_Hz / np.sqrt(1.0 + 1j * eta)
    exact = -mass * (2.0 * np.pi * frequency) ** 2 * np.tan(angle) / angle
    np.testing.assert_allclose(law.complex(frequency, None), exact, rtol=0.02, atol=0.01 * np.abs(exact).max())
