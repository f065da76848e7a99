"""Forces on board that depend on a velocity's size."""

from __future__ import annotations

import numpy as np
import pytest
from permway.challenge.layout import NOMINAL
from permway.challenge.plan import CONTACT_N_PER_M
from permway.challenge.sliders import Slider, settle
from permway.challenge.vehicle import damped_spring, vehicle

SAMPLES, RATE = 1024, 128.0
BINS = np.arange(8, 400)
FREQUENCY = BINS * RATE / SAMPLES
TRACK = np.broadcast_to(np.eye(4) * (1e-8 - 2e-9j), (FREQUENCY.size, 4, 4)).copy()


def profiles(size_m: float) -> np.ndarray:
    random = np.random.default_rng(4)
    parts = random.standard_normal((2, FREQUENCY.size, 4))
    return size_m * SAMPLES * (parts[0] + 1j * parts[1]) / FREQUENCY[:, None] ** 2


def test_slider_in_proportion_to_velocity_is_a_dashpot() -> None:
    with_slider, with_law = vehicle(NOMINAL, CONTACT_N_PER_M), vehicle(NOMINAL, CONTACT_N_PER_M)
    v = NOMINAL["vehicle"]
    with_slider.slider = Slider("primary", lambda velocity: 7e3 * velocity, 7e3)
    with_law.laws["primary"] = damped_spring(v["kp"], v["cp"] + 7e3)
    first, second = (
        one.respond(FREQUENCY, TRACK, profiles(1e-5), bins=BINS, samples=SAMPLES)
        for one in (with_slider, with_law)
    )
    assert np.abs(first - second).max() < 1e-3 * np.abs(second).max()


def test_steep_friction_on_a_given_motion_is_a_square_wave() -> None:
    driven = np.zeros((FREQUENCY.size, 1), dtype=complex)
    driven[0] = SAMPLES * 0.5 * 0.01
    slider = Slider("any", lambda velocity: 200.0 * np.tanh(velocity / 1e-5), 2e7)
    nowhere = np.zeros((FREQUENCY.size, 1, 1), dtype=complex)
    beyond = settle(slider, driven, nowhere, frequency_Hz=FREQUENCY, bins=BINS, samples=SAMPLES)
    force = beyond[0, 0] + slider.dashpot * 2j * np.pi * FREQUENCY[0] * driven[0, 0]
    assert force == pytest.approx(1j * 0.5 * SAMPLES * 200.0 * 4.0 / np.pi, rel=1e-3)


def test_friction_matters_less_the_rougher_the_rail() -> None:
    off = []
    # Velocities from a tenth of the one that rounds friction off to a hundred times it.
    for size in (1e-4, 3e-3, 1e-1):
        rubbing, plain = vehicle(NOMINAL, CONTACT_N_PER_M), vehicle(NOMINAL, CONTACT_N_PER_M)
        rubbing.slider = Slider("primary", lambda velocity: 300.0 * np.tanh(velocity / 0.01), 3e4)
        first, second = (
            one.respond(FREQUENCY, TRACK, profiles(size), bins=BINS, samples=SAMPLES)[:, 4]
            for one in (rubbing, plain)
        )
        off.append(np.linalg.norm(first - second) / np.linalg.norm(second))
    assert off[0] > 3.0 * off[2]
    assert off[0] > off[1] > off[2]
