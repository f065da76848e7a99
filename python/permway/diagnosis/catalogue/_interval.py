"""Joints of a layer changed over a stretch whose ends may lie anywhere."""

from __future__ import annotations

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import with_factors
from permway.diagnosis.catalogue._roles import spacing
from permway.errors import InputError
from permway.model.line import Line

WHOLE, OUTSIDE = 0.25, 0.75
"""Spacings outside the stretch up to which a joint is changed wholly, and from which it is not."""


def stations_of(line: Line, law: str) -> Reals:
    """Where the joints of a law are, ascending, m."""
    table = line.joint_table()
    laws = list(line.laws)
    if law not in laws:
        # It came with another amendment, which is not there.
        raise InputError("there is no such law", where="line.laws", value=law, remedy=f"one of {laws}")
    return np.unique(table.x[table.law == laws.index(law)])


def spacing_of(line: Line, law: str) -> float:
    """Distance of neighbouring joints of a law, m; 1 where they have none."""
    return spacing(stations_of(line, law))


def weakened(campaign: Campaign, law: str, centre_m: float, length_m: float, factor: float) -> Campaign:
    """All layers of a law with a factor over a stretch, from its first joint to its last.

    A joint within a quarter of a spacing of the stretch has the factor, one three quarters away has none of it,
    and between the change fades linearly. So some stretch changes any whole number of joints and nothing else, and
    the model follows the ends from one such stretch to the next.
    """
    step = spacing_of(campaign.model.line, law)
    return with_factors(campaign, law, lambda x: 1.0 - (1.0 - factor) * shares(x, centre_m, length_m, step))


def shares(x: Reals, centre_m: float, length_m: float, step_m: float) -> Reals:
    """How much of a change each joint has: 1 in the stretch, 0 outside, fading linearly between.

    Parameters
    ----------
    x : ndarray, shape (J,)
        Places, m.
    centre_m, length_m, step_m : float
        Of the stretch, and spacing of the joints.
    """
    away = (np.abs(x - centre_m) - 0.5 * length_m) / step_m
    # A place on the border counts as within, whatever its last digit.
    return np.asarray(np.clip((OUTSIDE - away) / (OUTSIDE - WHOLE), 0.0, 1.0).round(12))


def span_of(x: Reals, centre_m: float, length_m: float, step_m: float) -> tuple[float, float]:
    """First and last of the joints that have half of the change or more; the stretch itself if none has, m."""
    mine = x[shares(x, centre_m, length_m, step_m) >= 0.5]
    half = 0.5 * length_m
    return (float(mine.min()), float(mine.max())) if mine.size else (centre_m - half, centre_m + half)
