"""How a train's degrees of freedom move over a profile, and under forces on them."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from permway.arrays import Complexes, Reals
from permway.campaign.parts import Condition
from permway.errors import InputError
from permway.model.vehicle import Vehicle
from permway.problem.model import Model


def wheels_of(model: Model, condition: Condition) -> Reals:
    """Where the wheels stand, the leading one first, m.

    Raises
    ------
    InputError
        If the model has no train.
    """
    if model.train is None:
        raise InputError("the model has no train", where="train", remedy="give the model file a [train]")
    if condition.wheels_m is not None:
        return np.array(condition.wheels_m, dtype=np.float64)
    centre = model.train.centre_m if condition.centre_m is None else condition.centre_m
    return np.asarray(centre + model.train.vehicle.wheel_positions_m())


def influence(model: Model, frequency_Hz: Reals, track: Complexes) -> Complexes:
    """Displacement of every degree of the vehicle per profile under every wheel.

    With wheel, track and contact receptances B: P = -(B_wheel + B_track + 1/k_c)^-1 R, and -P pushes the wheels
    (paper, equation (19)).

    Parameters
    ----------
    model : Model
    frequency_Hz : ndarray, shape (F,)
    track : ndarray of complex128, shape (F, wheels, wheels)
        Receptance at the contacts, m/N.

    Returns
    -------
    ndarray of complex128, shape (F, degrees, wheels)
    """
    assert model.train is not None
    vehicle = model.train.vehicle
    contact = model.train.contact.receptance(vehicle.share)
    return _influence(vehicle, contact, frequency_Hz.tobytes(), np.ascontiguousarray(track).tobytes())


@lru_cache(maxsize=8)
def _influence(vehicle: Vehicle, contact: float, lines: bytes, track: bytes) -> Complexes:
    response, wheel = _pushed(vehicle, lines)
    between = np.frombuffer(track, dtype=np.complex128).reshape(wheel.shape)
    found = np.asarray(response @ np.linalg.inv(wheel + between + contact * np.eye(wheel.shape[1])))
    found.flags.writeable = False
    return found


@lru_cache(maxsize=8)
def _pushed(vehicle: Vehicle, lines: bytes) -> tuple[Complexes, Complexes]:
    """Displacement of the free vehicle's degrees and of its contacts per force on the contacts, m/N."""
    found = vehicle.per_wheel_force(np.frombuffer(lines))
    for values in found:
        values.flags.writeable = False
    return found


def pushed(vehicle: Vehicle, frequency_Hz: Reals, rows: Reals, per_profile: Complexes) -> Complexes:
    """Displacement of every degree of the vehicle on its track per force along directions of its degrees, m/N.

    The free vehicle moves by it, and the contacts answer as to a profile of the wheels' motion, reversed.

    Parameters
    ----------
    frequency_Hz : ndarray, shape (F,)
    rows : ndarray, shape (n, degrees)
        What each force is of the forces on the degrees.
    per_profile : ndarray of complex128, shape (F, degrees, wheels)
        As :func:`influence` gives it.

    Returns
    -------
    ndarray of complex128, shape (F, n, degrees)
    """
    lines = frequency_Hz.tobytes()
    # What the push moves the contacts by is, reversed, what forces on the contacts move the degrees by.
    at_contacts = rows @ _pushed(vehicle, lines)[0]
    answer = at_contacts @ np.swapaxes(per_profile, 1, 2)
    return np.asarray(_shaken(vehicle, rows.tobytes(), lines) - answer)


@lru_cache(maxsize=8)
def _shaken(vehicle: Vehicle, rows: bytes, lines: bytes) -> Complexes:
    """Displacement of the free vehicle per force along rows of its degrees, m/N, shape (F, n, degrees)."""
    stiffness = vehicle.dynamic_stiffness(np.frombuffer(lines))
    push = np.frombuffer(rows).reshape(-1, stiffness.shape[1]).T
    found = np.linalg.solve(stiffness, np.broadcast_to(push, (stiffness.shape[0], *push.shape)))
    found = np.ascontiguousarray(np.swapaxes(found, 1, 2))
    found.flags.writeable = False
    return np.asarray(found)
