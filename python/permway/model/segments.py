"""Bodies one by one, as the core takes them, and which of them is at a place."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.model.bodies import AnyBody, Mass
from permway.model.faults import fault
from permway.model.stations import TOUCH_M, Ends, groups, shared

Integers = np.ndarray[tuple[int], np.dtype[np.int64]]

MASS_REACH_M = 1e-6
"""A place so near to a mass of a row is the mass's."""


@dataclass(frozen=True)
class Segment:
    """One beam or mass of the core: a body's name, or "girder[2]" for the second of a row.

    A mass of a row starts and stops where it stands; one that its joints place reaches from -inf to inf.
    """

    name: str
    body: str
    start: float
    stop: float


def segments_of(bodies: Mapping[str, AnyBody]) -> list[Segment]:
    """Beams and shafts one by one, then masses."""
    return list(_segments(tuple(bodies.items())))


# A solve asks several times, and a diagnosis solves the same bodies thousands of times.
@lru_cache(maxsize=32)
def _segments(named: tuple[tuple[str, AnyBody], ...]) -> tuple[Segment, ...]:
    bodies = dict(named)
    beams: list[Segment] = []
    masses: list[Segment] = []
    for name, body in bodies.items():
        if not isinstance(body, Mass):
            intervals = body.intervals_m or ((-np.inf, np.inf),)
            beams += [Segment(_label(name, i, len(intervals)), name, *reach) for i, reach in enumerate(intervals)]
        elif body.at is None:
            masses.append(Segment(name, name, -np.inf, np.inf))
        else:
            places = mass_places(bodies, name).tolist()
            masses += [Segment(_label(name, i, len(places)), name, x, x) for i, x in enumerate(places)]
    return (*beams, *masses)


def _label(name: str, index: int, count: int) -> str:
    return name if count == 1 else f"{name}[{index + 1}]"


def mass_places(bodies: Mapping[str, AnyBody], name: str) -> Reals:
    """Where the masses of a checked row stand, ascending, m."""
    body = bodies[name]
    if not isinstance(body, Mass) or body.at is None:
        return np.zeros(0)
    if isinstance(body.at, Ends):
        return shared(end_places(bodies, body.at), body.at.within_m)
    return np.sort(np.concatenate(groups(body.at)))


def end_places(bodies: Mapping[str, AnyBody], ends: Ends) -> Reals:
    """Both ends of every beam of a row, inset, beam by beam; or every mass, m."""
    body = bodies[ends.of]
    if isinstance(body, Mass):
        return mass_places(bodies, ends.of)
    reaches = [(start + ends.inset_m, stop - ends.inset_m) for start, stop in body.intervals_m or ()]
    return np.array(reaches, dtype=np.float64).reshape(-1)


def check_rows(bodies: Mapping[str, AnyBody]) -> None:
    """Refuse rows of masses that stand nowhere, twice at one place, or at the places of each other."""
    for name, body in bodies.items():
        if not isinstance(body, Mass) or body.at is None:
            continue
        followed, at = [name], body.at
        while isinstance(at, Ends):
            check_ends(bodies, at, "bodies", followed[-1], "at")
            if at.of in followed:
                raise fault(f"{at.of} stands where it stands itself", "bodies", name, "at", "of")
            followed.append(at.of)
            at = getattr(bodies[at.of], "at", ())
        places = mass_places(bodies, name)
        near = np.flatnonzero(np.diff(places) < 2.0 * MASS_REACH_M)
        if near.size:
            what = f"two masses of the row stand at {places[near[0]]:g} m: name each place once"
            raise fault(what, "bodies", name, "at")


def check_ends(bodies: Mapping[str, AnyBody], ends: Ends, *place: str | int) -> None:
    """Refuse the ends of what is not there or has none."""
    if ends.of not in bodies:
        raise fault(f"there is no body {ends.of!r}; there are {sorted(bodies)}", *place, "of")
    body = bodies[ends.of]
    if isinstance(body, Mass):
        if body.at is None:
            raise fault(f"{ends.of} has no ends, and no places of its own: give it at", *place, "of")
        if ends.inset_m > 0.0:
            raise fault(f"{ends.of} is a row of masses, which has no inside", *place, "inset_m")
        return
    if body.intervals_m is None:
        raise fault(f"{ends.of} has no ends: give it intervals_m", *place, "of")
    shortest = min(stop - start for start, stop in body.intervals_m)
    if not ends.inset_m < 0.5 * shortest:
        what = f"does not lie in from the ends of {ends.of}, which is {shortest:g} m long"
        raise fault(what, *place, "inset_m", value=ends.inset_m)


