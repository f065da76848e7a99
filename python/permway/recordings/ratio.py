"""Which sensor and force point have a response of a unit."""

from __future__ import annotations

from permway.errors import InputError
from permway.recordings.channel import UNITS
from permway.units import parse_unit


def ratio_of(unit: str | None) -> tuple[str, str, str] | None:
    """Quantity and unit of the sensor, and unit of the force, that a response's unit is the ratio of.

    None if no sensor and force point have such units, and for what is no unit.
    """
    try:
        found = parse_unit(unit or "")
    except InputError:
        return None
    for quantity, units in UNITS.items():
        for top in units:
            for force in UNITS["force"]:
                if parse_unit(f"({top})/{force}").same(found):
                    return quantity, top, force
    return None
