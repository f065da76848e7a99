"""What must hold for any parameters: passivity, reductions, causality, and reading back what was written."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
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
    Law,
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
    law_from_dict,
    law_to_dict,
)
from permway.laws.checks import kramers_kronig

FREQUENCY = np.geomspace(0.1, 1e4, 41)
BAND = (1.0, 2000.0)

moduli = st.floats(-2.0, 9.0).map(lambda x: 10.0**x)
times = st.floats(-7.0, 2.0).map(lambda x: 10.0**x)
orders = st.floats(0.02, 0.98)


@st.composite
def fvmps(draw: st.DrawFn) -> FVMP:
    alpha = draw(orders)
    beta = alpha + (0.99 - alpha) * draw(st.floats(0.0, 1.0))
    return FVMP(
        mu1=draw(moduli),
        eta1=draw(moduli),
        mu2=draw(moduli),
        eta2=draw(moduli),
        alpha=alpha,
        beta=beta,
        gamma=draw(orders),
    )


@st.composite
def passive_laws(draw: st.DrawFn) -> Law:
    kind = draw(st.integers(0, 7))
    low, rise, time, order = draw(moduli), draw(moduli), draw(times), draw(orders)
    match kind:
        case 0:
            return KelvinVoigt(stiffness=low, damping=rise)
        case 1:
            return Maxwell(stiffness=low, damping=rise)
        case 2:
            return Zener(relaxed=low, unrelaxed=low + rise, relaxation_time_s=time)
        case 3:
            return FractionalZener(relaxed=low, unrelaxed=low + rise, relaxation_time_s=time, order=order)
        case 4:
            return FractionalKelvinVoigt(stiffness=low, coefficient=rise, order=order)
        case 5:
            return draw(fvmps())
        case 6:
            return Prony(relaxed=low, strengths=(rise, low), relaxation_times_s=(time, 10.0 * time))
        case _:
            return HavriliakNegami(
                relaxed=low,
                unrelaxed=low + rise,
                relaxation_time_s=time,
                order=order,
                skew=draw(st.floats(0.05, 1.0)) / order,
            )


@given(passive_laws())
def test_passive_laws_dissipate(law: Law) -> None:
    value = law.complex(FREQUENCY)
    assert np.all(value.imag >= -1e-12 * np.abs(value))


@given(passive_laws(), passive_laws())
def test_passive_laws_stay_passive_in_series_and_in_parallel(first: Law, second: Law) -> None:
    for pair in (Series(first=first, second=second), Parallel(first=first, second=second)):
        value = pair.complex(FREQUENCY)
        assert np.all(value.imag >= -1e-12 * np.abs(value))


@given(low=moduli, rise=moduli, time=times)
def test_fractional_zener_of_order_one_is_zener(low: float, rise: float, time: float) -> None:
    fractional = FractionalZener(relaxed=low, unrelaxed=low + rise, relaxation_time_s=time, order=1.0)
    zener = Zener(relaxed=low, unrelaxed=low + rise, relaxation_time_s=time).complex(FREQUENCY)
    assert np.all(np.abs(fractional.complex(FREQUENCY) - zener) <= 1e-12 * (low + rise))


@given(law=passive_laws(), reference=st.floats(-20.0, 40.0), own=st.floats(-20.0, 40.0))
def test_tfdv_at_its_reference_is_the_law(law: Law, reference: float, own: float) -> None:
    shift = WLF(c1=10.0, c2_K=150.0, reference_temperature_C=own)
    shifted = TFDV(law=law, shift=shift, reference_temperature_C=reference)
    np.testing.assert_allclose(shifted.complex(FREQUENCY, reference), law.complex(FREQUENCY), rtol=1e-12)


@settings(max_examples=40, deadline=None)
@given(passive_laws())
def test_kramers_kronig_holds_for_causal_laws(law: Law) -> None:
    found = law.check(BAND)
    assert found.causal
    assert found.passive
    assert found.reasons == ()
    # The quadrature's own error, relative to the largest loss in the band.
    assert found.kramers_kronig < 1e-3 or np.abs(law.loss(FREQUENCY)).max() < 1e-6 * np.abs(law.storage(1.0))


@given(stiffness=moduli, eta=st.floats(0.001, 2.0))
@settings(max_examples=20, deadline=None)
def test_hysteretic_damping_is_not_causal(stiffness: float, eta: float) -> None:
    law = Hysteretic(stiffness=stiffness, loss_factor=eta)
    found = law.check(BAND)
    assert not found.causal
    assert found.passive
    # From the middle to an end of the band, storage should have grown by (2/pi) eta ln(f_end/f_middle).
    middle = np.sqrt(BAND[0] * BAND[1])
    assert found.kramers_kronig == pytest.approx(2.0 / np.pi * np.log(BAND[1] / middle), rel=0.02)


def test_hysteretic_without_loss_is_a_causal_spring() -> None:
    assert Hysteretic(stiffness=1e8).check(BAND).causal


def test_the_papers_pair_is_not_causal() -> None:
    storage = FVMP(mu1=0.008, eta1=0.004, mu2=59.672, eta2=17.537, alpha=0.041, beta=0.08, gamma=0.232)
    loss = FVMP(mu1=0.0, eta1=2.757, mu2=0.001, eta2=0.001, alpha=1.754, beta=2.813, gamma=0.216)
    found = StorageLossPair(storage_law=storage, loss_law=loss).check((1.0, 2000.0))
    assert not found.causal
    assert "Kramers-Kronig" in found.reasons[0]
    assert any("alpha = 1.754" in caveat for caveat in found.caveats)
    assert any("beta = 2.813" in caveat for caveat in found.caveats)
    # Each column alone is the transform of something causal; it is the pairing that breaks it.
    assert storage.check((1.0, 2000.0)).causal
    assert kramers_kronig(loss, (1.0, 2000.0))[0] < 1e-3
    same = StorageLossPair(storage_law=storage, loss_law=storage).check((1.0, 2000.0))
    assert same.causal
    # Above some kHz the printed loss blows up.
    ratio = StorageLossPair(storage_law=storage, loss_law=loss).loss_factor([100.0, 1e4])
    assert ratio[0] < 0.3
    assert ratio[1] > 3.0


@pytest.mark.parametrize(
    ("law", "passive", "causal", "word"),
    [
        (KelvinVoigt(stiffness=-1.0, damping=1.0), False, True, "at rest"),
        (KelvinVoigt(stiffness=1.0, damping=-1.0), False, True, "loss is"),
        (Zener(relaxed=5.0, unrelaxed=1.0, relaxation_time_s=0.01), False, True, "loss is"),
        (Zener(relaxed=1.0, unrelaxed=5.0, relaxation_time_s=-0.01), False, False, "unstable"),
        (Maxwell(stiffness=1.0, damping=-1.0), False, False, "unstable"),
        (Springpot(coefficient=1.0, order=-0.5), False, True, "loss is"),
        (FVMP(mu1=1.0, eta1=1.0, mu2=1.0, eta2=-1.0, alpha=0.5, beta=0.5, gamma=0.5), None, False, "real axis"),
        (FVMP(mu1=1.0, eta1=0.0, mu2=1.0, eta2=1.0, alpha=2.5, beta=2.6, gamma=0.5), None, False, "not below 2"),
    ],
)
def test_unphysical_parameters_are_reported(law: Law, passive: bool | None, causal: bool, word: str) -> None:
    found = law.check(BAND)
    if passive is not None:
        assert found.passive is passive
    assert found.causal is causal
    assert any(word in reason for reason in found.reasons), found.reasons


@pytest.mark.parametrize("loss_over", [1.0, 3.0])
def test_tables_are_judged_up_to_bounded_tails(loss_over: float) -> None:
    frequency = np.geomspace(1.0, 2000.0, 50)
    true = FractionalZener(relaxed=1e6, unrelaxed=1e8, relaxation_time_s=1e-6, order=0.4)
    table = Tabulated(
        frequency_Hz=frequency,
        storage=true.storage(frequency),
        loss_factor=loss_over * true.loss_factor(frequency),
    )
    found = table.check(BAND)
    # Three times the loss that goes with this storage is no material's; the right one passes.
    assert found.causal is (loss_over == 1.0)
    assert any("table" in caveat for caveat in found.caveats)


def test_flat_table_is_not_causal() -> None:
    frequency = np.geomspace(1.0, 2000.0, 20)
    flat = Tabulated(frequency_Hz=frequency, storage=np.ones(20), loss_factor=np.full(20, 0.2))
    assert not flat.check((1.0, 2000.0)).causal


def test_checks_reach_through_shift_and_pad() -> None:
    base = FractionalZener(relaxed=1e6, unrelaxed=1e8, relaxation_time_s=1e-6, order=0.4)
    shift = WLF(c1=10.0, c2_K=150.0, reference_temperature_C=20.0)
    pad = Pad(material=TFDV(law=base, shift=shift, reference_temperature_C=20.0), area_m2=0.02, thickness_m=0.01)
    found = pad.check(BAND, -20.0)
    assert found.causal
    assert found.passive


EVERY_KIND: list[Law] = [
    Hysteretic(stiffness=1.5e8, loss_factor=0.1),
    KelvinVoigt(stiffness=1.0, damping=2.0),
    Maxwell(stiffness=1.0, damping=2.0),
    Zener(relaxed=1.0, unrelaxed=2.0, relaxation_time_s=0.1),
    Springpot(coefficient=1.0, order=0.2),
    FractionalKelvinVoigt(stiffness=1.0, coefficient=1.0, order=0.2),
    FractionalZener(relaxed=1.0, unrelaxed=2.0, relaxation_time_s=0.1, order=0.4),
    HavriliakNegami(relaxed=1.0, unrelaxed=2.0, relaxation_time_s=0.1, order=0.4, skew=0.7),
    FVMP(mu1=1.0, eta1=1.0, mu2=1.0, eta2=1.0, alpha=1.754, beta=2.813, gamma=0.2),
    Prony(relaxed=1.0, strengths=np.array([1.0, 2.0]), relaxation_times_s=[0.1, 0.2]),
    Tabulated(frequency_Hz=np.array([1.0, 2.0]), storage=(1.0, 2.0), loss_factor=[0.1, 0.2]),
    TFDV(
        law=Springpot(coefficient=1.0, order=0.2),
        shift=Free(temperatures_C=(-10.0, 20.0), log10_shift=(1.0, 0.0)),
        reference_temperature_C=20.0,
        vertical="none",
    ),
    Pad(
        material=TFDV(
            law=Springpot(coefficient=1.0, order=0.2),
            shift=Arrhenius(activation_energy_J_per_mol=5e4, reference_temperature_C=0.0),
            reference_temperature_C=20.0,
        ),
        area_m2=0.02,
        thickness_m=0.01,
    ),
    Series(first=Hysteretic(stiffness=1.0, loss_factor=0.1), second=Maxwell(stiffness=1.0, damping=1.0)),
    Parallel(first=Hysteretic(stiffness=1.0), second=Maxwell(stiffness=1.0, damping=1.0)),
    Scaled(law=Maxwell(stiffness=1.0, damping=1.0), factor=2.0, loss_factor=0.1),
    Scaled(law=Hysteretic(stiffness=1.0, loss_factor=0.3), factor=2.0),
    StorageLossPair(storage_law=Hysteretic(stiffness=1.0), loss_law=Springpot(coefficient=1.0, order=0.1)),
]


@pytest.mark.parametrize("law", EVERY_KIND, ids=lambda law: law.type)
def test_every_law_reads_back_and_is_frozen(law: Law) -> None:
    again = law_from_dict(law_to_dict(law))
    assert again == law
    assert type(again) is type(law)
    assert hash(again) == hash(law)
    with pytest.raises(ValueError, match="frozen"):
        law.type = "other"  # type: ignore[attr-defined]


@pytest.mark.parametrize("law", EVERY_KIND, ids=lambda law: law.type)
def test_storage_loss_and_loss_factor_agree_with_complex(law: Law) -> None:
    frequency = np.array([[1.0, 1.5], [1.7, 2.0]])
    value = law.complex(frequency, 15.0)
    assert value.shape == (2, 2)
    np.testing.assert_array_equal(law.storage(frequency, 15.0), value.real)
    np.testing.assert_array_equal(law.loss(frequency, 15.0), value.imag)
    np.testing.assert_array_equal(law.loss_factor(frequency, 15.0), value.imag / value.real)
    assert law.needs_temperature is (law.type in ("tfdv", "pad"))  # type: ignore[attr-defined]
