"""Laws against their closed forms and against the paper's equations (21) to (27), written out separately."""

from __future__ import annotations

import numpy as np
import pytest
from permway.laws import (
    FVMP,
    TFDV,
    WLF,
    Arrhenius,
    FractionalKelvinVoigt,
    FractionalZener,
    Free,
    HavriliakNegami,
    Hysteretic,
    KelvinVoigt,
    Maxwell,
    Pad,
    Parallel,
    Prony,
    Scaled,
    Series,
    Springpot,
    StorageLossPair,
    Tabulated,
    Zener,
)

FREQUENCY = np.geomspace(0.01, 1e5, 57)
OMEGA = 2.0 * np.pi * FREQUENCY

TABLE_1_STORAGE = FVMP(mu1=0.008, eta1=0.004, mu2=59.672, eta2=17.537, alpha=0.041, beta=0.08, gamma=0.232)
TABLE_1_LOSS = FVMP(mu1=0.0, eta1=2.757, mu2=0.001, eta2=0.001, alpha=1.754, beta=2.813, gamma=0.216)
"""Columns of the paper's Table 1; mu1 of the second, not printed, does not enter the loss."""


def storage_24(law: FVMP, w: np.ndarray) -> np.ndarray:
    """Equation (24) as printed."""
    a, b, c2 = law.alpha, law.beta, law.mu2 / law.eta2
    top = w ** (a + b) * np.cos((b - a) / 2 * np.pi) + c2 * w**b * np.cos(b / 2 * np.pi)
    bottom = c2**2 + w ** (2 * a) + 2 * c2 * w**a * np.cos(a / 2 * np.pi)
    return law.mu1 + law.eta1 * w**law.gamma * np.cos(law.gamma * np.pi / 2) + law.mu2 * top / bottom


def loss_25(law: FVMP, w: np.ndarray) -> np.ndarray:
    """Equation (25) as printed."""
    a, b, c2 = law.alpha, law.beta, law.mu2 / law.eta2
    top = w ** (a + b) * np.sin((b - a) / 2 * np.pi) + c2 * w**b * np.sin(b / 2 * np.pi)
    bottom = c2**2 + w ** (2 * a) + 2 * c2 * w**a * np.cos(a / 2 * np.pi)
    return law.eta1 * w**law.gamma * np.sin(law.gamma * np.pi / 2) + law.mu2 * top / bottom


@pytest.mark.parametrize(
    "law",
    [
        TABLE_1_STORAGE,
        TABLE_1_LOSS,
        FVMP(mu1=1.4e6, eta1=8.1e4, mu2=1.2e6, eta2=2.0e7, alpha=0.68, beta=0.82, gamma=0.6),
    ],
)
def test_fvmp_is_equations_24_and_25(law: FVMP) -> None:
    # Rounding only; the loss may pass through zero, so its error is measured against the modulus.
    value = law.complex(FREQUENCY)
    scale = np.abs(value)
    assert np.all(np.abs(value.real - storage_24(law, OMEGA)) <= 1e-12 * scale)
    assert np.all(np.abs(value.imag - loss_25(law, OMEGA)) <= 1e-12 * scale)


def test_fvmp_satisfies_the_transform_of_equation_23() -> None:
    law = FVMP(mu1=3.0, eta1=2.0, mu2=5.0, eta2=0.7, alpha=0.3, beta=0.5, gamma=0.4)
    s, e = 1j * OMEGA, law.complex(FREQUENCY)
    c1, c2 = law.mu1 / law.eta1, law.mu2 / law.eta2
    stress = e * (c2 + s**law.alpha) / law.eta1
    strain = s ** (law.alpha + law.gamma) + c1 * s**law.alpha + law.mu2 / law.eta1 * s**law.beta
    strain = strain + c2 * s**law.gamma + c1 * c2
    np.testing.assert_allclose(stress, strain, rtol=1e-12)


def test_tfdv_is_equation_27() -> None:
    shift = WLF(c1=12.0, c2_K=160.0, reference_temperature_C=20.0)
    law = TFDV(law=TABLE_1_STORAGE, shift=shift, reference_temperature_C=20.0, vertical="paper")
    for celsius in (-30.0, -20.0, 20.0):
        alpha_t = 10.0 ** (-12.0 * (celsius - 20.0) / (160.0 + celsius - 20.0))
        vertical = (celsius + 273.15) / 293.15
        expected = vertical * storage_24(TABLE_1_STORAGE, alpha_t * OMEGA)
        np.testing.assert_allclose(law.storage(FREQUENCY, celsius), expected, rtol=1e-11)


