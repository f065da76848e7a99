"""The decay rate that a test by EN 15461 would find on a model's track."""

from __future__ import annotations

import numpy as np
import xarray as xr

from permway import _core
from permway.arrays import is_real
from permway.campaign.predictions.decay import band_moduli, lines_of
from permway.errors import InputError
from permway.model.line import Line
from permway.model.place import Place
from permway.recordings.estimates.bands import bands_between
from permway.recordings.estimates.decay_rate import grid_positions
from permway.recordings.estimates.decay_rate import track_decay_rate as rate_of
from permway.response.receptance import Formulation, between, check_line

_KEPT = ("decay_rate", "far_drop_dB", "suitable")


def track_decay_rate(
    line: Line,
    *,
    at_m: float,
    body: str = "rail",
    bay_m: float = 0.6,
    from_Hz: float = 100.0,
    to_Hz: float = 5000.0,
    temperature_C: float | None = None,
    formulation: Formulation = "chain",
    threads: int | None = None,
) -> xr.Dataset:
    """Track decay rate of a model in one-third octaves, vertical (EN 15461:2008+A1:2010).

    The accelerometer stands at `at_m`, blows fall there and at the 28 other places of the standard's grid, up to
    66 bays to the right. Of every band twelve lines are taken.

    Parameters
    ----------
    line : Line
    at_m : float
    body : str
        The rail.
    bay_m : float
        Distance between sleepers; 0.6 m also where there are none (clause 6.7).
    from_Hz, to_Hz : float
        First and last band by mid-band frequency.
    temperature_C : float, optional
        Needed if a law of the line depends on it.
    formulation, threads
        As in :func:`permway.receptance`.

    Returns
    -------
    xarray.Dataset
        Over `band`, the nominal frequency in Hz: `decay_rate` in dB/m; `far_drop_dB`, how far the last blow's
        response lies below the first's; `suitable`, whether the grid is long enough (clauses 6.7 and 7): elsewhere
        the rate is an upper bound. Attribute `floor_dB_per_m`: the least that the grid can show.

    Raises
    ------
    InputError
        If the grid reaches beyond the rail's supports, where a rail of the model rests on nothing.
    SolveError
        If the line cannot be solved.
    """
    check_line(line)
    if not is_real(at_m) or not np.isfinite(at_m):
        raise InputError("must be a place", where="at_m", value=at_m, remedy="give x in m")
    bands = bands_between(from_Hz, to_Hz)
    position = grid_positions(bay_m)
    _check_supported(line, body, float(at_m), float(position[-1]))
    blows = [Place(body=body, x_m=float(at_m + x)) for x in position]
    frequency = lines_of(bands.middle_Hz)
    solved = between(
        line,
        frequency,
        forces=blows[:1],
        sensors=blows,
        temperature_C=temperature_C,
        formulation=formulation,
        threads=threads,
    )
    # The line is reciprocal: what blows along the rail do at the accelerometer is what one there does along it.
    moduli = band_moduli(solved.receptance.transpose(0, 2, 1), frequency)
    found = rate_of(moduli, position, warn=False)
    data = found[list(_KEPT)].rename(line="band")
    data = data.assign_coords(
        band=("band", bands.nominal_Hz, {"long_name": "nominal mid-band frequency", "units": "Hz"}),
        middle_Hz=("band", bands.middle_Hz, {"long_name": "exact mid-band frequency", "units": "Hz"}),
    )
    data.attrs = {
        "method": found.attrs["method"],
        "floor_dB_per_m": found.attrs["floor_dB_per_m"],
        "body": body,
        "at_m": float(at_m),
        "bay_m": float(bay_m),
        "formulation": formulation,
        "permway_version": _core.__version__,
    }
    if temperature_C is not None:
        data.attrs["temperature_C"] = temperature_C
    return data


def _check_supported(line: Line, body: str, at_m: float, reach_m: float) -> None:
    """Refuse a grid that leaves the stretch on which the rail rests on something."""
    index = line.locate(body, at_m, where="at_m")
    table = line.joint_table()
    held = table.x[(table.upper == index) | (table.lower == index)]
    if not held.size:
        raise InputError("rests on nothing", where="body", value=body, remedy="name the rail")
    low, high = float(held.min()), float(held.max())
    if at_m < low or at_m + reach_m > high:
        raise InputError(
            f"the grid runs from {at_m:g} to {at_m + reach_m:g} m, {body} is supported from {low:g} to {high:g} m",
            where="at_m",
            value=at_m,
            remedy=f"give at_m between {low:g} and {high - reach_m:g}"
            if high - reach_m >= low
            else f"lengthen the track to {reach_m:g} m at least",
        )
