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

MANY = 3
"""Sensors, or points, at one and the same place from which it is asked back. At half of it two accelerometers side
by side are asked of, at twice of it a campaign of five whose places were never answered is passed."""


def tolerances(campaign: Campaign) -> Iterator[Blunder]:
    """Relative tolerances of more than the number itself, and none at all."""
    if not campaign.stated.parameters:
        what = "no parameter has a tolerance: each value of the model counts as exact, and its error as an effect"
        remedy = "state [[parameters]] with tolerance_2sigma for what is not known exactly"
        yield Blunder("tolerance", "parameters", what, remedy, asked=True)
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


def same_places(campaign: Campaign) -> Iterator[Blunder]:
    """Sensors that read the same at one place, and points struck at one: places may not have been answered."""
    sensors = [
        (one.name, (one.body, one.x_m, one.direction, one.quantity)) for one in campaign.stated.sensors if one.body
    ]
    points = [(one.name, (one.body, one.x_m, one.direction)) for one in campaign.stated.forces]
    for key, words, named in (("sensors", "sensors", sensors), ("forces", "points", points)):
        groups: dict[tuple[object, ...], list[str]] = {}
        for name, place in named:
            groups.setdefault(place, []).append(name)
        for (body, x, *_), names in groups.items():
            # `permway new` proposes 0 where no label holds a place: all of two there were not answered.
            if len(names) < MANY and not (x == 0.0 and 1 < len(names) == len(named)):
                continue
            what = f"{len(names)} {words} at x = {x:g} m of {body}: is that so?"
            yield Blunder("place", f"{key}: {', '.join(names)}", what, "see where each stands: x_m", asked=True)
