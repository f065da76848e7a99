"""A change in words, with what to write in the campaign file."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from permway.campaign.parts import Record
from permway.checking.blunder import Blunder
from permway.checking.change import Change, Ratio
from permway.checking.compared import Compared
from permway.checking.offered import other_forces, other_units, same
from permway.checking.search import Reported
from permway.recordings.channel import Point, Sensor

NAMES = {9.80665: "9.80665", 25.4: "25.4", 1e3: "1000", 1e6: "1e6", 2.0 * math.pi: "2 pi"}


@dataclass(frozen=True)
class Files:
    """A record, and the units that its file states of its sensors."""

    record: Record
    units: Mapping[str, str]

    def beside(self, mine: Sequence[Sensor], unit: str, forces: set[str], *, whole: bool) -> str | None:
        """What the record has to state, too, where the file states another unit; None if no record can state it.

        A record of responses states one unit of all its pairs, one of channels that of each.
        """
        if not any(sensor.name in self.units for sensor in mine):
            return ""
        was = self.units.get(mine[0].name)
        if self.record.statistic != "frf":
            labels = {name: label for label, name in self.record.channels.items()}
            # Of spectra the file states densities.
            stated = unit if self.record.sampled else f"({unit})^2/Hz"
            each = ", ".join(f'"{labels[sensor.name]}" = "{stated}"' for sensor in mine)
            return f", and in the record unit = {{ {each} }}, for the file states {was!r}"
        if not whole or len(forces) != 1:
            return None
        return f', and in the record unit = "({unit})/{next(iter(forces))}", for the file states {was!r}'


def blunder_of(
    one: Reported,
    record: Record,
    given: Compared,
    sensors: Sequence[Sensor],
    points: Sequence[Point],
    of_file: Mapping[str, str],
) -> Blunder:
    """What a change states about a record.

    Parameters
    ----------
    one : Reported
    record : Record
    given : Compared
    sensors, points : sequence of Sensor, of Point
        Of its channels and points, in their order.
    of_file : mapping of str to str
        As :func:`permway.checking.file_units.file_units` gives them: who corrects a sensor corrects these, too.
    """
    change = one.change
    names = [*given.channels, *given.points]
    members = [*change.ratios, *(change.swapped or ()), *change.exchanged]
    concerned = "" if change.whole or not members else ": " + ", ".join(names[m] for m in members)
    what, remedy = _stated(change, names, sensors, points, Files(record, of_file))
    for rival in one.rivals:
        other, instead = _stated(rival, names, sensors, points, Files(record, of_file))
        what, remedy = f"{what} (or {other})", f"{remedy} (or {instead})"
    return Blunder(change.kind, f"records.{record.name}{concerned}", what, remedy, one.log_odds)


def _stated(
    change: Change, names: Sequence[str], sensors: Sequence[Sensor], points: Sequence[Point], files: Files
) -> tuple[str, str]:
    match change.kind:
        case "exchanged":
            what = "real and imaginary part have changed places"
            if change.whole:
                return what, "exchange them in the file, or in the names of its columns"
            (member,) = change.exchanged
            return (
                f"{what} in {names[member]!r}",
                "exchange them in a copy of the file, or in the names of its columns",
            )
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
        what = f"its force is {_times(1.0 / ratio.size)} what it should be"
        return what, _force(ratio, point, files)
    mine = [sensors[member] for member in change.ratios]
    return _unit(ratio, mine, points, files, whole=change.whole)


def _force(ratio: Ratio, point: Point, files: Files) -> str:
    """What to write of one of several force points; `ratio` puts right what was read."""
    other = next((unit for unit, found in other_forces(point.unit) if same(found, ratio)), None)
    if other is None or files.units:
        return f'forces "{point.name}": chain = {{ gain = {ratio.size:.6g} }}, or correct it in the file'
    return f'forces "{point.name}": unit = "{other}", not "{point.unit}"'


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


def _unit(
    ratio: Ratio, mine: Sequence[Sensor], points: Sequence[Point], files: Files, *, whole: bool
) -> tuple[str, str]:
    """What a factor on channels means; `ratio` puts right what was read."""
    sensor = mine[0]
    listed = ", ".join(f'"{one.name}"' for one in mine)
    forces = {str(point.unit) for point in points}
    remedies = []
    for quantity, unit, found in other_units(sensor):
        beside = files.beside(mine, unit, forces, whole=whole)
        if same(found, ratio) and unit != "m/s^2" and beside is not None:
            stated = f'unit = "{unit}", not "{sensor.unit}"'
            stated = stated if quantity == sensor.quantity else f'quantity = "{quantity}", {stated}'
            remedies.append(f"sensors {listed}: {stated}{beside}")
    if whole and len(forces) == 1:
        for unit, found in other_forces(points[0].unit):
            beside = files.beside(mine, sensor.unit, {unit}, whole=True)
            if same(found, ratio) and beside is not None and len({one.unit for one in mine}) == 1:
                remedies.append(f'all forces: unit = "{unit}", not "{points[0].unit}"{beside}')
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
            if files.units:
                remedies[0] += (
                    f"; the file states {files.units.get(sensor.name, 'no unit')!r}, and is to be corrected"
                )
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
