"""Bodies on a shaken ground: their motion over that of the ground."""

from __future__ import annotations

import numpy as np

from permway.arrays import Complexes, Reals
from permway.campaign.predictions.sweeps import Location, Request
from permway.errors import InputError
from permway.problem.model import Model


def request(
    model: Model, temperature_C: float | None, locations: tuple[Location, ...], frequency_Hz: Reals
) -> Request:
    """The receptances from every joint that stands on the ground to every sensor."""
    return Request(temperature_C, frequency_Hz, locations, ground_locations(model))


def ground_locations(model: Model) -> tuple[Location, ...]:
    """Where joints stand on the ground: body above and x, each once.

    Raises
    ------
    InputError
        If there are none.
    """
    table = model.line.joint_table()
    segments = model.line.segments()
    down = np.flatnonzero(table.lower < 0)
    if not down.size:
        raise InputError("nothing stands on the ground", where="line.joints", remedy="name a joint to the ground")
    found = dict.fromkeys((segments[int(table.upper[i])].name, float(table.x[i])) for i in down)
    return tuple(found)


def transmissibility(
    model: Model, temperature_C: float | None, frequency_Hz: Reals, answer: Complexes
) -> Complexes:
    """Motion of the sensors' bodies over that of the ground.

    A ground that moves by 1 pushes the body above a joint k with k: T = sum of k H. For one mass on one spring
    it is k / (k - m omega^2).

    Parameters
    ----------
    answer : ndarray of complex128, shape (F, sensors, ground spots)
        Receptances, m/N.

    Returns
    -------
    ndarray of complex128, shape (F, sensors)
    """
    table = model.line.joint_table()
    segments = model.line.segments()
    locations = {location: i for i, location in enumerate(ground_locations(model))}
    laws = model.line.stiffness(frequency_Hz, temperature_C)
    push = np.zeros((frequency_Hz.size, len(locations)), dtype=np.complex128)
    for index in np.flatnonzero(table.lower < 0):
        location = locations[segments[int(table.upper[index])].name, float(table.x[index])]
        push[:, location] += table.scale[index] * laws[:, table.law[index]]
    return np.asarray(np.einsum("fsg,fg->fs", answer, push))
