"""Runs of trains that roll over supports that repeat, by kernels that are kept."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from permway.arrays import Complexes, Reals
from permway.campaign.excitation import Rolling
from permway.campaign.parts import Condition
from permway.campaign.predictions.excitation import speed_of
from permway.campaign.predictions.motion import wheels_of
from permway.model.line import Line
from permway.model.vehicle import Vehicle
from permway.problem.model import Model
from permway.response.rolling import Kernel, Rolled, kernel, rolled
from permway.response.rolling.harmonics import REACH

LIKE = 0.05
"""Speeds as near as this, relative, to the one for which rolling is known share its kernel: they differ by as much
of what Doppler's effect turns, 0.6 rad at 300 km/h and 300 Hz. So does any temperature."""

KEPT = 8
"""Kernels in memory, some megabytes each."""

_KEPT: OrderedDict[tuple[object, ...], tuple[Line, Kernel]] = OrderedDict()


def rolling_of(
    model: Model,
    rolling: Rolling | None,
    condition: Condition,
    lines_Hz: Reals,
    track: Complexes,
    temperature_C: float | None,
) -> Rolled | None:
    """What a train does that rolls; None for one that stands.

    Parameters
    ----------
    model : Model
    rolling : Rolling or None
    condition : Condition
        Of a train.
    lines_Hz : ndarray, shape (L,)
    track : ndarray of complex128, shape (L, wheels, wheels)
        Receptance under the standing wheels, m/N.
    temperature_C : float or None

    Raises
    ------
    InputError, SolveError
        As :func:`permway.response.rolling.kernel`.
    """
    if rolling is None or rolling.share == 0.0:
        return None
    train = model.train
    assert train is not None
    by = kernel_of(model, rolling, condition, float(lines_Hz[-1]), temperature_C)
    contact = train.contact.receptance(train.vehicle.share)
    lines, standing = lines_Hz.tobytes(), np.ascontiguousarray(track).tobytes()
    return _rolled(train.vehicle, contact, lines, standing, by, speed_of(condition), rolling.share)


@lru_cache(maxsize=8)
def _rolled(
    vehicle: Vehicle, contact: float, lines: bytes, standing: bytes, by: Kernel, speed: float, share: float
) -> Rolled:
    lines_Hz, wheels = np.frombuffer(lines), len(vehicle.wheel_indices)
    track = np.frombuffer(standing, dtype=np.complex128).reshape(lines_Hz.size, wheels, wheels)
    return rolled(vehicle, contact, lines_Hz, track, by, speed_m_per_s=speed, share=share)


def kernel_of(
    model: Model, rolling: Rolling, condition: Condition, top_Hz: float, temperature_C: float | None
) -> Kernel:
    """The kernel of a run up to what is coupled with a frequency; the same line gives the same one again."""
    assert model.train is not None
    line, speed, wheels = model.line, speed_of(condition), wheels_of(model, condition)
    if rolling.about is not None:
        line = rolling.about.line
        known, warm = rolling.about.runs.get(condition.name, (speed, temperature_C))
        if abs(speed / known - 1.0) < LIKE:
            speed, temperature_C = known, warm
    key = (id(line), wheels.tobytes(), speed, rolling.spacing_m, top_Hz, temperature_C, model.formulation)
    if key not in _KEPT:
        found = kernel(
            line,
            model.train.body,
            wheels,
            speed_m_per_s=speed,
            spacing_m=rolling.spacing_m,
            to_Hz=top_Hz + REACH * speed / rolling.spacing_m,
            temperature_C=temperature_C,
            formulation=model.formulation,
        )
        # The line is kept with it: another one might get its number else.
        _KEPT[key] = line, found
        while len(_KEPT) > KEPT:
            _KEPT.popitem(last=False)
    _KEPT.move_to_end(key)
    return _KEPT[key][1]


def passing(by: Rolled) -> Iterator[tuple[float, Complexes]]:
    """Lines of the supports' passing: Hz, and root-mean-square amplitudes of the degrees, m."""
    for number, amplitudes in enumerate(by.lines, start=1):
        yield number * by.passing_Hz, amplitudes / np.sqrt(2.0)
