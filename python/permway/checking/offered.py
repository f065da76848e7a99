"""Which changes are tried of a record: other units and quantities, odd factors, signs, phases, labels."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np

from permway.checking.blunder import Kind
from permway.checking.change import Change, Ratio
from permway.checking.compared import Compared
from permway.recordings.channel import DERIVATIVES, UNITS, Sensor

WHOLE, SINGLE = -4.0, -6.0
"""Log prior of a change of a whole record and of one channel or point. One more or less of it moves the least odds
that are determined by as much."""

ODD = -4.0
"""Log prior of a factor that no unit explains over one that a unit does."""

FACTORS = (9.80665, 25.4, 1e3, 1e6, 2.0 * math.pi)
"""Factors that are met where no unit of the sensor explains them: standard gravity, inches for millimetres, kilo
or milli, mega or micro, rad/s for Hz."""

SAME = 1e-3
"""Relative difference of factors that are one."""

REFERENCES = (1.0, 1e-3, 1e-5, 1e-6, 1e-9, 1e-12)
"""References of decibels."""

LEVELS = (3.0, 400.0)
"""Median of sizes that may be decibels."""

NARROW_RAD = math.pi * math.pi / 180.0 * 1.001
"""Largest phase that may be radians taken for degrees: pi degrees."""


def offered(given: Compared, sensors: Sequence[Sensor], forces: Sequence[str]) -> Iterator[Change]:
    """All changes that are tried, one at a time.

    Parameters
    ----------
    given : Compared
    sensors : sequence of Sensor
        Of its channels, in their order.
    forces : sequence of str
        Units of its points, in their order.
    """
    channels = list(range(len(given.channels)))
    points = list(range(len(channels), len(channels) + len(given.points)))
    yield from _ratios(channels, sensors, forces, whole=True)
    if given.phased.any():
        if given.points or len(channels) == 1:
            yield Change("sign", WHOLE, {member: Ratio(-1.0) for member in channels}, whole=True)
        yield Change("conjugate", WHOLE, conjugate=True)
    # A cross spectrum is not read as two columns.
    apart = given.phased.any() and (bool(given.points) or bool((given.second < 0).all()))
    if apart:
        yield Change("exchanged", WHOLE, exchanged=tuple(channels), whole=True)
    yield from _readings(given)
    if len(channels) > 1:
        for member in channels:
            yield from _ratios([member], [sensors[member]], [], whole=False)
            if given.phased.any():
                yield Change("sign", SINGLE, {member: Ratio(-1.0)})
            if apart:
                yield Change("exchanged", SINGLE, exchanged=(member,))
        yield from _swaps(channels)
    if len(points) > 1:
        for member in points:
            for size in (1e3, 1e-3):
                yield Change("factor", SINGLE - math.log(2.0), {member: Ratio(size)})
            yield Change("sign", SINGLE, {member: Ratio(-1.0)})
        yield from _swaps(points)


def _swaps(members: list[int]) -> Iterator[Change]:
    pairs = list(combinations(members, 2))
    for pair in pairs:
        yield Change("labels", SINGLE - math.log(len(pairs)), swapped=pair)


def _ratios(
    members: list[int], sensors: Sequence[Sensor], forces: Sequence[str], *, whole: bool
) -> Iterator[Change]:
    """One factor on all of some channels: each unit that they may have instead, and each odd factor."""
    prior = WHOLE if whole else SINGLE
    one = sensors[0]
    found: list[tuple[Ratio, float]] = []
    alike = all((s.quantity, s.unit) == (one.quantity, one.unit) for s in sensors)
    units = [ratio for _, _, ratio in other_units(one)] if alike and one.quantity in DERIVATIVES else []
    # Of forces in kN that were stated to be in N, or the other way round.
    units += [ratio for force in dict.fromkeys(forces) for _, ratio in other_forces(force)]
    odd = [Ratio(size) for factor in FACTORS for size in (factor, 1.0 / factor)]
    odd += [Ratio(1.0, order) for order in (-2, -1, 1, 2)]
    for ratio, shift in [*((ratio, 0.0) for ratio in units), *((ratio, ODD) for ratio in odd)]:
        if not any(same(ratio, known) for known, _ in found) and not same(ratio, Ratio()):
            found.append((ratio, shift))
    for ratio, shift in found:
        kind: Kind = "factor" if ratio.order == 0 else "quantity"
        log_prior = prior + shift - math.log(len(found))
        yield Change(kind, log_prior, dict.fromkeys(members, ratio), whole=whole)


def other_units(sensor: Sensor) -> Iterator[tuple[str, str, Ratio]]:
    """Quantities and units that a sensor may have instead, and the factor that each would mean."""
    for quantity, order in DERIVATIVES.items():
        for unit, size in UNITS[quantity].items():
            ratio = Ratio(size / sensor.to_SI, DERIVATIVES[sensor.quantity] - order)
            if not same(ratio, Ratio()):
                yield quantity, unit, ratio


def other_forces(unit: str) -> Iterator[tuple[str, Ratio]]:
    """Units that a force may have instead, and the factor on responses that each would mean.

    Pounds are written by files that state them, and are no slip of who writes a campaign.
    """
    for other, size in UNITS["force"].items():
        if other not in (unit, "lbf"):
            yield other, Ratio(UNITS["force"][unit] / size)


def same(one: Ratio, other: Ratio) -> bool:
    """Whether two factors are one."""
    return one.order == other.order and abs(one.size / other.size - 1.0) < SAME


def _readings(given: Compared) -> Iterator[Change]:
    if not given.used.any():
        return
    sizes, phases = np.abs(given.measured[given.used]), np.angle(given.measured[given.used])
    if given.points and LEVELS[0] < float(np.median(sizes)) < LEVELS[1] and float(sizes.max()) < LEVELS[1]:
        for reference in REFERENCES:
            yield Change("decibels", WHOLE - math.log(len(REFERENCES)), reading="decibels", reference=reference)
    turning = np.angle(given.predicted[given.used])
    if float(np.abs(phases).max()) <= NARROW_RAD < float(np.abs(turning).max()) and np.ptp(phases) > 0.0:
        yield Change("angle", WHOLE, reading="radians")