def test_tfdv_density_falls_as_the_volume_grows() -> None:
    law = TFDV(
        law=Hysteretic(stiffness=2.0, loss_factor=0.1),
        shift=Arrhenius(activation_energy_J_per_mol=5e4, reference_temperature_C=20.0),
        reference_temperature_C=20.0,
        volume_expansion_per_K=6e-4,
    )
    expected = 2.0 * (313.15 / 293.15) / (1.0 + 6e-4 * 20.0)
    assert law.storage(10.0, 40.0) == pytest.approx(expected, rel=1e-14)


def test_zener_limits_and_peak() -> None:
    law = Zener(relaxed=2.0, unrelaxed=9.0, relaxation_time_s=0.01)
    assert law.complex(1e-9).real == pytest.approx(2.0, rel=1e-12)
    assert law.complex(1e12).real == pytest.approx(9.0, rel=1e-12)
    # Loss is largest at omega tau = 1, half the relaxing stiffness.
    peak = 1.0 / (2.0 * np.pi * 0.01)
    assert law.loss(peak) == pytest.approx(3.5, rel=1e-14)
    assert np.all(law.loss(FREQUENCY) <= 3.5)


def test_maxwell_turns_from_dashpot_to_spring() -> None:
    law = Maxwell(stiffness=4.0, damping=0.2)
    wt = OMEGA * 0.2 / 4.0
    np.testing.assert_allclose(law.storage(FREQUENCY), 4.0 * wt**2 / (1.0 + wt**2), rtol=1e-12)
    np.testing.assert_allclose(law.loss(FREQUENCY), 4.0 * wt / (1.0 + wt**2), rtol=1e-12)


@pytest.mark.parametrize("order", [0.05, 0.3, 0.5, 0.9])
def test_springpot_phase_is_constant(order: float) -> None:
    law = Springpot(coefficient=3.0, order=order)
    phase = np.degrees(np.angle(law.complex(FREQUENCY)))
    np.testing.assert_allclose(phase, 90.0 * order, rtol=1e-13)
    np.testing.assert_allclose(np.abs(law.complex(FREQUENCY)), 3.0 * OMEGA**order, rtol=1e-13)
    np.testing.assert_allclose(law.loss_factor(FREQUENCY), np.tan(order * np.pi / 2), rtol=1e-12)


def test_kelvin_voigt_and_hysteretic() -> None:
    np.testing.assert_array_equal(KelvinVoigt(stiffness=3.0, damping=2.0).complex(FREQUENCY), 3.0 + 2.0j * OMEGA)
    value = Hysteretic(stiffness=3.0, loss_factor=0.2).complex(FREQUENCY)
    np.testing.assert_array_equal(value, np.full(57, 3.0 * (1.0 + 0.2j)))


def test_reductions_of_one_law_to_another() -> None:
    zener = Zener(relaxed=2.0, unrelaxed=9.0, relaxation_time_s=0.01).complex(FREQUENCY)
    np.testing.assert_allclose(
        Prony(relaxed=2.0, strengths=(7.0,), relaxation_times_s=(0.01,)).complex(FREQUENCY), zener, rtol=1e-13
    )
    parallel = Parallel(first=Hysteretic(stiffness=2.0), second=Maxwell(stiffness=7.0, damping=0.07))
    np.testing.assert_allclose(parallel.complex(FREQUENCY), zener, rtol=1e-13)
    fractional = FractionalZener(relaxed=2.0, unrelaxed=9.0, relaxation_time_s=0.01, order=0.4).complex(FREQUENCY)
    skewed = HavriliakNegami(relaxed=2.0, unrelaxed=9.0, relaxation_time_s=0.01, order=0.4, skew=1.0)
    np.testing.assert_allclose(skewed.complex(FREQUENCY), fractional, rtol=1e-12)
    both = FVMP(mu1=2.0, eta1=3.0, mu2=0.0, eta2=1.0, alpha=0.5, beta=0.5, gamma=0.3)
    voigt = FractionalKelvinVoigt(stiffness=2.0, coefficient=3.0, order=0.3)
    np.testing.assert_allclose(both.complex(FREQUENCY), voigt.complex(FREQUENCY), rtol=1e-13)


