"""Where a sheet's sensors and hammer points are: their names, and a record's labels of them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from permway.campaign.importers.sheet_form import Location
from permway.errors import InputError

_NODES = {1: "rail", 2: "slab", 3: "base", 4: "girder"}


def names_of(locations: Sequence[Location]) -> list[str]:
    """A name of each place as "rail@16.32"; of several at one place the second is "rail@16.32 (2)"."""
    before = [locations[:index].count(location) for index, location in enumerate(locations)]
    return [
        f"{body}@{x:.12g}" + (f" ({count + 1})" if count else "")
        for (body, x), count in zip(locations, before, strict=True)
    ]


def matched(labels: Iterable[str], locations: Sequence[Location], source: Path, what: str) -> dict[str, str]:
    """The name of each place of the sheet, by the file's label of it.

    Labels of one place are taken in the file's order, as the sheet has its own.

    Raises
    ------
    InputError
        For a place that the file does not have, or has more often than the sheet.
    """
    there = [(label, location) for label in dict.fromkeys(labels) if (location := _location_of(label)) is not None]
    found: dict[str, str] = {}
    for index, (location, name) in enumerate(zip(locations, names_of(locations), strict=True)):
        body, x = location
        # A UFF node has centimetres, and a body without the number of its beam.
        near = [
            (label, at)
            for label, (of, at) in there
            if of in (body, body.partition("[")[0]) and round(at, 2) == round(x, 2)
        ]
        mine = [label for label, at in near if abs(at - x) < 1e-9] or [label for label, _ in near]
        free = [label for label in mine if label not in found]
        where = f"{source}: hammer.{what}[{index}]"
        if not free:
            raise InputError("the file has no such place", where=where, value=list(location))
        if len(mine) > locations.count(location):
            raise InputError(
                f"which of {mine} is it? the sheet has that place {_times(locations.count(location))}",
                where=where,
                value=list(location),
                remedy=f"name all of them in hammer.{what}, in the file's order, or leave one in the file",
            )
        found[free[0]] = name
    return found


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"


def _location_of(label: str) -> Location | None:
    """Body and x of a label: "rail@16.32", "girder[2]@12.8", or a UFF node 10000 * body + x in cm."""
    named = re.match(r"\s*([A-Za-z]\w*(?:\[\d+\])?)\s*@\s*(-?\d+(?:\.\d+)?)", label)
    if named is not None:
        return named[1], float(named[2])
    node = re.search(r"\d{5,}", label)
    if node is None or int(node[0]) // 10000 not in _NODES:
        return None
    return _NODES[int(node[0]) // 10000], int(node[0]) % 10000 / 100.0
