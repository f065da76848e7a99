"""How often `permway check` states what is there, and what is not: python tests/checking/rates.py FOLDER [COUNT].

Small campaigns of a fresh seed, as `permway challenge make --tier small` makes them, as they are, and every
second with each blunder put into its first record. Writes `docs/check.json`; two minutes of one processor.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.load import Dataset, load_record
from permway.campaign.predict import predict
from permway.challenge.small.make import make_small
from permway.checking.change import Change
from permway.checking.check import check, common
from permway.checking.compared import compared
from permway.checking.search import Reported, reported
from permway.files import write_text
from permway.recordings.channel import Sensor

SEED, COUNT, EVERY = 8803, 100, 2
"""Blunders are put into every second campaign."""

RESULT = Path(__file__).parents[2] / "docs" / "check.json"
GRAVITY = 9.80665

Right = Callable[[Change], bool]
Case = tuple[str, Complexes, list[Sensor], Right]


def cases(
    random: np.random.Generator, frf: Complexes, frequency_Hz: Reals, sensors: list[Sensor]
) -> Iterator[Case]:
    """Blunders of responses (sensors, points, F): name, what is read, sensors as stated, what is right."""
    omega = 2j * np.pi * frequency_Hz
    count, points = frf.shape[:2]

    def whole(size: float, order: int = 0) -> Right:
        return lambda one: one.whole and _is(one, size, order)

    def single(size: float, order: int = 0) -> Right:
        return lambda one: set(one.ratios) == {turned} and _is(one, size, order)

    in_g = [sensor.model_copy(update={"unit": "g"}) for sensor in sensors]
    yield "g stated, m/s2 written", frf * GRAVITY, in_g, whole(1.0 / GRAVITY)
    yield "m/s2 stated, g written", frf / GRAVITY, sensors, whole(GRAVITY)
    for name, factor in (("1000", 1e3), ("25.4", 25.4), ("1e6", 1e6), ("2 pi", 2.0 * np.pi)):
        yield f"factor of {name}", frf * factor, sensors, whole(1.0 / factor)
    yield "velocity for acceleration", frf / omega, sensors, whole(1.0, 1)
    yield "displacement for acceleration", frf / omega**2, sensors, whole(1.0, 2)
    yield "sign of all", -frf, sensors, lambda one: one.kind == "sign" and one.whole
    yield "phases reversed", frf.conj(), sensors, lambda one: one.kind == "conjugate"
    phase = np.exp(1j * np.angle(frf))
    levels = np.maximum(20.0 * np.log10(np.abs(frf) / 1e-9), 1e-3)
    yield "decibels as sizes", levels * phase, sensors, lambda one: one.reference == 1e-9
    narrow = np.abs(frf) * np.exp(1j * np.angle(frf) * np.pi / 180.0)
    yield "radians as degrees", narrow, sensors, lambda one: one.kind == "angle"
    if count > 1:
        turned, *others = (int(i) for i in random.permutation(count)[:2])
        mine = np.arange(count)[:, None, None] == turned
        yield "one sensor in g", np.where(mine, frf / GRAVITY, frf), sensors, single(GRAVITY)
        yield "one sensor's sign", np.where(mine, -frf, frf), sensors, single(-1.0)
        yield "one sensor's velocity", np.where(mine, frf / omega, frf), sensors, single(1.0, 1)
        order = _exchanged(count, turned, others[0])
        yield "two sensors exchanged", frf[order], sensors, _swap(turned, others[0])
    if points > 1:
        one, other = (int(i) for i in random.permutation(points)[:2])
        yield (
            "two points exchanged",
            frf[:, _exchanged(points, one, other)],
            sensors,
            _swap(count + one, count + other),
        )


def _is(one: Change, size: float, order: int) -> bool:
    ratio = next(iter(one.ratios.values()), None)
    return ratio is not None and ratio.order == order and bool(np.isclose(ratio.size, size, rtol=1e-3))


def _swap(one: int, other: int) -> Right:
    return lambda change: change.swapped is not None and set(change.swapped) == {one, other}


def _exchanged(count: int, one: int, other: int) -> list[int]:
    order = list(range(count))
    order[one], order[other] = other, one
    return order


def measure(folder: Path, count: int) -> dict[str, Any]:
    """Rates over the campaigns of a seed."""
    false, sensors_turned, turned_reported = 0, 0, 0
    rates: dict[str, list[int]] = {}
    for index in range(count):
        name = make_small(SEED, index, folder)
        truth = json.loads((folder / "truth" / f"{name}.json").read_text("utf-8"))
        turned = [e["place"]["channels"][0] for e in truth["effects"] if e["id"] == "sensor_polarity"]
        campaign = read_campaign(folder / name / "campaign.toml")
        # A turned sensor among one, or among all, is the sign of the record.
        found = check(campaign, threads=1).found
        right = [one for one in found if one.kind == "sign" and any(f'"{s}"' in one.remedy for s in turned)]
        false += bool(len(found) > len(right))
        sensors_turned, turned_reported = sensors_turned + bool(turned), turned_reported + bool(right)
        if index % EVERY:
            continue
        for case, reported_right, reported_wrong in _injected(
            campaign, np.random.default_rng(index), bool(turned)
        ):
            row = rates.setdefault(case, [0, 0, 0])
            row[0], row[1], row[2] = row[0] + reported_right, row[1] + reported_wrong, row[2] + 1
        print(index, false, flush=True)
    return {
        "seed": SEED,
        "campaigns": count,
        "false_alarms": false,
        "turned": [turned_reported, sensors_turned],
        "blunders": [{"blunder": k, "reported": v[0], "wrong": v[1], "of": v[2]} for k, v in rates.items()],
    }


def _injected(campaign: Campaign, random: np.random.Generator, faulty: bool) -> Iterator[tuple[str, bool, bool]]:
    """By blunder of the first record: whether it is reported, and whether something else is, instead."""
    record = campaign.stated.records[0]
    dataset = load_record(campaign, record)
    (predicted,) = predict(campaign, [dataset], threads=1)
    sensors = [campaign.sensor(name) for name in dataset.names("sensor")]
    forces = [campaign.point(name).unit for name in dataset.names("force")]
    for name, read, stated, right in cases(random, dataset.data["frf"].values, dataset.frequency_Hz, sensors):
        found = _reported(campaign, dataset, predicted, read, stated, forces)
        hit = any(right(one.change) for one in found)
        yield name, hit, bool(found) and not hit and not faulty


def _reported(
    campaign: Campaign,
    dataset: Dataset,
    predicted: xr.Dataset,
    read: Complexes,
    stated: list[Sensor],
    forces: list[str],
) -> list[Reported]:
    data = dataset.data.copy()
    data["frf"] = (data["frf"].dims, read)
    given = compared(replace(dataset, data=data), predicted, common(campaign, dataset))
    return reported(given, stated, forces)[0]


if __name__ == "__main__":
    wanted = int(sys.argv[2]) if len(sys.argv) > 2 else COUNT
    write_text(RESULT, json.dumps(measure(Path(sys.argv[1]), wanted), indent=1) + "\n")
