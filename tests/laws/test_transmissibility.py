"""The shear rig: closed form of its transmissibility, and records that cannot be used."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.errors import InputError
from permway.laws import Hysteretic
from permway.laws.transmissibility import (
    ShakerRecord,
    ShearRig,
    compare_record,
    predict,
    read_shaker,
    transmissibility,
)

RIG = ShearRig(outer_diameter_m=0.04, inner_diameter_m=0.02, thickness_m=0.005, rings=2, moving_mass_kg=0.01)
HEADER = "freq_hz,base_accel_ms2,base_phase_rad,mass_accel_ms2,mass_phase_rad\n"


def test_transmissibility_of_one_mass_on_one_spring() -> None:
    # |T|^2 = (1 + eta^2) / ((1 - r^2)^2 + eta^2) for hysteretic damping, r the ratio of frequencies.
    stiffness, mass, eta = 4e5, 0.5, 0.15
    natural = np.sqrt(stiffness / mass) / (2.0 * np.pi)
    ratio = np.array([0.1, 0.9, 1.0, 1.5, 4.0])
    value = transmissibility(stiffness * (1 + 1j * eta), mass, ratio * natural)
    np.testing.assert_allclose(np.abs(value) ** 2, (1 + eta**2) / ((1 - ratio**2) ** 2 + eta**2), rtol=1e-12)


def test_prediction_uses_geometry_and_what_moves_with_the_mass() -> None:
    shape = 2 * np.pi / 4 * (0.04**2 - 0.02**2) / 0.005
    assert RIG.shape_factor_m == pytest.approx(shape, rel=1e-14)
    law = Hysteretic(stiffness=1e6, loss_factor=0.2)
    expected = transmissibility(shape * 1e6 * (1 + 0.2j), 0.51, [50.0, 150.0])
    np.testing.assert_allclose(predict(law, RIG, 0.5, [50.0, 150.0]), expected, rtol=1e-14)


def test_a_common_factor_comes_back() -> None:
    frequency = np.linspace(50.0, 400.0, 200)
    law = Hysteretic(stiffness=1e6, loss_factor=0.2)
    measured = predict(Hysteretic(stiffness=0.77e6, loss_factor=0.2), RIG, 0.25, frequency)
    record = ShakerRecord(frequency, measured, np.ones(200, dtype=np.complex128))
    result = compare_record(law, RIG, 0.25, record)
    assert result.stiffness_factor == pytest.approx(0.77, rel=1e-4)
    assert result.rms_scaled_dB < 1e-2
    assert result.rms_dB > 1.0
    # A hysteretic law is its own constant.
    assert result.rms_constant_dB == pytest.approx(result.rms_dB, rel=1e-12)
    # Relative motion over thickness.
    strain = np.abs(measured - 1.0) / (2 * np.pi * frequency) ** 2 / 0.005
    np.testing.assert_allclose(record.shear_strain(RIG), strain, rtol=1e-12)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("freq_hz,base\n1,2\n", "no column base_accel_ms2"),
        (HEADER, "no rows"),
        (HEADER + "10,1,0,1\n", "line 2"),
        (HEADER + "10,0,0,1,0\n", "base is at rest"),
        (HEADER + "10,1,0,x,0\n", "column 'mass_accel_ms2'"),
        (HEADER + "10,1,0,1,0\n0,1,0,1,0\n", "frequency_Hz[1]"),
    ],
)
def test_records_that_cannot_be_used(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "record.csv"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read_shaker(path)
    assert message in str(caught.value)
