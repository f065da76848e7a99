"""Numbers of a campaign file that are probably typing errors: tolerances in percent, places off the track."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from permway.campaign.campaign import Campaign
from permway.checking.blunder import Blunder

LARGEST = 1.0
"""Relative tolerance of two standard deviations from which it is asked back: 100 %. Half of it asks of what nobody
knows better, twice of it passes 1.5 %."""

FAR_M, FAR = 30.0, 5.0
"""Distance from all other places, m, and over what they span, from which a place is asked back. At half of it a
sensor in the next span is asked of; at twice 60 m is passed."""


def tolerances(campaign: Campaign) -> Iterator[Blunder]:
    """Relative tolerances of more than the number itself."""
    for parameter in campaign.stated.parameters:
        tolerance = parameter.tolerance_2sigma
        if tolerance is None or parameter.absolute or tolerance < LARGEST:
            continue
        what = f"tolerance_2sigma = {tolerance:g} is {100.0 * tolerance:g} % of the number"
        remedy = f"for {tolerance:g} % write tolerance_2sigma = {0.01 * tolerance:g}"
        yield Blunder("tolerance", f"parameters.{parameter.name}", what, remedy, asked=True)


def places(campaign: Campaign) -> Iterator[Blunder]:
    """Sensors and points that stand far from everything else on the line."""
    named = [("sensors", s.name, s.x_m) for s in campaign.stated.sensors if s.x_m is not None]
    named += [("forces", p.name, p.x_m) for p in campaign.stated.forces]
    places_m = np.array([x for *_, x in named])
    for index, (key, name, x) in enumerate(named):
        others = np.delete(places_m, index)
        if others.size < 2:
            continue
        span = float(np.ptp(others))
        away = float(np.min(np.abs(others - x)))
        if away < max(FAR_M, FAR * span):
            continue
        what = f"x_m = {x:g} is {away:.3g} m from every other sensor and point, which stand within {span:.3g} m"
        likely = [
            x / size for size in (10.0, 100.0, 1000.0) if others.min() - span <= x / size <= others.max() + span
        ]
        remedy = "is it " + " or ".join(f"{one:g}" for one in likely) + "?" if likely else "see where it stands"
        yield Blunder("place", f"{key}.{name}", what, remedy, asked=True)
