"""Suspensions that slide: the closed forms against simulated time, and the velocity at work."""

from __future__ import annotations

import numpy as np
import pytest
from permway.errors import InputError
from permway.model.irregularity import GermanLow
from permway.model.presets import slab_track_viaduct_32m
from permway.model.train import Train
from permway.model.vehicle import Vehicle
from permway.model.vehicle_additions import DamperSeries, Slider
from permway.model.vehicle_presets import crh380a
from permway.response.sliding import Remainder, at_work, remainders
from permway.response.train import train_response
from scipy.special import erf

STEP_HZ, LINES = 0.125, 1600
FREQUENCY = STEP_HZ * np.arange(LINES)


def with_slider(**values: object) -> Vehicle:
    return Vehicle(**{**crh380a(share=0.5).model_dump(), "additions": (Slider(**values),)})  # type: ignore[arg-type]


def shaken(vehicle: Vehicle) -> np.ndarray:
    """A motion of the wheels, each after the other, of the bogies by a filter of theirs: 5 to 80 Hz."""
    size = 1e-4 / np.maximum(FREQUENCY, 1.0) * ((FREQUENCY > 5.0) & (FREQUENCY < 80.0))
    late = np.exp(-2j * np.pi * np.outer(FREQUENCY, vehicle.lags_m() / 70.0))
    motion = np.zeros((LINES, 10), dtype=complex)
    motion[:, 6:] = size[:, None] * late
    bogie = 1.0 / (1.0 - (FREQUENCY / 9.0) ** 2 + 0.3j * FREQUENCY / 9.0)
    motion[:, [2, 4]] = bogie[:, None] * 0.5 * (motion[:, [6, 8]] + motion[:, [7, 9]])
    return motion


def simulated(motion: np.ndarray, rows: np.ndarray, rounds: int) -> tuple[np.ndarray, int]:
    """Velocities of suspensions in time, (rounds, samples, ties): normal, of that spectrum."""
    random, samples = np.random.default_rng(4), 8 * LINES
    velocity = 2j * np.pi * FREQUENCY[:, None] * (motion @ rows.T)
    draw = random.standard_normal((rounds, LINES, 2)) @ np.array([1.0, 1j])
    lines = draw[:, :, None] * velocity * np.sqrt(0.5 * STEP_HZ)
    return np.fft.irfft(lines, n=samples, axis=1) * samples / np.sqrt(2.0), samples


@pytest.mark.parametrize("v0", [0.002, 0.03])
def test_dashpot_and_remainder_are_those_of_simulated_time(v0: float) -> None:
    car = with_slider(suspension="primary", force_N=900.0, velocity_m_per_s=v0)
    motion = shaken(car)
    moving = at_work(car, FREQUENCY, lambda _: motion)
    (left,) = remainders(moving, STEP_HZ, motion)
    assert isinstance(left, Remainder)
    velocity, samples = simulated(motion, left.rows, rounds=60)
    force = 0.5 * 900.0 * erf(velocity / (np.sqrt(2.0) * v0))
    dashpot = np.sum(force * velocity) / np.sum(velocity**2)
    (slider,) = moving.additions
    assert isinstance(slider, Slider)
    assert 0.5 * slider.damping_Ns_per_m == pytest.approx(dashpot, rel=0.01)
    assert slider.rms_m_per_s == pytest.approx(velocity.std(), rel=0.02)
    rest = force - np.sum(force * velocity, axis=(0, 1)) / np.sum(velocity**2, axis=(0, 1)) * velocity
    lines = np.fft.rfft(rest, axis=1)[:, :LINES] * np.sqrt(2.0 / STEP_HZ) / samples
    seen = np.einsum("rfi,rfj->fij", lines, lines.conj()) / len(lines)
    for low in range(8, LINES - 200, 100):
        band = slice(low, low + 100)
        own = np.einsum("fii->i", seen[band]).real
        assert own == pytest.approx(np.einsum("fii->i", left.density[band]).real, rel=0.12)
        # The first two suspensions share a bogie: what they have in common, in size and in phase.
        common = left.density[band, 0, 1].sum()
        assert abs(seen[band, 0, 1].sum() - common) < 0.1 * own[:2].mean()


