"""The response of a line with two rails to a force on one of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import xarray as xr
from numpy.typing import ArrayLike

from permway.errors import InputError, must_be
from permway.model.line import Line
from permway.model.place import Place
from permway.model.roll import Roll, antisymmetric
from permway.response.receptance import check_line, check_places, receptance


def both_rails(
    symmetric: Line,
    other: Line | Roll,
    frequency_Hz: ArrayLike,
    *,
    forces: Sequence[Place],
    sensors: Sequence[Place],
    **options: Any,
) -> xr.Dataset:
    """Displacement on the side of the force and on the other, per unit force under one rail only.

    A force on one rail is half of it on both alike, and half of it down on one and up on the other. So what moves
    with the force is (Hs + Ha) / 2, and what is its mirror image on the other side (Hs - Ha) / 2.

    Parameters
    ----------
    symmetric : Line
        Half model: one rail and half of what carries both.
    other : Line or Roll
        The antisymmetric half with the same names, or what :func:`permway.model.roll.antisymmetric` makes it from.
    frequency_Hz : array_like, shape (F,)
        Ascending, positive.
    forces, sensors : sequence of Place
        At the rail's distance from the middle of the track, for bodies that carry both rails too.
    **options
        Those of :func:`permway.response.receptance.receptance`, but for `extensions`.

    Returns
    -------
    xarray.Dataset
        `receptance` and `receptance_other_side` (frequency, sensor, force), complex, m/N.

    Raises
    ------
    InputError
        As `receptance` and `antisymmetric` do, and for places that one of the halves has not.
    SolveError
        If a half cannot be solved at a frequency.
    """
    if "extensions" in options:
        raise InputError("is not for both rails", where="extensions", remedy="ask for each half's own")
    check_line(symmetric, "symmetric")
    must_be(other, (Line, Roll), "other")
    odd = antisymmetric(symmetric, other) if isinstance(other, Roll) else other
    for kind, places in (("forces", forces), ("sensors", sensors)):
        check_places(odd, places, kind)
    found = [
        receptance(line, frequency_Hz, forces=forces, sensors=sensors, **options) for line in (symmetric, odd)
    ]
    alike, opposed = (data["receptance"] for data in found)
    data = found[0].copy()
    failures = [text for half in found if (text := str(half.attrs["failures"]))]
    data.attrs["failures"] = "; ".join(failures)
    data["receptance"] = (0.5 * (alike + opposed)).assign_attrs(alike.attrs)
    across = {"long_name": "receptance across the track", "units": "m/N"}
    data["receptance_other_side"] = (0.5 * (alike - opposed)).assign_attrs(across)
    return data
