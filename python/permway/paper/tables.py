"""Tables 5 to 8 and the flexibility's minima: printed beside computed, under each convention and pad."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal

import xarray as xr

from permway.paper.printed import PRINTED, Printed
from permway.paper.readings import readings

Pad = Literal["free at each temperature", "one law for all"]
Status = Literal["holds", "missed", "open", "shown"]

FREE: Pad = "free at each temperature"
ONE_LAW: Pad = "one law for all"
_AT = {"body_bounce": [1.0, 5.0], "body_pitch": [1.0, 7.0]}


@dataclass(frozen=True)
class Row:
    """One printed number and what is computed for it.

    Attributes
    ----------
    table, quantity, temperature_C, unit, printed, at_Hz
        As in :class:`permway.paper.printed.Printed`.
    convention, pad : str
    computed : float
    ratio : float
        Computed over printed.
    bar : str
        What is asked of it; empty if the convention is not the paper's.
    status : "holds", "missed", "open" or "shown"
        "open": no explanation is known; "shown": nothing is asked.
    """

    table: str
    quantity: str
    temperature_C: int
    unit: str
    at_Hz: float | None
    printed: float
    computed: float
    ratio: float
    convention: str
    pad: str
    bar: str
    status: Status

    def as_dict(self) -> dict[str, Any]:
        """The row as plain data."""
        return asdict(self)


def rows(runs: Mapping[int, xr.Dataset], *, convention: str, pad: Pad, judged: bool) -> list[Row]:
    """All rows of one convention and pad.

    Parameters
    ----------
    runs : dict of temperature to Dataset
        From :meth:`permway.paper.conventions.Convention.run`.
    convention : str
        Its name.
    pad : str
    judged : bool
        Whether the printed numbers should come out under this convention.
    """
    found = {t: readings(data, _AT) for t, data in runs.items()}
    result = []
    for row in PRINTED:
        at = row.at_Hz if row.quantity in _AT else None
        computed = found[row.temperature_C][row.quantity, at]
        bar, status = _judge(row, computed, pad) if judged else ("", "shown")
        result.append(
            Row(
                table=row.table,
                quantity=row.quantity,
                temperature_C=row.temperature_C,
                unit=row.unit,
                at_Hz=row.at_Hz,
                printed=row.value,
                computed=computed,
                ratio=computed / row.value,
                convention=convention,
                pad=pad,
                bar=bar,
                status=status,
            )
        )
    return result


def _judge(row: Printed, computed: float, pad: Pad) -> tuple[str, Status]:
    if row.table == "Table 8":
        return "", "open"
    if row.unit == "Hz":
        return "within 3 Hz", _holds(abs(computed - row.value) <= 3.0)
    percent = {
        "body_bounce": 2.0,
        "body_pitch": 2.0,
        "force": 2.0 if pad == FREE else 8.0,
        "wheelset": 3.0 if pad == FREE else 15.0,
    }[row.quantity]
    return f"within {percent:g} %", _holds(abs(computed / row.value - 1.0) <= percent / 100.0)


def _holds(yes: bool) -> Status:
    return "holds" if yes else "missed"