def test_the_velocity_at_work_is_the_one_it_leads_to() -> None:
    car = with_slider(suspension="primary", force_N=4000.0, velocity_m_per_s=0.001)

    def motion(vehicle: Vehicle) -> np.ndarray:
        """The more the suspension damps, the less it moves."""
        (slider,) = vehicle.additions
        assert isinstance(slider, Slider)
        return shaken(vehicle) / (1.0 + slider.damping_Ns_per_m / 2e5)

    moving = at_work(car, FREQUENCY, motion)
    moved = 2.0 * np.pi * FREQUENCY[:, None] * motion(moving) @ car.stretches("primary").T
    (slider,) = moving.additions
    assert isinstance(slider, Slider)
    power = np.trapezoid(np.mean(np.abs(moved) ** 2, axis=1), FREQUENCY)
    assert slider.rms_m_per_s == pytest.approx(np.sqrt(power), rel=1e-9)
    # From wherever it is sought.
    far = Vehicle(
        **{**car.model_dump(), "additions": (slider.model_copy(update={"rms_m_per_s": 3.0 * slider.rms_m_per_s}),)}
    )
    (again,) = at_work(far, FREQUENCY, motion).additions
    assert isinstance(again, Slider)
    assert again.rms_m_per_s == pytest.approx(slider.rms_m_per_s, rel=1e-9)


def test_a_solve_takes_the_dashpot_at_work() -> None:
    """A damper that blows off: on a rougher rail it damps less, and on a smooth one as at rest."""
    line, frequency = slab_track_viaduct_32m(), np.geomspace(1.0, 69.0, 60)
    c = crh380a(share=0.5).primary_damping_Ns_per_m
    force = 800.0
    v0 = force * np.sqrt(2.0 / np.pi) / c
    blown = with_slider(suspension="primary", force_N=force, velocity_m_per_s=v0, alone=True)

    def bogie(vehicle: Vehicle, scale: float) -> np.ndarray:
        train = Train(vehicle=vehicle, centre_m=16.0, speed_m_per_s=70.0)
        found = train_response(line, train, GermanLow(scale=scale), frequency, temperature_C=20.0)
        return np.asarray(found["vehicle_acceleration_psd"].sel(degree="car1.bogie1.bounce").values / scale)

    plain = bogie(crh380a(share=0.5), 1.0)
    assert bogie(blown, 1e-6) == pytest.approx(plain, rel=1e-3)
    undamped = Vehicle(**{**crh380a(share=0.5).model_dump(), "primary_damping_Ns_per_m": 0.0})
    assert bogie(blown, 1e6) == pytest.approx(bogie(undamped, 1.0), rel=2e-2)


def test_one_frequency_constrains_no_velocity() -> None:
    train = Train(
        vehicle=with_slider(suspension="primary", force_N=800.0, velocity_m_per_s=0.01),
        centre_m=16.0,
        speed_m_per_s=70.0,
    )
    with pytest.raises(InputError, match="needs a band"):
        train_response(slab_track_viaduct_32m(), train, GermanLow(), [20.0], temperature_C=20.0)


def test_a_damper_that_blows_off_has_no_spring_in_series() -> None:
    slider = Slider(suspension="primary", force_N=1.0, velocity_m_per_s=1.0, alone=True)
    series = DamperSeries(suspension="primary", stiffness_N_per_m=1e6)
    with pytest.raises((InputError, ValueError), match="described twice"):
        Vehicle(**{**crh380a().model_dump(), "additions": (series, slider)})
    Vehicle(**{**crh380a().model_dump(), "additions": (series, slider.model_copy(update={"alone": False}))})
