"""Runs of a train that moves: round a ring, so often and over such a profile that the record has no ends.

Where other runs have the train stand while the profile moves under it, as the solver does, here supports and spans
come and go. All is marched in time, so that losses have to be those of dashpots.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from permway.challenge.beams import Complexes
from permway.challenge.closed_mesh import ClosedMesh
from permway.challenge.crossing import Consist, cross
from permway.challenge.newmark import UNDAMPED
from permway.challenge.plan import Plan
from permway.errors import InputError

FINER = 12
"""Steps to a sample: of 1024 Hz 0.08 ms, by which Newmark's method has 400 Hz 0.35 % too low."""

BEFORE_S = 8.0
"""The train runs so long before it is recorded: what its start does to the car body falls to a thousandth."""

LOSE_AT_HZ = 60.0
"""Where viscous losses are the hysteretic ones."""

BEAMS_LOSE_AT_HZ = {"rail": 350.0, "slab": 200.0, "base": 200.0}
"""The same of beams that show further up: of a rail that loses so at 60 Hz wheelsets are 4.6 dB off at 350 Hz."""

LAP = 1e-4
"""Of a lap, by which a record may miss a whole number."""


def rolled(plan: Plan, met: Complexes, speed: float, *, samples: int, sampling_Hz: float) -> Complexes:
    """Accelerations of all channels, transforms of a periodic record.

    Parameters
    ----------
    plan : Plan
    met : ndarray of complex128, shape (samples // 2 + 1,)
        Transform of the profile that the leading wheel meets.
    speed : float
        m/s; a record holds a whole number of laps.
    samples : int
    sampling_Hz : float

    Returns
    -------
    ndarray of complex128, shape (samples // 2 + 1, channels)
        m/s2, in the order of the vehicle's channels.

    Raises
    ------
    InputError
        If the laps are no whole number.
    """
    ring = ClosedMesh(plan.track)
    seconds = samples / sampling_Hz
    laps = speed * seconds / ring.length_m
    if abs(laps - round(laps)) > LAP * laps:
        remedy = f"laps are {ring.length_m:g} m long, and a record {seconds:g} s"
        raise InputError("is no speed for a whole number of laps", where="speed", value=speed, remedy=remedy)
    speed = round(laps) * ring.length_m / seconds
    fine = samples * FINER
    height = FINER * np.fft.irfft(met, n=fine)
    along = speed * seconds * np.arange(fine + 1) / fine
    surface = CubicSpline(along, np.append(height, height[0]), bc_type="periodic", extrapolate="periodic")
    start = round(BEFORE_S * sampling_Hz) * FINER
    # Where the sheet has them, which rounds: lags between wheels are what records constrain best.
    stand = plan.layout.wheels_m(plan.values["vehicle"])
    wheels = tuple(stand[0] - x for x in stand)
    train = Consist(plan.values, cars=1, car_m=ring.length_m, speed_m_per_s=speed, wheels_m=wheels)
    step = seconds / fine
    done = cross(
        ring,
        train,
        from_m=-start * step * speed,
        to_m=(fine - 1) * step * speed,
        leaves=False,
        profile=surface,
        arms=list(plan.vehicle.channels.values()),
        step_s=step,
        viscous_at_Hz=LOSE_AT_HZ,
        beams_at_Hz=BEAMS_LOSE_AT_HZ,
        gamma=UNDAMPED,
    )
    return np.asarray(np.fft.rfft(done.on_board[start:], axis=0)[: samples // 2 + 1] / FINER)
