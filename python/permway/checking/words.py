"""A change in words, with what to write in the campaign file."""

from __future__ import annotations

import math
from collections.abc import Sequence

from permway.checking.blunder import Blunder
from permway.checking.change import Change, Ratio
from permway.checking.compared import Compared
from permway.checking.offered import other_units, same
from permway.checking.search import Reported
from permway.recordings.channel import Point, Sensor

NAMES = {9.80665: "9.80665", 25.4: "25.4", 1e3: "1000", 1e6: "1e6", 2.0 * math.pi: "2 pi"}


def blunder_of(
    one: Reported, record: str, given: Compared, sensors: Sequence[Sensor], points: Sequence[Point]
) -> Blunder:
    """What a change states about a record.

    Parameters
    ----------
    one : Reported
    record : str
    given : Compared
    sensors, points : sequence of Sensor, of Point
        Of its channels and points, in their order.
    """
    change = one.change
    names = [*given.channels, *given.points]
    members = list(change.ratios) + list(change.swapped or ())
    concerned = "" if change.whole or not members else ": " + ", ".join(names[m] for m in members)
    what, remedy = _stated(change, names, sensors, points)
    for rival in one.rivals:
        other, instead = _stated(rival, names, sensors, points)
        what, remedy = f"{what} (or {other})", f"{remedy} (or {instead})"
    return Blunder(change.kind, f"records.{record}{concerned}", what, remedy, one.log_odds)


def _stated(
    change: Change, names: Sequence[str], sensors: Sequence[Sensor], points: Sequence[Point]
) -> tuple[str, str]:
    match change.kind:
        case "conjugate":
            return "phases run backwards, as of exp(-i omega t)", "conjugate the responses in the file"
        case "decibels":
            what = f"sizes are levels in dB over {change.reference:g}"
            return what, "export real and imaginary part, or sizes in a plain unit"
        case "angle":
            return "phases are radians, read as degrees", 'in the record: unit = { phase = "rad" }'
        case "labels":
            assert change.swapped is not None
            one, other = (names[member] for member in change.swapped)
            key = "responses or channels" if change.swapped[0] < len(sensors) else "references"
            what = f"{one!r} and {other!r} have changed places"
            return what, f"exchange them in {key} of the record"
    first, ratio = next(iter(change.ratios.items()))
    if change.kind == "sign":
        return _sign(change, first, sensors, points)
    if first >= len(sensors):
        point = points[first - len(sensors)]
        other = "kN" if point.unit == "N" else "N"
        what = f"its force is {_times(1.0 / ratio.size)} what it should be"
        return what, f'forces "{point.name}": unit = "{other}", not "{point.unit}"'
    mine = [sensors[member] for member in change.ratios]
    return _unit(ratio, mine, points if change.whole else ())


def _sign(change: Change, first: int, sensors: Sequence[Sensor], points: Sequence[Point]) -> tuple[str, str]:
    if first >= len(sensors):
        point = points[first - len(sensors)]
        turned = "down" if point.direction == "up" else "up"
        return "has the opposite sign", f'forces "{point.name}": direction = "{turned}"'
    mine = [sensors[member] for member in change.ratios]
    turned = "down" if mine[0].direction == "up" else "up"
    listed = ", ".join(f'"{sensor.name}"' for sensor in mine)
    remedy = f'sensors {listed}: direction = "{turned}"'
    if change.whole and points:
        remedy += ", or of all hammer points instead"
    return "has the opposite sign" if not change.whole else "all responses have the opposite sign", remedy


def _unit(ratio: Ratio, mine: Sequence[Sensor], points: Sequence[Point]) -> tuple[str, str]:
    """What a factor on channels means; `ratio` puts right what was read."""
    sensor = mine[0]
    listed = ", ".join(f'"{one.name}"' for one in mine)
    remedies = [
        f'sensors {listed}: quantity = "{quantity}", unit = "{unit}", not "{sensor.unit}"'
        if quantity != sensor.quantity
        else f'sensors {listed}: unit = "{unit}", not "{sensor.unit}"'
        for quantity, unit, found in other_units(sensor)
        if same(found, ratio) and unit != "m/s^2"
    ]
    if points and same(ratio, Ratio(1e-3 if points[0].unit == "N" else 1e3)):
        remedies.append(f'all forces: unit = "{"kN" if points[0].unit == "N" else "N"}", not "{points[0].unit}"')
    if ratio.order == 0:
        what = f"levels are {_times(1.0 / ratio.size)} what the model states ({_decibels(1.0 / ratio.size)})"
        if not remedies:
            remedies = [
                f"sensors {listed}: chain = {{ gain = {1.0 / ratio.size:.6g} }}, or bring the file to the unit"
            ]
    else:
        power = f"(2 pi f)^{-ratio.order}" if ratio.order != -1 else "2 pi f"
        size = "" if abs(ratio.size - 1.0) < 1e-9 else f" times {1.0 / ratio.size:.6g}"
        what = f"levels are {power}{size} times what the model states, and a quarter turn of phase for each 2 pi f"
        if not remedies:
            remedies = [f"see what sensors {listed} read: displacement, velocity or acceleration"]
    return what, "; or ".join(remedies)


def _times(size: float) -> str:
    for factor, name in NAMES.items():
        if math.isclose(size, factor, rel_tol=1e-3):
            return f"{name} times"
        if math.isclose(size, 1.0 / factor, rel_tol=1e-3):
            return f"1/{name} of"
    return f"{size:.6g} times"


def _decibels(size: float) -> str:
    return f"{20.0 * math.log10(abs(size)):+.1f} dB"