def test_series_of_spring_and_dashpot_is_maxwell() -> None:
    series = Series(first=Hysteretic(stiffness=4.0), second=KelvinVoigt(stiffness=0.0, damping=0.2))
    expected = Maxwell(stiffness=4.0, damping=0.2).complex(FREQUENCY)
    np.testing.assert_allclose(series.complex(FREQUENCY), expected, rtol=1e-13)


def test_pad_is_equation_1() -> None:
    # Equation (1) with the area reduced by 30 %.
    pad = Pad(material=Hysteretic(stiffness=5e6, loss_factor=0.2), area_m2=0.0266, thickness_m=0.012)
    assert pad.storage(50.0) == pytest.approx(0.7 * 0.0266 * 5e6 / 0.012, rel=1e-14)
    whole = Pad(material=pad.material, area_m2=0.0266, thickness_m=0.012, effective_fraction=1.0)
    assert whole.loss(50.0) == pytest.approx(0.2 * 0.0266 * 5e6 / 0.012, rel=1e-14)
    assert Scaled(law=pad, factor=2.0).loss_factor(50.0) == pytest.approx(0.2, rel=1e-14)


def test_a_constant_loss_of_all_of_a_law() -> None:
    plain = Maxwell(stiffness=3.0, damping=0.01)
    lossy = Scaled(law=plain, factor=2.0, loss_factor=0.1)
    np.testing.assert_allclose(lossy.complex(FREQUENCY), 2.0 * (1.0 + 0.1j) * plain.complex(FREQUENCY), rtol=1e-14)
    assert "no causal law" in lossy._causal_by_structure()[1]


def test_pair_takes_storage_of_one_and_loss_of_the_other() -> None:
    pair = StorageLossPair(storage_law=TABLE_1_STORAGE, loss_law=TABLE_1_LOSS)
    np.testing.assert_array_equal(pair.storage(FREQUENCY), TABLE_1_STORAGE.storage(FREQUENCY))
    np.testing.assert_array_equal(pair.loss(FREQUENCY), TABLE_1_LOSS.loss(FREQUENCY))


def test_tabulated_is_linear_in_log_frequency() -> None:
    law = Tabulated(frequency_Hz=(1.0, 100.0, 1e4), storage=(10.0, 20.0, 50.0), loss_factor=(0.1, 0.2, 0.1))
    np.testing.assert_allclose(law.storage([1.0, 10.0, 100.0, 1e3, 1e4]), [10.0, 15.0, 20.0, 35.0, 50.0])
    assert law.loss_factor(10.0) == pytest.approx(0.15)


def test_shifts() -> None:
    # The universal constants, 100 K above the glass point.
    wlf = WLF(c1=17.44, c2_K=51.6, reference_temperature_C=-50.0)
    assert wlf.log10_factor(50.0) == pytest.approx(-17.44 * 100.0 / 151.6, rel=1e-14)
    arrhenius = Arrhenius(activation_energy_J_per_mol=83144.6261815324, reference_temperature_C=26.85)
    # E/R = 1e4 K, from 300 K to 250 K.
    assert arrhenius.log10_factor(-23.15) == pytest.approx(1e4 * (1 / 250 - 1 / 300) / np.log(10.0), rel=1e-12)
    free = Free(temperatures_C=(-20.0, 0.0, 30.0), log10_shift=(2.0, 1.0, -0.5))
    np.testing.assert_allclose(free.log10_factor([-20.0, 0.0, 30.0]), [2.0, 1.0, -0.5])
    assert np.all(np.diff(free.log10_factor(np.linspace(-20.0, 30.0, 101))) < 0.0)


def test_temperature_may_be_an_array() -> None:
    shift = WLF(c1=8.0, c2_K=120.0, reference_temperature_C=0.0)
    base = FractionalZener(relaxed=1.0, unrelaxed=50.0, relaxation_time_s=1e-4, order=0.5)
    law = TFDV(law=base, shift=shift, reference_temperature_C=10.0)
    frequency, temperature = np.meshgrid(FREQUENCY[:5], [-10.0, 0.0, 20.0])
    grid = law.complex(frequency, temperature)
    assert grid.shape == (3, 5)
    for row, celsius in enumerate([-10.0, 0.0, 20.0]):
        np.testing.assert_array_equal(grid[row], law.complex(FREQUENCY[:5], celsius))
    assert law.complex(5.0, 3.0).shape == ()
    assert law.complex(5.0, 3.0).dtype == np.complex128
