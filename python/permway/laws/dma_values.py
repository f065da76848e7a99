"""The complex modulus of a DMA table from whichever of its columns say it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.laws.columns import Column
from permway.laws.columns_read import WAYS
from permway.laws.textfile import Line

_ORDER = ("storage", "magnitude", "loss", "loss_factor", "phase")

_DISAGREE = 0.05
"""Relative difference between columns that say the same, beyond rounding of either. Half would refuse machines
that average storage and loss apart; twice would let a column of another row's values pass."""


def storage_and_loss(
    source: Path, rows: list[Line], read: dict[str, Reals], columns: dict[str, Column]
) -> tuple[Reals, Reals]:
    """Storage and loss from the first two columns that give them; what other columns say has to agree.

    Parameters
    ----------
    source : Path
    rows : list of Line
        As written, for the error.
    read : dict
        Columns in SI, by quantity: "storage", "loss", "magnitude" (absolute value), "loss_factor", "phase" (rad).
    columns : dict

    Raises
    ------
    InputError
        For a phase that is none of a solid, a loss above the absolute value, columns that contradict each other.
    """
    if "phase" in read:
        _check_phase(source, rows, read["phase"], columns["phase"])
    first, second = sorted(next(way for way in WAYS if way <= read.keys()), key=_ORDER.index)
    storage, loss = _solve(source, rows, columns, first, second, read[first], read[second])
    with np.errstate(all="ignore"):
        stated = {
            "magnitude": np.hypot(storage, loss),
            "loss_factor": loss / storage,
            "phase": np.arctan2(loss, storage),
            "loss": loss,
        }
    for name in set(read) & set(stated) - {first, second}:
        _check_agrees(source, rows, columns[name], read[name], stated[name])
    return storage, loss


def _solve(
    source: Path, rows: list[Line], columns: dict[str, Column], first: str, second: str, a: Reals, b: Reals
) -> tuple[Reals, Reals]:
    if (first, second) == ("storage", "loss"):
        return a, b
    if (first, second) == ("magnitude", "loss"):
        over = np.nonzero(b >= a)[0]
        if len(over):
            at = int(over[0])
            raise InputError(
                f"the loss is {b[at]:.4g}, not below the absolute value {a[at]:.4g}",
                where=f"{source}: line {rows[at].number}, column '{columns[second].header}'",
                value=float(b[at]),
                remedy="mixed units or a shifted column? correct or remove one of the two",
            )
        return np.sqrt(a**2 - b**2), b
    phase = b if second == "phase" else np.arctan(b)
    if first == "storage":
        return a, a * np.tan(phase)
    if first == "loss":
        return a / np.tan(phase), a
    return a * np.cos(phase), a * np.sin(phase)


def _check_phase(source: Path, rows: list[Line], phase: Reals, column: Column) -> None:
    bad = np.nonzero(phase >= 0.5 * np.pi)[0]
    if len(bad):
        raise InputError(
            "a phase of 90 degrees or more, which no solid has",
            where=f"{source}: line {rows[bad[0]].number}, column '{column.header}'",
            value=f"{np.degrees(phase[bad[0]]):.4g} deg",
            remedy="correct the value or the unit in the header (deg, rad)",
        )


def _check_agrees(source: Path, rows: list[Line], column: Column, found: Reals, stated: Reals) -> None:
    # What the last digit is worth may be more than the tolerance where little is printed.
    rounding = np.array([_last_digit(row.cells[column.index]) for row in rows]) * abs(column.factor)
    apart = np.nonzero(np.abs(stated - found) > _DISAGREE * np.abs(stated) + rounding)[0]
    if not len(apart):
        return
    at = int(apart[0])
    raise InputError(
        f"the other columns give {stated[at] / column.factor:.4g}, which this one contradicts",
        where=f"{source}: line {rows[at].number}, column '{column.header}'",
        value=float(found[at] / column.factor),
        remedy="mixed units or a shifted column? correct or remove one of the two",
    )


def _last_digit(cell: str) -> float:
    mantissa, _, power = cell.lower().partition("e")
    decimals = len(mantissa.replace(",", ".").partition(".")[2])
    try:
        return float(10.0 ** (int(power or 0) - decimals))
    except (ValueError, OverflowError):
        return 0.0
