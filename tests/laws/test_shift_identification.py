"""Shifts from DMA tables: no part of the reference, the glass, overlaying without a law, and limits in words."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from permway.errors import InputError
from permway.laws import (
    TFDV,
    WLF,
    Arrhenius,
    FractionalZener,
    KelvinVoigt,
    Law,
    Shift,
    Springpot,
    WLFArrhenius,
    law_from_dict,
    law_to_dict,
)
from permway.laws.dma import DmaTable
from permway.laws.families import FAMILIES, family
from permway.laws.fitting import fit_table
from permway.laws.identify import identify
from permway.laws.limits import limit_words
from permway.laws.overlay import overlay
from permway.laws.shift_fit import SHIFTS, shift_family

RUBBER = FractionalZener(relaxed=5e6, unrelaxed=2e9, relaxation_time_s=0.3, order=0.45)


def table(
    law: Law, shift: Shift, temperatures: tuple[float, ...], *, at: float, noise: float = 0.0, decades: float = 3.0
) -> DmaTable:
    """Isotherms from 0.1 Hz upward, `law` being that of the temperature `at`."""
    true = TFDV.model_validate({"law": law, "shift": shift, "reference_temperature_C": at, "vertical": "none"})
    f, t = np.meshgrid(0.1 * 10.0 ** np.linspace(0.0, decades, 10), temperatures)
    errors = np.random.default_rng(1).normal(0.0, noise, (2, f.size))
    value = true.complex(f.ravel(), t.ravel()) * np.exp(errors[0] + 1j * errors[1] * 0.5)
    return DmaTable(
        frequency_Hz=f.ravel(), temperature_C=t.ravel(), storage_Pa=value.real, loss_Pa=np.abs(value.imag)
    )


@pytest.mark.parametrize("shift", ["wlf", "arrhenius", "wlf_arrhenius", "free"])
@pytest.mark.parametrize("vertical", ["none", "paper"])
def test_what_the_law_states_does_not_depend_on_the_reference(shift: str, vertical: str) -> None:
    """The reference is a convention: in the glass or above it, the moduli are the same."""
    temperatures = (-10.0, 20.0, 45.0, 60.0, 75.0, 100.0)
    measured = table(
        RUBBER, WLF(c1=9.0, c2_K=125.0, reference_temperature_C=60.0), temperatures, at=60.0, noise=0.01
    )
    found = [
        identify(measured, shift=shift, vertical=vertical, reference_temperature_C=reference)
        for reference in (-10.0, 37.0, 100.0)
    ]
    f, t = np.meshgrid([0.5, 20.0], [-5.0, 45.0, 95.0])
    for other in found[1:]:
        np.testing.assert_allclose(other.law.complex(f, t), found[0].law.complex(f, t), rtol=1e-9)
        assert other.bic == found[0].bic


def test_a_reference_in_the_glass_gives_the_time_there() -> None:
    """lg tau moves by the shift: at -10 degC 0.3 s has become 10^(9*70/55) times as long."""
    temperatures = tuple(np.arange(-10.0, 101.0, 10.0))
    measured = table(RUBBER, WLF(c1=9.0, c2_K=125.0, reference_temperature_C=60.0), temperatures, at=60.0)
    cold = identify(measured, shift="wlf", reference_temperature_C=-10.0)
    values = {p.name: p.value for p in cold.parameters}
    assert values["relaxation_time_s"] == pytest.approx(0.3 * 10.0 ** (9.0 * 70.0 / 55.0), rel=1e-3)
    assert values["shift.c2_K"] == pytest.approx(55.0, rel=1e-4)
    assert values["shift.c1"] == pytest.approx(9.0 * 125.0 / 55.0, rel=1e-4)
    assert not any(p.note for p in cold.parameters)
    with pytest.raises(InputError, match="singular") as caught:
        identify(measured, shift="wlf", reference_temperature_C=-70.0)
    assert "wlf_arrhenius" in str(caught.value)


@pytest.mark.parametrize("name", [*FAMILIES, "prony:2", "maxwell:2"])
def test_coordinates_move_along_frequency_and_modulus(name: str) -> None:
    """Moved by 1.5 decades of frequency and 0.2 of modulus, a law is itself read there."""
    chosen = family(name)
    random = np.random.default_rng(0)
    x = random.uniform(0.2, 0.7, len(chosen.kinds))
    f = np.geomspace(0.01, 1e3, 9)
    moved = chosen.law(chosen.shifted(x, 1.5, 0.2))
    np.testing.assert_allclose(moved.complex(f), 10.0**0.2 * chosen.law(x).complex(10.0**1.5 * f), rtol=1e-10)


def test_arrhenius_in_the_glass_joined_to_wlf_comes_back() -> None:
    shift = WLFArrhenius(c1=14.0, c2_K=60.0, transition_C=-20.0, activation_energy_J_per_mol=1.2e5)
    assert shift.log10_factor(-20.0) == 0.0
    # Above it is WLF, below Arrhenius, to the last digit.
    above, below = (
        WLF(c1=14.0, c2_K=60.0, reference_temperature_C=-20.0),
        Arrhenius(activation_energy_J_per_mol=1.2e5, reference_temperature_C=-20.0),
    )
    np.testing.assert_allclose(shift.log10_factor([0.0, 30.0]), above.log10_factor([0.0, 30.0]), rtol=1e-14)
    np.testing.assert_allclose(shift.log10_factor([-70.0, -21.0]), below.log10_factor([-70.0, -21.0]), rtol=1e-14)
    law = FractionalZener(relaxed=5e6, unrelaxed=2e9, relaxation_time_s=30.0, order=0.35)
    measured = table(law, shift, tuple(np.arange(-70.0, 41.0, 10.0)), at=-20.0, noise=0.005)
    joined = identify(measured, shift="wlf_arrhenius", reference_temperature_C=20.0)
    plain = identify(measured, shift="wlf", reference_temperature_C=20.0)
    # Four numbers instead of two pay: WLF alone would be singular in the glass.
    assert joined.bic < plain.bic - 100.0
    for p in joined.parameters:
        if p.name == "shift.transition_C":
            assert p.value == pytest.approx(-20.0, abs=4.0)
        if p.name == "shift.activation_energy_J_per_mol":
            assert p.value == pytest.approx(1.2e5, rel=0.1)
    f, t = np.meshgrid([0.5, 20.0], [-65.0, -25.0, 35.0])
    true = TFDV.model_validate({"law": law, "shift": shift, "reference_temperature_C": -20.0, "vertical": "none"})
    np.testing.assert_allclose(joined.law.complex(f, t), true.complex(f, t), rtol=0.02)
    assert law_from_dict(law_to_dict(joined.law)) == joined.law


def test_the_shift_is_chosen_among_three_on_request(tmp_path: Path) -> None:
    shift = Arrhenius(activation_energy_J_per_mol=1.5e5, reference_temperature_C=20.0)
    measured = table(RUBBER, shift, (-10.0, 5.0, 20.0, 35.0, 50.0), at=20.0, noise=0.01)
    assert measured.temperature_C is not None
    rows = np.column_stack([measured.frequency_Hz, measured.temperature_C, measured.storage_Pa, measured.loss_Pa])
    path = tmp_path / "dma.csv"
    np.savetxt(path, rows, delimiter=",", header="f_Hz,T_C,E_storage_Pa,E_loss_Pa", fmt="%.9g", comments="")
    answer = fit_table(path, output=tmp_path / "law.toml", law="fractional_zener", shift="compare")
    assert answer["shift"] == "arrhenius"
    assert {row["shift"] for row in answer["comparison"]} == {"wlf", "arrhenius", "wlf_arrhenius"}
    # The overlay knows of no law and finds the same steps.
    for step in answer["overlay"]:
        assert step["overlay_decades"] == pytest.approx(step["law_decades"], abs=4.0 * step["standard_error"])


def test_isotherms_laid_over_each_other_give_the_shift_without_a_law() -> None:
    shift = WLF(c1=9.0, c2_K=125.0, reference_temperature_C=60.0)
    measured = table(RUBBER, shift, (55.0, 65.0, 75.0, 85.0), at=60.0)
    laid = overlay(measured)
    assert laid.unbroken
    for step in laid.steps:
        true = shift.log10_factor(step.cold_C) - shift.log10_factor(step.warm_C)
        # Straight lines between ten points on three decades bend by less than this.
        assert step.decades == pytest.approx(float(true), abs=0.01)
    shifts = laid.log10_shift()
    assert shifts[85.0] == 0.0
    assert shifts[55.0] == pytest.approx(sum(step.decades or 0.0 for step in laid.steps))


def test_what_cannot_be_laid_over_is_reported() -> None:
    shift = WLF(c1=9.0, c2_K=125.0, reference_temperature_C=60.0)
    apart = overlay(table(RUBBER, shift, (20.0, 75.0), at=60.0, decades=0.5)).steps[0]
    assert apart.decades is None
    assert "at a temperature between" in apart.why
    glass = overlay(table(RUBBER, shift, (-10.0, 0.0), at=60.0, noise=0.01)).steps[0]
    assert glass.decades is None
    swept = table(RUBBER, shift, tuple(np.arange(0.0, 90.0, 5.0)), at=60.0)
    first = swept.frequency_Hz == swept.frequency_Hz[0]
    assert swept.temperature_C is not None
    sweep = DmaTable(
        frequency_Hz=swept.frequency_Hz[first],
        temperature_C=swept.temperature_C[first],
        storage_Pa=swept.storage_Pa[first],
        loss_Pa=swept.loss_Pa[first],
    )
    one = np.ones(1)
    assert all("fewer than 3 frequencies" in step.why for step in overlay(sweep).steps)
    assert overlay(DmaTable(frequency_Hz=one, temperature_C=None, storage_Pa=one, loss_Pa=one)).steps == ()


def test_law_and_overlay_that_differ_are_noted(tmp_path: Path) -> None:
    """An isotherm whose frequencies are ten times too high lies off every law; the overlay sees it."""
    shift = WLF(c1=9.0, c2_K=125.0, reference_temperature_C=60.0)
    measured = table(RUBBER, shift, (55.0, 65.0, 75.0, 85.0), at=60.0)
    assert measured.temperature_C is not None
    wrong = np.where(measured.temperature_C == 75.0, 10.0, 1.0) * measured.frequency_Hz
    rows = np.column_stack([wrong, measured.temperature_C, measured.storage_Pa, measured.loss_Pa])
    path = tmp_path / "dma.csv"
    np.savetxt(path, rows, delimiter=",", header="f_Hz,T_C,E_storage_Pa,E_loss_Pa", fmt="%.9g", comments="")
    answer = fit_table(path, output=tmp_path / "law.toml", law="fractional_zener")
    assert any("law and overlay differ" in note and "65.0 to 75.0" in note for note in answer["notes"])


def test_every_limit_has_words_with_what_to_do() -> None:
    kinds = set(itertools.chain.from_iterable(family(name).kinds for name in (*FAMILIES, "prony:3", "maxwell:2")))
    temperature = np.array([0.0, 20.0, 40.0])
    for name in SHIFTS:
        kinds |= set(shift_family(name, temperature, temperature, 20.0).kinds)
    for kind, high in itertools.product(kinds, (False, True)):
        words = limit_words(kind, high)
        assert any(verb in words for verb in ("use ", "measure ", "check ", "leave "))


@pytest.mark.parametrize(
    ("law", "shift", "name", "message"),
    [
        # All far below the relaxation.
        (
            RUBBER.model_copy(update={"relaxation_time_s": 1e-14, "order": 0.3, "unrelaxed": 9e9}),
            "wlf", "relaxation_time_s", "measure colder",
        ),
        # Only a springpot, no modulus at rest.
        (Springpot(coefficient=3e7, order=0.4), "wlf", "relaxed", "maxwell:N"),
        (KelvinVoigt(stiffness=3e6, damping=4e3), "wlf", "order", "dashpot"),
    ],
)  # fmt: skip
def test_a_coordinate_at_its_limit_is_reported_in_words(law: Law, shift: str, name: str, message: str) -> None:
    measured = table(law, WLF(c1=9.0, c2_K=125.0, reference_temperature_C=60.0), (40.0, 60.0, 80.0), at=60.0)
    found = identify(measured, shift=shift, reference_temperature_C=60.0)
    note = next(p.note for p in found.parameters if p.name == name)
    assert note.startswith("not identifiable")
    assert message in note
    assert "limit of its range" not in note


def test_one_frequency_is_reported_as_one(tmp_path: Path) -> None:
    path = tmp_path / "dma.csv"
    path.write_text(
        "T [°C],E' [MPa],tan δ\n20,5,0.1\n60,3,0.1\n-20,30,0.3\n-40,300,0.2\n0,8,0.25\n", encoding="utf-8"
    )
    answer = fit_table(path, output=tmp_path / "law.toml", law="springpot_parallel", frequency_Hz=2.0)
    assert "overlay" not in answer
    assert any("all rows are at 2 Hz" in note and "several frequencies" in note for note in answer["notes"])


def test_a_transition_is_judged_in_kelvin() -> None:
    shift = WLFArrhenius(c1=14.0, c2_K=60.0, transition_C=15.0, activation_energy_J_per_mol=1.2e5)
    law = FractionalZener(relaxed=5e6, unrelaxed=2e9, relaxation_time_s=30.0, order=0.35)
    measured = table(law, shift, tuple(np.arange(-40.0, 71.0, 10.0)), at=15.0, noise=0.005)
    found = identify(measured, law="fractional_zener", shift="wlf_arrhenius", reference_temperature_C=20.0)
    transition = next(p for p in found.parameters if p.name == "shift.transition_C")
    assert transition.note == ""
    assert transition.low < transition.value < transition.high
    assert transition.high - transition.low < 10.0
    assert transition.value == pytest.approx(15.0, abs=4.0)
