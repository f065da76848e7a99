"""From rail places to sensors, by reciprocity, with the limit of rest at 0 Hz.

A unit force at the sensor gives at each rail place what a unit force there gives at the sensor; so one force a
sensor is enough for all places.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.model.line import Line
from permway.model.place import Place
from permway.response.receptance import Formulation, Progress, receptance

STATIC_SHARE = 0.1
"""0 Hz is taken from this share of the first frequency above it."""
_RIGID = 5.0
"""Growth of the response from the first frequency down to its share, above which the line is not held."""


def transfer(
    line: Line,
    frequency_Hz: Reals,
    *,
    sensors: Sequence[Place],
    places: Sequence[Place],
    temperature_C: float | None = None,
    formulation: Formulation = "chain",
    threads: int | None = None,
    progress: Progress | None = None,
) -> Complexes:
    """Displacement at sensors per unit force at places.

    Parameters
    ----------
    line : Line
    frequency_Hz : ndarray, shape (F,)
        Ascending; may begin with 0, which stands for the limit of rest: the real part at a tenth of the next
        frequency (of 1 Hz, if there is none).
    sensors, places : sequence of Place
    temperature_C, formulation, threads, progress
        As in :func:`permway.response.receptance.receptance`.

    Returns
    -------
    ndarray of complex128, shape (F, sensors, places)
        m/N.

    Raises
    ------
    InputError
        For a line that nothing holds at rest, and as `receptance`.
    """
    at_rest = frequency_Hz.size > 0 and frequency_Hz[0] == 0.0
    solved = frequency_Hz
    if at_rest:
        first = frequency_Hz[1] if frequency_Hz.size > 1 else 1.0
        solved = np.concatenate([[STATIC_SHARE * first], frequency_Hz[1:]])
    data = receptance(
        line,
        solved,
        forces=sensors,
        sensors=places,
        temperature_C=temperature_C,
        formulation=formulation,
        threads=threads,
        progress=progress,
    )
    values = data["receptance"].values.transpose(0, 2, 1)
    if at_rest:
        if values.shape[0] > 1 and np.abs(values[0]).max() > _RIGID * np.abs(values[1]).max():
            raise InputError(
                f"nothing holds the line at rest: its response grows more than {_RIGID:g}-fold from "
                f"{solved[1]:.3g} to {solved[0]:.3g} Hz",
                where="line",
                remedy="hold it, or let the wheels run on the stretch that is held (from_m, to_m)",
            )
        values = values.copy()
        values[0] = values[0].real
    return np.asarray(values)