def find(segments: Sequence[Segment], body: str, x_m: Reals, where: Callable[[int], str]) -> Integers:
    """Index of the segment of a body at each of the places.

    Raises
    ------
    InputError
        If there is no such body, if a place lies off it, or if two beams of a row meet there.
    """
    numbers = _named(segments, body, where)
    named = np.array(numbers, dtype=np.int64)
    bad = np.flatnonzero(~np.isfinite(x_m))
    if bad.size:
        raise InputError(
            "the place must be finite", where=where(int(bad[0])), value=float(x_m[bad[0]]), remedy="give x in m"
        )
    starts, stops = (np.array([getattr(segments[i], end) for i in numbers]) for end in ("start", "stop"))
    reach = MASS_REACH_M if starts[0] == stops[0] else TOUCH_M
    # A row stands from left to right, so at most two of it reach a place.
    last = np.searchsorted(starts - reach, x_m, side="right") - 1
    bad = np.flatnonzero((last < 0) | (x_m > stops[last] + reach))
    if bad.size:
        raise InputError(
            f"off the {body}, which {_extent(starts, stops)}",
            where=where(int(bad[0])),
            value=float(x_m[bad[0]]),
            remedy="move it onto the body; x is in metres",
        )
    bad = np.flatnonzero((last > 0) & (x_m <= stops[last - 1] + reach))
    if bad.size:
        second = int(last[bad[0]])
        names = [segments[i].name for i in numbers[second - 1 : second + 1]]
        raise InputError(
            f"two beams meet there: {names}",
            where=where(int(bad[0])),
            value=float(x_m[bad[0]]),
            remedy="name the one that is meant",
        )
    return named[last]


def nearest_mass(
    segments: Sequence[Segment], body: str, x_m: Reals, within_m: float, where: Callable[[int], str]
) -> Integers:
    """Index of the nearest mass of a row to each of the places.

    Raises
    ------
    InputError
        If there is none within reach, or if two are equally near.
    """
    numbers = _named(segments, body, where)
    stand = np.array([segments[i].start for i in numbers])
    away = np.abs(x_m[:, None] - stand[None, :])
    chosen = np.argmin(away, axis=1)
    least = away.min(axis=1)
    bad = np.flatnonzero(least > max(within_m, MASS_REACH_M) + TOUCH_M)
    if bad.size:
        near = stand[chosen[bad[0]]]
        raise InputError(
            f"no {body} stands within {within_m:g} m; the nearest stands at {near:g} m",
            where=where(int(bad[0])),
            value=float(x_m[bad[0]]),
            remedy="widen within_m, or place the masses there",
        )
    bad = np.flatnonzero((away < least[:, None] + MASS_REACH_M).sum(axis=1) > 1)
    if bad.size:
        raise InputError(
            f"two of {body} are equally near",
            where=where(int(bad[0])),
            value=float(x_m[bad[0]]),
            remedy="place one of them nearer",
        )
    return np.asarray(np.array(numbers, dtype=np.int64)[chosen], dtype=np.int64)


def is_placed(segment: Segment) -> bool:
    """Whether it is a mass of a row, which stands at a place of its own."""
    return segment.start == segment.stop


def _named(segments: Sequence[Segment], body: str, where: Callable[[int], str]) -> list[int]:
    named = [i for i, s in enumerate(segments) if body in (s.name, s.body)]
    if not named:
        names = list(dict.fromkeys(s.body for s in segments))
        row = f'; of a row, "{names[0]}[2]" is the second' if "[" in body else ""
        raise InputError("there is no such body", where=where(0), value=body, remedy=f"use one of {names}{row}")
    return named


def _extent(starts: Reals, stops: Reals) -> str:
    more = ", ..." if starts.size > 4 else ""
    if starts[0] == stops[0]:
        return "stands at " + ", ".join(f"{x:g}" for x in starts[:4]) + f" m{more}"
    return "runs " + ", ".join(f"{a:g} to {b:g} m" for a, b in zip(starts[:4], stops[:4], strict=True)) + more
