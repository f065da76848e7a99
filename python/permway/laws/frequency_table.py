"""What laws that are tables over frequency share: columns that fit, and no value outside."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError

_EDGE = 1e-9
"""Relative slack at the ends of a table, for frequencies that were computed."""


def check_columns(frequency_Hz: Sequence[float], **columns: Sequence[float]) -> None:
    """Refuse a table of fewer than two rows, columns of other lengths, frequencies that do not rise from above 0.

    Raises
    ------
    ValueError
        For pydantic, which states where.
    """
    rows = len(frequency_Hz)
    if rows < 2:
        raise ValueError(f"a table needs at least two frequencies, not {rows}")
    for name, column in columns.items():
        if len(column) != rows:
            raise ValueError(f"{name} has {len(column)} rows, frequency_Hz has {rows}; they must match")
    previous = 0.0
    for index, frequency in enumerate(frequency_Hz):
        if frequency <= previous:
            raise ValueError(f"frequency_Hz[{index}] = {frequency:g} must rise strictly, from above {previous:g}")
        previous = frequency


def check_inside(frequency: Reals, frequency_Hz: Sequence[float], remedy: str) -> None:
    """Refuse to extrapolate.

    Raises
    ------
    InputError
        Naming the first frequency outside the table.
    """
    low, high = frequency_Hz[0], frequency_Hz[-1]
    outside = (frequency < low * (1.0 - _EDGE)) | (frequency > high * (1.0 + _EDGE))
    if outside.any():
        raise InputError(
            f"outside the table, which runs from {low:g} to {high:g} Hz; it does not extrapolate",
            where="frequency_Hz",
            value=float(np.atleast_1d(frequency)[np.atleast_1d(outside)][0]),
            remedy=remedy,
        )
