"""Records that are tables: decay rates, levels in bands, swept sines, moduli."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from permway.campaign.dataset import in_band
from permway.campaign.parts import Record
from permway.errors import InputError
from permway.laws.dma import DmaTable, read_dma, read_modulus_pair
from permway.laws.textfile import Line, number, read_lines
from permway.laws.transmissibility import read_shaker
from permway.response.receptance import frequency_coordinate

if TYPE_CHECKING:
    from permway.campaign.campaign import Campaign

_BAND = re.compile(r"\d+(\.\d+)?")
_OFF_NOMINAL = 0.03
"""How far a column's name may lie from a one-third octave's middle: nominal frequencies are rounded."""


def decay(campaign: Campaign, record: Record) -> xr.Dataset:
    """One row of decay rates, dB/m, in the columns that are named by a band's middle frequency."""
    band, values = _row(campaign, record)
    bad = np.flatnonzero(~(values > 0.0))
    if bad.size:
        what = "a decay rate must be above 0 dB/m"
        raise InputError(what, where=f"{record.file}, band {band[bad[0]]:g} Hz", value=float(values[bad[0]]))
    data = xr.Dataset({"decay_rate": ("band", values)}, coords={"band": ("band", band)})
    data["decay_rate"].attrs = {"long_name": "track decay rate", "units": "dB/m"}
    data["band"].attrs = {"long_name": "nominal middle of the one-third octave", "units": "Hz"}
    return data


def bands(campaign: Campaign, record: Record) -> xr.Dataset:
    """One row of mean squares in one-third octaves, in the sensor's unit squared, as SI."""
    band, values = _row(campaign, record)
    sensor = campaign.sensor(next(iter(record.channels.values())))
    data = xr.Dataset(
        {"mean_square": (("channel", "band"), values[None, :] * sensor.to_SI**2)},
        coords={"band": ("band", band), "channel": [sensor.name]},
    )
    data["mean_square"].attrs = {"long_name": "mean square in the band", "units": "SI2"}
    data["band"].attrs = {"long_name": "nominal middle of the one-third octave", "units": "Hz"}
    return data


def transmissibility(campaign: Campaign, record: Record) -> xr.Dataset:
    """A swept sine: the sensor's motion over that of the ground."""
    file = read_shaker(campaign.path(record))
    used = in_band(file.frequency_Hz, record)
    names = list(record.channels.values())
    if len(names) != 1:
        raise InputError("a swept sine has one channel, the mass", where="channels", value=names)
    data = xr.Dataset(
        {
            "transmissibility": (("channel", "frequency"), file.transmissibility[used][None, :]),
            "ground_acceleration": ("frequency", file.base_acceleration[used]),
        },
        coords={"frequency": frequency_coordinate(file.frequency_Hz[used]), "channel": names},
    )
    data["transmissibility"].attrs = {"long_name": "motion over that of the ground", "units": "1"}
    data["ground_acceleration"].attrs = {"long_name": "acceleration of the ground", "units": "m/s2"}
    return data


def material(campaign: Campaign, record: Record) -> xr.Dataset:
    """A material's modulus, point by point, over frequency and temperature."""
    condition = campaign.condition(record.condition)
    path = campaign.path(record)
    table: DmaTable
    if record.loss_file is None:
        table = read_dma(path, temperature_C=condition.temperature_C)
        if table.quantity != "modulus":
            what = "a table of stiffness, and a material's record is of its modulus"
            raise InputError(what, where=str(path), remedy="divide by the part's e A / h, in m, and write Pa")
    else:
        table = read_modulus_pair(path, campaign.folder / record.loss_file, temperature_C=condition.temperature_C)
    low, high = record.band_Hz or (0.0, np.inf)
    used = (table.frequency_Hz >= low) & (table.frequency_Hz <= high)
    if not used.any():
        raise InputError("holds no point of the record", where="band_Hz", value=(low, high))
    data = xr.Dataset(
        {"modulus": ("point", table.modulus[used])},
        coords={"frequency": ("point", table.frequency_Hz[used], {"units": "Hz"})},
    )
    data["modulus"].attrs = {"long_name": "complex modulus", "units": "Pa"}
    if table.temperature_C is not None:
        data.coords["temperature_C"] = ("point", table.temperature_C[used], {"units": "degC"})
    if table.strain is not None:
        data.coords["strain"] = ("point", table.strain[used], {"units": "1"})
    return data


def _row(campaign: Campaign, record: Record) -> tuple[np.ndarray, np.ndarray]:
    """Bands and values of the one row that states what `select` asks for.

    Raises
    ------
    InputError
        If no row does, or several; if columns are missing, or a cell is no number.
    """
    path = campaign.path(record)
    header, *rows = read_lines(path)
    for key in record.select:
        if key not in header.cells:
            known = [cell for cell in header.cells if not _BAND.fullmatch(cell)]
            raise InputError("the table has no such column", where=f"select.{key}", remedy=f"it has {known}")
    short = next((row for row in rows if len(row.cells) != len(header.cells)), None)
    if short is not None:
        what = f"{len(short.cells)} cells where the header has {len(header.cells)}"
        raise InputError(what, where=f"{path}: line {short.number}")
    found = [row for row in rows if all(matches(row, header, key, want) for key, want in record.select.items())]
    if len(found) != 1:
        what = "no row states this" if not found else f"{len(found)} rows say this"
        raise InputError(what, where="select", value=dict(record.select), remedy="select exactly one row")
    columns = [i for i, cell in enumerate(header.cells) if _BAND.fullmatch(cell)]
    band = np.array([float(header.cells[i]) for i in columns])
    if not columns:
        raise InputError("no column is named by a frequency", where=f"{path}: line {header.number}")
    number_of = 10.0 * np.log10(band / 1000.0)
    off = np.abs(10.0 ** ((number_of - np.round(number_of)) / 10.0) - 1.0)
    if off.max() > _OFF_NOMINAL:
        worst = int(off.argmax())
        what = "names no one-third octave"
        raise InputError(what, where=f"{path}: line {header.number}", value=header.cells[columns[worst]])
    low, high = record.band_Hz or (0.0, np.inf)
    used = [k for k, middle in enumerate(band) if low <= middle <= high]
    if not used:
        raise InputError("holds no band of the record", where="band_Hz", value=(low, high))
    row = found[0]
    values = [
        number(row.cells[columns[k]], f"{path}: line {row.number}, column '{header.cells[columns[k]]}'")
        for k in used
    ]
    return band[used], np.array(values)


def matches(row: Line, header: Line, key: str, wanted: object) -> bool:
    """Whether a row's cell in a column is what `select` asks for."""
    cell = row.cells[header.cells.index(key)]
    if isinstance(wanted, bool):
        return cell.lower() == str(wanted).lower()
    if isinstance(wanted, str):
        return cell == wanted
    try:
        return float(cell) == wanted
    except ValueError:
        return False
