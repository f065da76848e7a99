"""A truth's parameters as the catalogue counts them."""

from __future__ import annotations

import numpy as np
import pytest
from permway.challenge.effects import CATALOGUE, NEAR_DEGENERATE, NONLINEAR, OUTSIDE
from permway.challenge.layout import NOMINAL
from permway.challenge.parameters import _TRANSLATED, HALF, in_catalogue
from permway.diagnosis.catalogue import entries
from permway.recordings.channel import Chain

KINDS = {kind.KIND: kind for kind in (*CATALOGUE, *NEAR_DEGENERATE, *OUTSIDE, *NONLINEAR)}


def test_every_translation_is_of_an_effect_that_is_drawn_and_names_what_the_catalogue_has() -> None:
    assert set(_TRANSLATED) <= set(KINDS)
    some = {name: 0.3 for kind in _TRANSLATED for name in KINDS[kind].__dataclass_fields__}
    for kind in _TRANSLATED:
        known = entries()[str(KINDS[kind].ID)].PARAMETERS
        assert set(in_catalogue(kind, some)) <= set(known) | {"x_m"}, kind


def test_effects_are_of_the_domain_that_the_catalogue_has_them_in() -> None:
    """Else a verdict that names one rightly would be at another place."""
    known = entries()
    mine = {kind.KIND: kind for kind in KINDS.values() if kind.ID in known}
    assert {name: kind.DOMAIN for name, kind in mine.items()} == {
        name: known[str(kind.ID)].DOMAIN for name, kind in mine.items()
    }


def test_a_wheelset_in_two_parts_is_a_mode_of_one() -> None:
    """Boxes on a spring to the wheels, their motion split into that of the whole and of the mode."""
    whole, share, spring = 1000.0, 0.3, 4e8
    boxes, wheels = share * whole, (1.0 - share) * whole
    free = np.sqrt(spring * (1.0 / boxes + 1.0 / wheels)) / (2.0 * np.pi)
    found = in_catalogue("wheelset_bending", {"frequency_Hz": free, "share": share, "loss": 0.02})
    mode = np.array([1.0, found["contact"]])
    masses = np.array([boxes, wheels])
    assert masses @ mode == pytest.approx(0.0, abs=1e-9 * whole)
    assert masses @ mode**2 == pytest.approx(whole / found["ratio"])
    assert spring * (mode[0] - mode[1]) ** 2 == pytest.approx(
        whole / found["ratio"] * (2.0 * np.pi * found["frequency_Hz"]) ** 2
    )


def test_a_mount_with_a_dashpot_swings_most_at_the_catalogues_frequency() -> None:
    quality, resonance = 8.0, 400.0
    found = in_catalogue("sensor_mounting", {"resonance_Hz": resonance, "quality": quality})
    frequency = np.linspace(380.0, 420.0, 40001)
    ratio = frequency / resonance
    true = np.abs(1.0 / (1.0 - ratio**2 + 1j * ratio / quality))
    chain = Chain(mount_Hz=found["mount_Hz"], mount_loss_factor=found["loss_factor"])
    ours = np.abs(chain.transfer(frequency))
    assert frequency[np.argmax(ours)] == pytest.approx(frequency[np.argmax(true)], rel=1e-5)
    assert ours.max() == pytest.approx(true.max(), rel=0.01)


def test_a_mass_on_board_is_of_the_whole_vehicle() -> None:
    """What the generator hangs on its half of a wheelset, the catalogue hangs twice on the whole of it."""
    assert NOMINAL["vehicle"]["half"] == HALF
    true = {"mass_kg": 20.0, "tuned_Hz": 70.0, "loss": 0.1, "wheelsets": (1, 2)}
    found = in_catalogue("axlebox_absorber", true)
    assert found == {"mass_kg": 40.0, "frequency_Hz": 70.0, "loss_factor": 0.1}
    assert in_catalogue("rail_absorber", true)["mass_kg"] == 20.0


def test_what_needs_no_translation_stays_and_what_is_no_number_goes() -> None:
    assert in_catalogue("lost", {"factor": 0.04, "stretch_m": (3.0, 5.0)}) == {"factor": 0.04}
    assert in_catalogue("noise_floor", {"sensor": "rail@3", "factor": 9.0}) == {"noise_ratio": 81.0}
