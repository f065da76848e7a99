"""Phases in degrees that a header, or the campaign, states to be in radians."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from permway.campaign.campaign import Campaign
from permway.checking.blunder import Blunder
from permway.errors import InputError
from permway.recordings.readers import read_table
from permway.recordings.readers.formats import recognise
from permway.recordings.readers.stored import is_one_of
from permway.recordings.readers.text_frf import PHASE

LARGEST_RAD = 4.0 * math.pi
"""Beyond this, and within a turn of degrees, no wrapped phase is in radians."""


def angles(campaign: Campaign) -> Iterator[Blunder]:
    """Tables whose phases are called radians and lie as degrees do.

    After reading nothing states: degrees taken for radians are wrapped to any phase.
    """
    for record in campaign.stated.records:
        if record.statistic != "frf":
            continue
        try:
            if recognise(campaign.path(record), record.format, record.encoding) != "text":
                continue
            table = read_table(campaign.path(record), format=record.format, hints=record.hints)
        except InputError:
            # Why it cannot be read is reported elsewhere.
            continue
        for name, cells in table.columns.items():
            if not is_one_of(name, tuple(PHASE)) or not isinstance(cells, np.ndarray):
                continue
            unit = record.hints.unit_of(name) or table.units[name] or name.lower().partition("_")[2]
            largest = float(np.nanmax(np.abs(cells), initial=0.0))
            if unit.lower().startswith("rad") and LARGEST_RAD < largest <= 360.0 and _turns(cells) == 360.0:
                what = f"'{name}' is stated to be in radians and reaches {largest:.4g}: degrees"
                remedy = f'in the record: unit = {{ {name} = "deg" }}'
                yield Blunder("angle", f"records.{record.name}", what, remedy, asked=True)


def _turns(cells: np.ndarray) -> float:
    """What phases jump by where they are wrapped: 360 for degrees; 0 if they do not jump by that."""
    jumps = np.abs(np.diff(cells[np.isfinite(cells)]))
    jumps = jumps[jumps > 180.0]
    # Phases that never wrap and lie within a half turn are of either sign of it.
    within = float(np.nanmax(np.abs(cells))) <= 180.0 * 1.001
    return 360.0 if within or (jumps.size and float(jumps.max()) <= 361.0) else 0.0
