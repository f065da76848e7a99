"""Measured over predicted, in the units that people read."""

from __future__ import annotations

import numpy as np

from permway.arrays import Reals
from permway.checking.compared import Compared

DECIBELS = 20.0 / np.log(10.0)
"""Of a neper."""


def levels_dB(one: Compared) -> Reals:
    """Measured over predicted, shape (rows that have a level, F); NaN where a line states nothing."""
    rows = one.levelled
    with np.errstate(divide="ignore"):
        levels = DECIBELS * np.log(np.abs(one.measured[rows] / one.predicted[rows]))
    return np.where(one.used[rows], levels, np.nan)


def phases_deg(one: Compared) -> Reals:
    """Measured less predicted, -180 to 180, shape (rows that have a phase, F); NaN where a line states nothing."""
    rows = one.phased
    phases = np.rad2deg(np.angle(one.measured[rows] / one.predicted[rows]))
    return np.where(one.used[rows], phases, np.nan)
