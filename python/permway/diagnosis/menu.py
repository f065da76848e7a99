"""Measurements that could come next: sensors, blows, repeats, speeds, temperatures, each with what it costs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import xarray as xr

from permway.campaign.campaign import Campaign
from permway.campaign.load import Dataset
from permway.diagnosis.location import step_m, stretches
from permway.errors import InputError
from permway.recordings.channel import Point, Sensor

Kind = Literal["repeat", "sensor", "blows", "speed", "temperature"]

COST: dict[Kind, float] = {"repeat": 1.0, "sensor": 1.0, "blows": 1.0, "speed": 4.0, "temperature": 8.0}
"""Of a measurement, in units of an hour on the track."""

FASTER, COLDER_K, REPEATS = 1.3, 25.0, 4.0
SHARES = (0.25, 0.5, 0.9)
"""Where along a beam a sensor may stand."""


@dataclass(frozen=True)
class Item:
    """A measurement that could be made.

    Attributes
    ----------
    words : str
    kind : str
        Its key in :data:`COST`.
    cost : float
        See :data:`COST`.
    planned : callable
        From a campaign to one that has the sensors and conditions of the measurement.
    dataset : Dataset
        Its coordinates, averages and scatter; its values mean nothing.
    """

    words: str
    kind: Kind
    cost: float
    planned: Callable[[Campaign], Campaign]
    dataset: Dataset
    body: str = ""
    """On which a sensor stands, or which is struck."""
    value: float = float("nan")
    """Where, m; or how many times the blows, the temperature, degC, or the speed, m/s."""


def menu(campaign: Campaign, datasets: list[Dataset]) -> Iterator[Item]:
    """What could be measured beside what was.

    Parameters
    ----------
    campaign : Campaign
    datasets : list of Dataset
        What was measured.
    """
    hammer = next((d for d in datasets if d.record.statistic == "frf"), None)
    if hammer is not None:
        yield from _sensors(campaign, hammer)
        yield from _blows(campaign, hammer)
        words = f"{hammer.record.name} again, {REPEATS:.0f} times the blows"
        yield Item(words, "repeat", COST["repeat"] * REPEATS, lambda c: c, _quieter(hammer), value=REPEATS)
        temperature = hammer.condition.temperature_C
        if temperature is not None:
            yield _other_condition(
                hammer,
                f"the hammer test at {temperature - COLDER_K:g} degC",
                "temperature",
                temperature_C=temperature - COLDER_K,
            )
    train = next((d for d in datasets if d.condition.kind == "train"), None)
    if train is not None and train.condition.speed_m_per_s is not None:
        speed = FASTER * train.condition.speed_m_per_s
        yield _other_condition(train, f"a run at {3.6 * speed:.0f} km/h", "speed", speed_m_per_s=speed)
    passage = next((d for d in datasets if d.record.statistic == "passage"), None)
    if passage is not None:
        yield from _of_passage(campaign, passage)
    table = next((d for d in datasets if d.record.statistic == "modes"), None)
    if table is not None:
        yield from _of_modes(table)


def item_of(campaign: Campaign, datasets: list[Dataset], words: str) -> Item:
    """The measurement that a verdict advises in these words.

    Raises
    ------
    InputError
        If the menu has no such one.
    """
    items = {item.words: item for item in menu(campaign, datasets)}
    if words not in items:
        remedy = f"use one of {', '.join(items)}"
        raise InputError("is no measurement that could come next", where="words", value=words, remedy=remedy)
    return items[words]


def _sensors(campaign: Campaign, hammer: Dataset) -> Iterator[Item]:
    standing = [campaign.sensor(str(s)) for s in hammer.data["sensor"].values]
    for body, x in _free_places(campaign, standing):
        sensor = standing[0].model_copy(update={"name": f"planned {body}@{x:g}", "body": body, "x_m": x})
        data = hammer.data.isel(sensor=[0]).assign_coords(sensor=[sensor.name])
        yield Item(
            f"a sensor on {body} at {x:g} m in the hammer test",
            "sensor",
            COST["sensor"],
            _with_sensor(sensor),
            replace(hammer, data=_typical(data, hammer.data)),
            body,
            x,
        )


def _free_places(campaign: Campaign, standing: Sequence[Sensor]) -> Iterator[tuple[str, float]]:
    """Where along the beams no such sensor stands yet."""
    for segment, low, high in stretches(campaign.model.line):
        for share in SHARES:
            x = float(np.round(low + share * (high - low), 2))
            if not any(
                s.body == segment.name and abs(float(s.x_m or 0.0) - x) < step_m(high - low) for s in standing
            ):
                yield segment.name, x


def _of_passage(campaign: Campaign, passage: Dataset) -> Iterator[Item]:
    """The same train at another speed, once more, and past one sensor more of each quantity."""
    name, speed = passage.record.name, passage.condition.speed_m_per_s
    assert speed is not None
    faster = FASTER * speed
    yield _other_condition(passage, f"a passage at {3.6 * faster:.0f} km/h", "speed", speed_m_per_s=faster)
    yield Item(f"{name} again", "repeat", COST["repeat"], lambda c: c, passage)
    channels = [str(c) for c in passage.data["channel"].values]
    of_quantity: dict[str, list[Sensor]] = {}
    for sensor in map(campaign.sensor, channels):
        of_quantity.setdefault(sensor.quantity, []).append(sensor)
    for quantity, standing in of_quantity.items():
        first = standing[0]
        words = quantity.replace("_", " ")
        for body, x in _free_places(campaign, standing):
            # How far below the axis a strain is read is of its own beam.
            if first.bends and body != first.body:
                continue
            planned = f"planned {words} {body}@{x:g}"
            sensor = first.model_copy(update={"name": planned, "body": body, "x_m": x})
            data = passage.data.isel(channel=[channels.index(first.name)]).assign_coords(channel=[planned])
            yield Item(
                f"a sensor of {words} on {body} at {x:g} m while the train passes",
                "sensor",
                COST["sensor"],
                _with_sensor(sensor),
                replace(passage, data=data),
                body,
                x,
            )


def _of_modes(table: Dataset) -> Iterator[Item]:
    """A longer recording, whose modes scatter less; the same at another temperature."""
    data = table.data.copy()
    data["relative_sd"] = data["relative_sd"] / np.sqrt(REPEATS)
    words = f"{table.record.name} again, from {REPEATS:.0f} times as long a recording"
    yield Item(words, "repeat", COST["repeat"] * REPEATS, lambda c: c, replace(table, data=data), value=REPEATS)
    temperature = table.condition.temperature_C
    if temperature is not None:
        colder = temperature - COLDER_K
        words = f"{table.record.name} again, at {colder:g} degC"
        yield _other_condition(table, words, "temperature", temperature_C=colder)


def _blows(campaign: Campaign, hammer: Dataset) -> Iterator[Item]:
    struck = [campaign.point(str(p)) for p in hammer.data["force"].values]
    for segment, low, high in stretches(campaign.model.line):
        body, x = segment.name, float(np.round(low + 0.4 * (high - low), 2))
        if any(p.body == body and abs(p.x_m - x) < step_m(high - low) for p in struck):
            continue
        point = struck[0].model_copy(update={"name": f"planned {body}@{x:g}", "body": body, "x_m": x})
        data = hammer.data.isel(force=[0]).assign_coords(force=[point.name])
        yield Item(
            f"blows on {body} at {x:g} m",
            "blows",
            COST["blows"],
            _with_point(point),
            replace(hammer, data=_typical(data, hammer.data)),
            body,
            x,
        )


def _typical(data: xr.Dataset, of: xr.Dataset) -> xr.Dataset:
    """Scatter by frequency as it is in the middle of what was measured."""
    middle = of["log_variance"].median(("sensor", "force"))
    found = data.copy()
    found["log_variance"] = middle.broadcast_like(data["log_variance"]).transpose(*data["log_variance"].dims)
    found["frf"] = xr.ones_like(data["frf"])
    return found


def _quieter(hammer: Dataset) -> Dataset:
    data = hammer.data.copy()
    data["log_variance"] = data["log_variance"] / REPEATS
    data.attrs["averages"] = float(data.attrs.get("averages", 1.0)) * REPEATS
    return replace(hammer, data=data)


def _other_condition(dataset: Dataset, words: str, kind: Kind, **changed: float) -> Item:
    changes = {"name": f"planned {dataset.condition.name}", **changed}
    condition = dataset.condition.model_copy(update=changes)

    def planned(campaign: Campaign) -> Campaign:
        # Axle loads and times are parameters, and those of the same train.
        condition = campaign.condition(dataset.condition.name).model_copy(update=changes)
        stated = campaign.stated.model_copy(update={"conditions": (*campaign.stated.conditions, condition)})
        return replace(campaign, stated=stated)

    (value,) = changed.values()
    return Item(words, kind, COST[kind], planned, replace(dataset, condition=condition), value=value)


def _with_sensor(sensor: Sensor) -> Callable[[Campaign], Campaign]:
    def planned(campaign: Campaign) -> Campaign:
        stated = campaign.stated.model_copy(update={"sensors": (*campaign.stated.sensors, sensor)})
        return replace(campaign, stated=stated)

    return planned


def _with_point(point: Point) -> Callable[[Campaign], Campaign]:
    def planned(campaign: Campaign) -> Campaign:
        stated = campaign.stated.model_copy(update={"forces": (*campaign.stated.forces, point)})
        return replace(campaign, stated=stated)

    return planned
