"""Natural frequencies, damping ratios and mode shapes of a line."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from permway import _core
from permway.arrays import Complexes, Reals, is_real
from permway.errors import InputError
from permway.model.line import Line
from permway.model.place import Place
from permway.response.everywhere import everywhere
from permway.response.mode_search import search
from permway.response.poles import Poles, lines_for, poles_of
from permway.response.receptance import (
    CONVENTION,
    Formulation,
    between,
    check_line,
    check_places,
    place_coordinates,
)

STRUCK = 24
"""Places at which forces excite the modes, at least four on every body."""

_GOLDEN = 0.5 * (5.0**0.5 - 1.0)


def modes(
    line: Line,
    low_Hz: float,
    high_Hz: float,
    *,
    places: Sequence[Place] | None = None,
    temperature_C: float | None = None,
    formulation: Formulation = "chain",
    threads: int | None = None,
) -> xr.Dataset:
    """Modes of a line between two frequencies.

    They are poles of its response, not peaks: modes that overlap, or that damping hides, stay apart. What radiates
    into a beam without ends is damping too. A mode counts if rational functions through either half of the
    response's lines have it, to 1e-6 of its frequency.

    Parameters
    ----------
    line : Line
    low_Hz, high_Hz : float
        The line's laws are asked for from low / 1.2 to 1.2 high.
    places : sequence of Place, optional
        Where shapes are wanted; modes that move none of them are not found. By default all along all bodies, as
        :func:`permway.response.everywhere.everywhere` chooses.
    temperature_C : float, optional
        Needed if a law of the line depends on it.
    formulation, threads
        As in :func:`permway.receptance`.

    Returns
    -------
    xarray.Dataset
        By ascending frequency, over `mode`: `natural_frequency` in Hz, modulus of the pole over 2 pi;
        `damping_ratio`; `modal_mass` in kg, for a shape whose largest entry is 1, or NaN of modes that share one
        frequency, whose shapes are a choice of many. `shape` (mode, place), complex. Attribute `unsettled_Hz`:
        natural frequencies of poles that overlap too much to be distinguished, left out.

    Raises
    ------
    InputError
        For a band or places that do not fit.
    SolveError
        If the line cannot be solved, or its response is not one of modes.
    """
    check_line(line)
    _check_band(low_Hz, high_Hz)
    given = everywhere(line, high_Hz) if places is None else places
    check_places(line, given, "places")
    chosen = list(given)
    _check_some(chosen)
    struck = _struck(chosen)

    def response(frequency: Reals, everywhere: bool) -> Complexes:
        forces = [chosen[i] for i in struck]
        solved = between(
            line,
            frequency,
            forces=forces,
            sensors=chosen if everywhere else forces,
            temperature_C=temperature_C,
            formulation=formulation,
            threads=threads,
        )
        return solved.receptance

    found = search(response, float(low_Hz), float(high_Hz), struck)
    size = np.abs(found.omega)
    data = xr.Dataset(
        {
            "natural_frequency": ("mode", size / (2.0 * np.pi)),
            "damping_ratio": ("mode", found.omega.imag / size),
            "modal_mass": ("mode", found.modal_mass_kg),
            "shape": (("mode", "place"), found.shape),
        },
        coords={"mode": np.arange(1, size.size + 1), **place_coordinates("place", chosen)},
        attrs={
            "convention": CONVENTION,
            "formulation": formulation,
            "permway_version": _core.__version__,
            "band_Hz": [float(low_Hz), float(high_Hz)],
            "unsettled_Hz": found.unsettled_Hz.tolist(),
        },
    )
    if temperature_C is not None:
        data.attrs["temperature_C"] = temperature_C
    for name, text, unit in (
        ("natural_frequency", "natural frequency", "Hz"),
        ("damping_ratio", "damping ratio", "1"),
        ("modal_mass", "modal mass for a largest displacement of 1", "kg"),
        ("shape", "mode shape, the largest 1, positive down", "1"),
    ):
        data[name].attrs = {"long_name": text, "units": unit}
    return data


def poles_between(
    line: Line,
    low_Hz: float,
    high_Hz: float,
    *,
    places: Sequence[Place],
    temperature_C: float | None = None,
    formulation: Formulation = "chain",
    threads: int | None = None,
) -> Poles:
    """Poles between two frequencies in one fit, for who asks thousands of times; see :func:`modes`.

    Of two modes at one frequency the response has one pole. A mode that moves none of the places by a hundredth of
    what the liveliest does is not seen.
    """
    _check_band(low_Hz, high_Hz)
    _check_some(places)
    frequency = lines_for(low_Hz, high_Hz)
    solved = between(
        line,
        frequency,
        forces=places,
        sensors=places,
        temperature_C=temperature_C,
        formulation=formulation,
        threads=threads,
    )
    return poles_of(frequency, solved.receptance)


def _check_band(low_Hz: float, high_Hz: float) -> None:
    numbers = all(is_real(value) and np.isfinite(value) for value in (low_Hz, high_Hz))
    if not numbers or not 0.0 < low_Hz < high_Hz:
        raise InputError("must run from low to high, above 0 Hz", where="low_Hz, high_Hz", value=(low_Hz, high_Hz))


def _check_some(places: Sequence[Place]) -> None:
    if not places:
        raise InputError("no place to see a mode at", where="places", remedy="give one at least")


def _struck(places: Sequence[Place]) -> list[int]:
    """Some of the places, on every body: at no simple ratio, where many modes would stand still."""
    bodies: dict[str, list[int]] = {}
    for index, place in enumerate(places):
        bodies.setdefault(place.body.partition("[")[0], []).append(index)
    each = max(4, STRUCK // len(bodies))
    chosen: list[int] = []
    for mine in bodies.values():
        share = np.arange(1, each + 1) * _GOLDEN % 1.0
        chosen += mine if len(mine) <= each else [mine[i] for i in np.unique((share * len(mine)).astype(int))]
    return sorted(chosen)
