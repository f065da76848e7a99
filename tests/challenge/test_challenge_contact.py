"""Wheels that may leave the rail: against a stiffer spring, an ODE's solver, and the laws of contact."""

from __future__ import annotations

import numpy as np
import pytest
from permway.challenge.contact import RATE_HZ, Hertz, as_profile, impact, march
from permway.challenge.layout import NOMINAL
from permway.challenge.plan import CONTACT_N_PER_M
from permway.challenge.vehicle import vehicle, wheel_load
from scipy.integrate import solve_ivp

SAMPLES, RATE = 4096, 1024.0
BINS = np.arange(1, 1800)
LINES = BINS * RATE / SAMPLES
LOAD = wheel_load(NOMINAL)
RAIL = {"mass": 60.0, "spring": 6e7, "damper": 8e4}


def stiff_track(frequency: np.ndarray) -> np.ndarray:
    """A mass on spring and damper under each wheel, m/N."""
    omega = 2.0 * np.pi * frequency
    return np.eye(4) / (RAIL["spring"] + 1j * omega * RAIL["damper"] - RAIL["mass"] * omega**2)[:, None, None]


def pressed(frequency: np.ndarray) -> np.ndarray:
    car = vehicle(NOMINAL, CONTACT_N_PER_M)
    return car.pressed(frequency, stiff_track(frequency))


def dip(depth: float) -> np.ndarray:
    """One dip under each wheel in turn, as transforms."""
    times = np.arange(SAMPLES) / RATE
    late = np.array([1.0, 1.05, 1.3, 1.35])[:, None]
    along = np.clip((times - late) / 0.02, -0.5, 0.5)
    return np.fft.rfft(0.5 * depth * (1.0 + np.cos(2.0 * np.pi * along)), axis=1)[:, BINS].T


class Stiffer(Hertz):
    """A contact that is a linear spring, by so much stiffer."""

    def beyond(self, compression: np.ndarray) -> np.ndarray:
        return 0.3 * self.stiffness * compression


def test_a_stiffer_spring_is_a_stiffer_spring() -> None:
    profiles = dip(1e-4)
    found = as_profile(Stiffer(LOAD, CONTACT_N_PER_M), pressed, LINES, profiles, samples=SAMPLES)
    track = stiff_track(LINES)
    first = np.einsum("fcw,fw->fc", vehicle(NOMINAL, CONTACT_N_PER_M).influence(LINES, track), found)
    second = np.einsum("fcw,fw->fc", vehicle(NOMINAL, 1.3 * CONTACT_N_PER_M).influence(LINES, track), profiles)
    plain = np.einsum("fcw,fw->fc", vehicle(NOMINAL, CONTACT_N_PER_M).influence(LINES, track), profiles)
    weight = (LINES**2)[:, None]
    assert np.abs(weight * (first - second)).max() < 0.02 * np.abs(weight * (plain - second)).max()


def test_small_motion_is_linear() -> None:
    profiles = dip(1e-8)
    found = as_profile(Hertz(LOAD, CONTACT_N_PER_M), pressed, LINES, profiles, samples=SAMPLES)
    assert np.abs(found - profiles).max() < 1e-3 * np.abs(profiles).max()


def test_force_after_an_impact_and_at_rest() -> None:
    """What is lost of compression in all is what the linear spring takes up: 1/k; nothing is lost at once."""
    after = impact(pressed, CONTACT_N_PER_M)
    total = after.sum(axis=0) * CONTACT_N_PER_M
    assert np.diag(total) == pytest.approx(np.ones(4), abs=0.02)
    # A band that ends smears the beginning.
    assert np.abs(after[0]).max() < 0.1 * np.abs(after).max()


def test_hertz_only_presses() -> None:
    contact = Hertz(LOAD, CONTACT_N_PER_M)
    compression = np.linspace(-5e-4, 5e-4, 1001)
    force = contact.force(compression)
    assert force.min() == -LOAD
    slope = np.gradient(force, compression)
    assert slope[500] == pytest.approx(CONTACT_N_PER_M, rel=1e-3)
    assert np.all(np.diff(force) >= 0.0)


@pytest.mark.parametrize("depth", [2e-4, 3e-3])
def test_against_a_solver_of_differential_equations(depth: float) -> None:
    """One wheel of a car over a dip, on springs and dampers; deep enough to fly, or not."""
    contact = Hertz(LOAD, CONTACT_N_PER_M)
    steps = round(RATE_HZ * 1.0)
    times = np.arange(steps) / RATE_HZ
    mass = 890.0

    def profile(t: np.ndarray | float) -> np.ndarray:
        along = np.clip((np.asarray(t) - 0.3) / 0.02, -0.5, 0.5)
        return np.asarray(0.5 * depth * (1.0 + np.cos(2.0 * np.pi * along)))

    soft, slow = 1.2e6, 1e4

    def rate(t: float, y: np.ndarray) -> list[float]:
        z, v, u, w = y
        force = float(contact.force(np.array(z - u - profile(t))))
        rail = (force - RAIL["spring"] * u - RAIL["damper"] * w) / RAIL["mass"]
        return [v, (-force - soft * z - slow * v) / mass, w, rail]

    solved = solve_ivp(rate, (0.0, times[-1]), [0.0] * 4, t_eval=times, rtol=1e-8, atol=1e-11, max_step=1e-3)
    expected = contact.force(solved.y[0] - solved.y[2] - profile(times))

    def one(frequency: np.ndarray) -> np.ndarray:
        omega = 2.0 * np.pi * frequency
        rail = stiff_track(frequency)[:, 0, 0]
        wheel = 1.0 / (-mass * omega**2 + 1j * omega * slow + soft)
        return (-1.0 / (rail + wheel + 1.0 / CONTACT_N_PER_M))[:, None, None]

    lines = np.fft.rfftfreq(steps, 1.0 / RATE_HZ)
    transform = np.fft.rfft(profile(times))
    linear = np.zeros(lines.size, dtype=complex)
    linear[1:] = one(lines[1:])[:, 0, 0] * transform[1:] / CONTACT_N_PER_M
    compression = np.fft.irfft(linear, n=steps)[:, None]
    beyond = march(contact, compression, impact(one, CONTACT_N_PER_M))
    lost = np.convolve(beyond[:, 0], impact(one, CONTACT_N_PER_M)[:, 0, 0])[:steps]
    found = contact.force(compression[:, 0] - lost)
    assert (expected.min() == -LOAD) == (depth > 1e-3)
    assert np.abs(found - expected).max() < 0.04 * np.abs(expected).max()
    below = slice(0, 462)
    off, whole = (np.linalg.norm(np.fft.rfft(part)[below]) for part in (found - expected, expected))
    assert off < 0.006 * whole
