"""Where a sheet's wheelsets stand: its `runs.position`, read whole or asked about."""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from permway.campaign.importers.sheet_form import Sheet
from permway.errors import InputError

WHERE = "sheet.json: runs.position"

WHEELSETS = 4

AGREE_M = 0.02
"""How far distances of wheelsets may be from the vehicle's without a warning, beside their rounding, m.

What a tape measure along a bogie gets wrong. At half of it careful sheets are warned of; at twice, 2.50 m that
became 2.54 m go unseen, which shifts the zeros of a bogie's response by 1.6 %.
"""

REMEDY = (
    "write 'wheelsets 1..4 at 26, 23.5, 8.5, 6 m' or 'wheelsets 1..4 at x0+10, x0+7.5, x0-7.5, x0-10 with "
    "x0 = 16 m', the leading one first, and where they were rounded add ', each rounded to the nearest 0.16 m'"
)

MOVING = "moving-irregularity model"
"""How a sheet states that its trains stand while the irregularity moves."""

_SIZE = r"\d+(?:\.\d+)?"
_TERM = rf"(?:x0(?:\s*[+-]\s*{_SIZE})?|-?{_SIZE})(?:\s*m)?"
_NEXT = r"(?:,\s*(?=x0)|,?\s+and\s+|,\s+)"
_SENTENCE = re.compile(
    rf"wheelsets\s+1\s*(?:\.\.|\.\.\.|-|to)\s*{WHEELSETS}\s+at\s+(?P<places>{_TERM}(?:{_NEXT}{_TERM})*)"
    rf"(?:,?\s+with\s+x0\s*=\s*(?P<x0>-?{_SIZE})\s*m)?"
    rf"(?:\s*\({MOVING}\))?"
    rf"(?:,\s*not\s+rounded|,\s*(?:each\s+)?rounded\s+to\s+the\s+nearest\s+(?P<grid>{_SIZE})\s*m"
    r"(?:,\s*halfway\s+to\s+the\s+even\s+multiple)?)?",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class Position:
    """Where the wheelsets of a standing train are.

    Attributes
    ----------
    centre_m : float
        The middle of the train.
    wheels_m : tuple of float
        The leading wheelset first.
    """

    centre_m: float
    wheels_m: tuple[float, ...]


def position(sheet: Sheet) -> Position:
    """Read where the wheelsets stand.

    A sheet states it in words, or as a list of four numbers in m; one that does not has the vehicle in the middle
    of the deck. They are rounded only where the words say so, halfway between two multiples to the even one: of 26
    and 6 m and multiples of 0.16 m that makes 25.92 and 6.08 m, as the records of such sheets have it.

    Raises
    ------
    InputError
        For words that are not understood to the last, and for places that do not descend.
    """
    stated = "" if sheet.runs is None else sheet.runs.position
    middle = 0.5 * sheet.layout.spans * sheet.layout.span_m
    if stated == "":
        return Position(middle, tuple(round(middle + away, 6) for away in _of_vehicle(sheet)))
    x0, places, grid = _read(stated) if isinstance(stated, str) else (None, [float(x) for x in stated], 0.0)
    if len(places) != WHEELSETS:
        raise InputError(
            f"has {len(places)} places of {WHEELSETS} wheelsets", where=WHERE, value=stated, remedy=REMEDY
        )
    # Three spans of 31.4 m are 94.2 m but for a last digit, which must not decide what is halfway.
    stand = [grid * float(np.round(round(x / grid, 9))) for x in places] if grid else places
    wheels = tuple(round(x, 6) for x in stand)
    if any(behind >= before for before, behind in pairwise(wheels)):
        raise InputError(
            "must descend: the leading wheelset first", where=WHERE, value=list(wheels), remedy=REMEDY
        )
    _warn(sheet, wheels, AGREE_M + grid)
    if x0 is None:
        x0 = round(0.5 * (places[0] + places[-1]), 6)
    return Position(middle if abs(x0 - middle) < 1e-6 else x0, wheels)


def _read(stated: str) -> tuple[float | None, list[float], float]:
    """The origin, the places as they are written, and what they are rounded to, or 0."""
    found = _SENTENCE.fullmatch(stated.strip().removesuffix(".").rstrip())
    if found is None:
        raise InputError("where do the wheelsets stand? not understood", where=WHERE, value=stated, remedy=REMEDY)
    terms = [re.sub(r"[\sm]", "", term) for term in re.findall(_TERM, found["places"], re.IGNORECASE)]
    counted = [term.lower().startswith("x0") for term in terms]
    x0 = None if found["x0"] is None else float(found["x0"])
    if (x0 is None) == any(counted):
        what = "where do the wheelsets stand? x0 is not stated" if x0 is None else "what is counted from x0?"
        raise InputError(what, where=WHERE, value=stated, remedy=REMEDY)
    grid = float(found["grid"] or 0.0)
    if found["grid"] and not grid:
        raise InputError("rounded to what? 0 m is no step", where=WHERE, value=stated, remedy=REMEDY)
    places = [
        (x0 or 0.0) + float(term[2:] or 0.0) if from_x0 else float(term)
        for term, from_x0 in zip(terms, counted, strict=True)
    ]
    return x0, places, grid


def _of_vehicle(sheet: Sheet) -> list[float]:
    """Of the wheelsets from the middle of the train, m."""
    bogie, wheel = 0.5 * sheet.values.vehicle.lc, 0.5 * sheet.values.vehicle.lt
    return [bogie + wheel, bogie - wheel, wheel - bogie, -bogie - wheel]


def _warn(sheet: Sheet, wheels: tuple[float, ...], within_m: float) -> None:
    """Distances that are not the vehicle's: lags of the records and moments of the bogies would not agree."""
    vehicle = _of_vehicle(sheet)
    apart = [
        (i, wheels[i - 1] - wheels[i], vehicle[i - 1] - vehicle[i])
        for i in range(1, WHEELSETS)
        if abs(wheels[i - 1] - wheels[i] - vehicle[i - 1] + vehicle[i]) > within_m + 1e-9
    ]
    for i, stand, built in apart:
        warnings.warn(
            f"{WHERE}: wheelsets {i} and {i + 1} stand {stand:g} m apart, and by values.vehicle.lc and lt "
            f"{built:g} m; the places are taken as given",
            stacklevel=5,
        )
