"""Records that are tables of modes: natural frequencies, damping ratios, shapes at sensors."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from permway.arrays import Reals
from permway.campaign.parts import Record
from permway.campaign.tabular import matches
from permway.errors import InputError
from permway.laws.textfile import Line, number, read_lines
from permway.response.receptance import frequency_coordinate

if TYPE_CHECKING:
    from permway.campaign.campaign import Campaign

QUANTITIES = ("natural frequency", "damping ratio")

FREQUENCY = ("frequency_Hz", "frequency_sd_Hz")
DAMPING = ("damping", "damping_sd")
PERCENT = ("damping_percent", "damping_sd_percent")
KEPT = ("mode", "note")
"""Columns for people."""


def modes(campaign: Campaign, record: Record) -> xr.Dataset:
    """One mode in a row: frequency, damping and their standard deviations; shapes in columns of the labels.

    Returns
    -------
    xarray.Dataset
        `modes` and `relative_sd` (quantity, frequency), of natural frequency in Hz and damping ratio, NaN where
        no damping is stated; `shape` (sensor, frequency) if the table has any, in the sensors' units; coordinate
        `sensor`.

    Raises
    ------
    InputError
        For columns that are missing or not understood, cells that are no numbers, values that cannot be.
    """
    path = campaign.path(record)
    header, *rows = read_lines(path)
    percent = any(name in header.cells for name in PERCENT)
    damping, to_ratio = (PERCENT, 0.01) if percent else (DAMPING, 1.0)
    shaped = _check_columns(header, record, path, damping)
    chosen = [row for row in rows if _fits(row, header, path) and _selected(row, header, record)]
    where = f"{path}: line {header.number}"
    if not chosen:
        raise InputError("no row states this" if rows else "no row", where=where, value=dict(record.select))
    frequency = np.array([_above_zero(row, header, FREQUENCY[0], path) for row in chosen])
    low, high = record.band_Hz or (0.0, np.inf)
    used = np.flatnonzero((frequency >= low) & (frequency <= high))
    if not used.size:
        raise InputError("holds no mode of the record", where="band_Hz", value=(low, high))
    used = used[np.argsort(frequency[used], kind="stable")]
    chosen, frequency = [chosen[i] for i in used], frequency[used]
    spread = np.array([_above_zero(row, header, FREQUENCY[1], path) for row in chosen])
    ratios = np.array([_damping(row, header, damping, path, to_ratio) for row in chosen])
    names = [record.channels[label] for label in (shaped or record.channels)]
    data = xr.Dataset(
        {
            "modes": (("quantity", "frequency"), np.stack([frequency, ratios[:, 0]])),
            "relative_sd": (("quantity", "frequency"), np.stack([spread / frequency, ratios[:, 1]])),
        },
        coords={"quantity": list(QUANTITIES), "frequency": frequency_coordinate(frequency), "sensor": names},
    )
    data["modes"].attrs = {"long_name": "natural frequency in Hz, damping ratio", "units": "Hz, 1"}
    data["relative_sd"].attrs = {"long_name": "standard deviation over value", "units": "1"}
    if shaped:
        shape = np.array([[_cell(row, header, label, path) for row in chosen] for label in shaped])
        still = np.flatnonzero(~np.any(shape != 0.0, axis=0))
        if still.size:
            raise InputError(
                "a shape that is zero at all sensors", where=f"{path}: line {chosen[still[0]].number}"
            )
        data["shape"] = (("sensor", "frequency"), shape)
        data["shape"].attrs = {"long_name": "mode shape, any scale", "units": "1"}
    return data


def _check_columns(header: Line, record: Record, path: Path, damping: tuple[str, str]) -> list[str]:
    """Labels of the channels whose shapes the table has: all, or none.

    Raises
    ------
    InputError
        For a column that is missing, stands twice, or is not understood.
    """
    where = f"{path}: line {header.number}"
    twice = next((cell for cell in header.cells if header.cells.count(cell) > 1), None)
    if twice is not None:
        raise InputError("a column stands twice", where=where, value=twice, remedy="give each its own name")
    wanted = [*FREQUENCY, *record.select]
    if any(name in header.cells for name in (*DAMPING, *PERCENT)):
        wanted += damping
    missing = next((name for name in wanted if name not in header.cells), None)
    if missing is not None:
        remedy = f"it has {list(header.cells)}"
        if missing in (FREQUENCY[1], *DAMPING, *PERCENT):
            remedy += "; a value needs its standard deviation, and damping is in one unit"
        raise InputError("the table has no such column", where=where, value=missing, remedy=remedy)
    shaped = [label for label in record.channels if label in header.cells]
    if shaped and len(shaped) < len(record.channels):
        without = next(label for label in record.channels if label not in shaped)
        what = "has no column, and other channels have one: shapes are at all of them or at none"
        raise InputError(what, where=f"channels.{without}", remedy=f"it has {list(header.cells)}")
    known = {*wanted, *shaped, *KEPT}
    unknown = next((cell for cell in header.cells if cell not in known), None)
    if unknown is not None:
        raise InputError(
            "the column is not understood",
            where=where,
            value=unknown,
            remedy=f"use {[*FREQUENCY, *damping]}, labels of channels, {list(KEPT)}, or columns of select",
        )
    return shaped


def _fits(row: Line, header: Line, path: Path) -> bool:
    if len(row.cells) != len(header.cells):
        what = f"{len(row.cells)} cells where the header has {len(header.cells)}"
        raise InputError(what, where=f"{path}: line {row.number}")
    return True


def _selected(row: Line, header: Line, record: Record) -> bool:
    return all(matches(row, header, key, want) for key, want in record.select.items())


def _cell(row: Line, header: Line, name: str, path: Path) -> float:
    return number(row.cells[header.cells.index(name)], f"{path}: line {row.number}, column '{name}'")


def _above_zero(row: Line, header: Line, name: str, path: Path) -> float:
    value = _cell(row, header, name, path)
    if not value > 0.0:
        raise InputError("must be above 0", where=f"{path}: line {row.number}, column '{name}'", value=value)
    return value


def _damping(row: Line, header: Line, names: tuple[str, str], path: Path, to_ratio: float) -> Reals:
    """Damping ratio and its relative standard deviation; both NaN where both cells are empty."""
    if names[0] not in header.cells or not any(row.cells[header.cells.index(name)] for name in names):
        return np.array([np.nan, np.nan])
    ratio, spread = (to_ratio * _above_zero(row, header, name, path) for name in names)
    if ratio >= 1.0:
        what = "a damping ratio of 1 and more is of no vibration"
        remedy = "percent stand in the columns damping_percent and damping_sd_percent"
        raise InputError(what, where=f"{path}: line {row.number}, column '{names[0]}'", value=ratio, remedy=remedy)
    return np.array([ratio, spread / ratio])
