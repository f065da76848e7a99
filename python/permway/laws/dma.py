"""Tables of dynamic mechanical analysis: what is in one, and reading it from a file."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from permway.arrays import Complexes, Reals, real_numbers
from permway.errors import InputError
from permway.laws.columns import recognise
from permway.laws.columns_read import loss_of, read_column, refuse_kelvin, refuse_missing, two_columns, unit_scale
from permway.laws.textfile import read_lines


@dataclass(frozen=True, kw_only=True)
class DmaTable:
    """Modulus against frequency and temperature.

    Attributes
    ----------
    frequency_Hz : ndarray, shape (n,)
        Hz.
    temperature_C : ndarray, shape (n,), or None
        Degrees Celsius; None if the source does not say.
    storage_Pa, loss_Pa : ndarray, shape (n,)
        Pa.
    strain : ndarray, shape (n,), or None
        Amplitude of dynamic strain, as a fraction.
    static_Pa : float or None
        Quasi-static modulus, if the source has one; never part of the rows above.
    source : str
        Where it came from.
    notes : tuple of str
        What the reader did beside reading.
    """

    frequency_Hz: Reals
    temperature_C: Reals | None
    storage_Pa: Reals
    loss_Pa: Reals
    strain: Reals | None = None
    static_Pa: float | None = None
    source: str = ""
    notes: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        rows = len(self.frequency_Hz)
        for name in ("frequency_Hz", "temperature_C", "storage_Pa", "loss_Pa", "strain"):
            column = getattr(self, name)
            if column is None:
                continue
            fixed = real_numbers(column, name).copy()
            if fixed.shape != (rows,) or not np.isfinite(fixed).all():
                raise InputError(
                    "a column of a DMA table is finite and as long as frequency_Hz",
                    where=name,
                    value=fixed.shape,
                    remedy=f"give {rows} finite numbers",
                )
            if name not in ("temperature_C", "strain") and not (fixed > 0.0).all():
                raise InputError("must be above zero", where=name, value=float(fixed.min()))
            fixed.flags.writeable = False
            object.__setattr__(self, name, fixed)

    def __len__(self) -> int:
        return len(self.frequency_Hz)

    @property
    def modulus(self) -> Complexes:
        """Complex modulus, Pa, shape (n,)."""
        return np.asarray(self.storage_Pa + 1j * self.loss_Pa)

    @property
    def loss_factor(self) -> Reals:
        """Loss over storage, shape (n,)."""
        return np.asarray(self.loss_Pa / self.storage_Pa)

    def isotherms(self, gap_K: float = 1.0) -> Reals:
        """Mean temperature of each group of rows closer than `gap_K`, rising."""
        if self.temperature_C is None:
            return np.empty(0)
        ordered = np.sort(self.temperature_C)
        groups = np.split(ordered, np.nonzero(np.diff(ordered) > gap_K)[0] + 1)
        return np.array([group.mean() for group in groups])


def read_dma(
    path: str | Path, *, frequency_Hz: float | None = None, temperature_C: float | None = None
) -> DmaTable:
    """Read a DMA table from a CSV or TSV file with a header.

    Columns are found by name and unit, in any order; see :mod:`permway.laws.columns` for the names. Needed
    are a storage modulus and a loss modulus or loss factor; a frequency; a temperature unless the test was
    at an unstated one.

    Parameters
    ----------
    path : path
        The file. Comma, semicolon or tab between the cells; lines that start with # are remarks.
    frequency_Hz : float, optional
        Of a temperature sweep whose file has no frequency column.
    temperature_C : float, optional
        Of a frequency sweep whose file has no temperature column.

    Returns
    -------
    DmaTable
        In SI units.

    Raises
    ------
    InputError
        For anything in the file that cannot be used, with line and column.
    """
    source = Path(path)
    lines = read_lines(source)
    header, rows = lines[0], lines[1:]
    columns = recognise(header.cells, where=f"{source}: line {header.number}")
    refuse_missing(columns, source, frequency_Hz)
    if not rows:
        raise InputError("a header but no rows", where=str(source), remedy="give at least one measured row")
    read = {name: read_column(source, rows, header, column) for name, column in columns.items()}
    count = len(rows)
    if "temperature" in read:
        refuse_kelvin(source, rows, read["temperature"], columns["temperature"])
        temperature: Reals | None = read["temperature"]
    else:
        temperature = None if temperature_C is None else np.full(count, float(temperature_C))
    return DmaTable(
        frequency_Hz=read["frequency"] if "frequency" in read else np.full(count, float(frequency_Hz or 0.0)),
        temperature_C=temperature,
        storage_Pa=read["storage"],
        loss_Pa=loss_of(source, rows, read, columns),
        strain=read.get("strain"),
        source=str(source),
    )


def read_modulus_pair(
    storage_path: str | Path,
    loss_path: str | Path,
    *,
    unit: str | None = None,
    temperature_C: float | None = None,
) -> DmaTable:
    """Join two headerless files, frequency with storage modulus and frequency with loss factor.

    A first line at 0 Hz is quasi-static and kept apart as `static_Pa`. The loss factor is interpolated over
    the logarithm of frequency onto the frequencies of the storage modulus that lie within its range;
    `notes` says how many fell outside.

    Parameters
    ----------
    storage_path, loss_path : path
        Two columns each.
    unit : {"Pa", "kPa", "MPa", "GPa"}, optional
        Of the modulus; else taken from the end of the file's name, as in `storage_modulus_MPa.tsv`.
    temperature_C : float, optional
        At which both were measured, if known.

    Returns
    -------
    DmaTable
        In SI units.

    Raises
    ------
    InputError
        For anything in either file that cannot be used, with line and column.
    """
    source, other = Path(storage_path), Path(loss_path)
    scale = unit_scale(source, unit)
    static, frequency, storage = two_columns(source, "storage modulus", scale)
    _, loss_frequency, loss_factor = two_columns(other, "loss factor", 1.0)
    inside = (frequency >= loss_frequency[0]) & (frequency <= loss_frequency[-1])
    if not inside.any():
        raise InputError(
            f"no frequency in common with {source}",
            where=str(other),
            value=(float(loss_frequency[0]), float(loss_frequency[-1])),
            remedy="give both over one band",
        )
    moved = int(np.sum(~np.isin(frequency[inside], loss_frequency)))
    notes = (
        f"loss factor interpolated over log frequency at {moved} of {int(inside.sum())} rows; "
        f"{int((~inside).sum())} rows of the storage modulus lie outside its range and were left out",
    )
    frequency, storage = frequency[inside], storage[inside]
    matched = np.interp(np.log(frequency), np.log(loss_frequency), loss_factor)
    return DmaTable(
        frequency_Hz=frequency,
        temperature_C=None if temperature_C is None else np.full(len(frequency), float(temperature_C)),
        storage_Pa=storage,
        loss_Pa=storage * matched,
        static_Pa=static,
        source=f"{source}, {other}",
        notes=notes,
    )
