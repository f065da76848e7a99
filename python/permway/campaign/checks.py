"""What the parts of a campaign file say of each other, and of the model."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from permway.campaign.excitation import check_excitation
from permway.campaign.factors import check_factors
from permway.campaign.parts import KIND_OF, Condition, HeldOut, Record
from permway.campaign.paths import parse_path, value_at
from permway.errors import InputError
from permway.laws.base import Law
from permway.model.place import Place
from permway.problem.model import Model
from permway.recordings.channel import Sensor
from permway.response.receptance import check_places

if TYPE_CHECKING:
    from permway.campaign.campaign import CampaignFile

SAME_SPEED = 1e-3
"""Speeds within a thousandth are the same."""


def check_campaign(stated: CampaignFile, model: Model) -> None:
    """Check names, places and kinds.

    Raises
    ------
    InputError
        With the place in the campaign file.
    """
    for key in ("sensors", "forces", "conditions", "records", "held_out"):
        _check_names(getattr(stated, key), key)
    for index, sensor in enumerate(stated.sensors):
        _check_sensor(sensor, model, f"sensors[{index}]")
    for index, point in enumerate(stated.forces):
        _check_place(model, point.body, point.x_m, f"forces[{index}]")
    for index, condition in enumerate(stated.conditions):
        _check_condition(condition, model, f"conditions[{index}]")
    check_factors(stated.conditions, model)
    for index, record in enumerate(stated.records):
        _check_record(record, stated, model, f"records[{index}]")
    if stated.irregularity.knowledge != "known" and model.irregularity is None:
        remedy = "name an irregularity in the model file"
        raise InputError("the model has no irregularity", where="irregularity.knowledge", remedy=remedy)
    check_excitation(stated.irregularity, stated.conditions, model)
    for index, group in enumerate(stated.held_out):
        _check_group(group, stated, f"held_out[{index}]")


def _check_names(items: Iterable[Any], key: str) -> None:
    seen: set[str] = set()
    for index, item in enumerate(items):
        if item.name in seen:
            where = f"{key}[{index}].name"
            raise InputError("the name stands twice", where=where, value=item.name, remedy="give each its own")
        seen.add(item.name)


def _check_sensor(sensor: Sensor, model: Model, where: str) -> None:
    if sensor.body is not None and sensor.x_m is not None:
        _check_place(model, sensor.body, sensor.x_m, where)
        return
    if model.train is None:
        remedy = "give the model file a [train]"
        raise InputError("the model has no train", where=f"{where}.degree", value=sensor.degree, remedy=remedy)
    degrees = model.train.vehicle.degrees
    if sensor.degree not in degrees:
        raise InputError(
            "the vehicle has no such degree of freedom",
            where=f"{where}.degree",
            value=sensor.degree,
            remedy=f"use one of {degrees[:10]}" + (", ..." if len(degrees) > 10 else ""),
        )


def _check_place(model: Model, body: str, x_m: float, where: str) -> None:
    # The name of the key at fault is that of the place: the body if there is none such, else x.
    try:
        check_places(model.line, [Place(body=body, x_m=x_m)], "places")
    except InputError as error:
        key = "body" if error.what.startswith("there is no such body") else "x_m"
        raise InputError(error.what, where=f"{where}.{key}", value=error.value, remedy=error.remedy) from error


def _check_condition(condition: Condition, model: Model, where: str) -> None:
    if model.line.needs_temperature and condition.temperature_C is None and model.temperature_C is None:
        needing = min(name for name, law in model.line.laws.items() if law.needs_temperature)
        what = f"missing: the law {needing!r} depends on it, and the model file gives none either"
        raise InputError(what, where=f"{where}.temperature_C")
    if condition.kind != "train":
        return
    if model.train is None:
        raise InputError("the model has no train", where=f"{where}.kind", remedy="give the model file a [train]")
    places = condition.wheels_m
    if places is not None and len(places) != len(model.train.vehicle.wheel_indices):
        what = f"there are {len(places)}, and the vehicle has {len(model.train.vehicle.wheel_indices)} wheelsets"
        raise InputError(what, where=f"{where}.wheels_m")
    if condition.centre_m is not None:
        places = tuple(condition.centre_m + model.train.vehicle.wheel_positions_m())
    for x in places or ():
        key = "wheels_m" if condition.wheels_m else "centre_m"
        try:
            check_places(model.line, [Place(body=model.train.body, x_m=float(x))], "wheels")
        except InputError as error:
            raise InputError(error.what, where=f"{where}.{key}", value=error.value, remedy=error.remedy) from error


def _check_record(record: Record, stated: CampaignFile, model: Model, where: str) -> None:
    conditions = {condition.name: condition for condition in stated.conditions}
    _known(record.condition, conditions, "condition", f"{where}.condition")
    kind = conditions[record.condition].kind
    if kind not in KIND_OF[record.statistic]:
        raise InputError(
            f'a record of "{record.statistic}" cannot be of a condition of kind "{kind}"',
            where=f"{where}.condition",
            value=record.condition,
            remedy=f"use a condition of kind {' or '.join(KIND_OF[record.statistic])}",
        )
    sensors = {sensor.name: sensor for sensor in stated.sensors}
    points = {point.name for point in stated.forces}
    for key, names in (("channels", sensors), ("responses", sensors), ("references", points)):
        for label, name in getattr(record, key).items():
            _known(name, names, "force point" if key == "references" else "sensor", f"{where}.{key}.{label}")
    for label, name in record.responses.items():
        if sensors[name].body is None:
            what = "an FRF is of the line, and this sensor is on the vehicle"
            raise InputError(what, where=f"{where}.responses.{label}", value=name)
    for label, name in record.channels.items():
        if sensors[name].body is None and record.statistic in ("modes", "passage"):
            what = f"a record of {record.statistic!r} is of the line, and this sensor is on the vehicle"
            raise InputError(what, where=f"{where}.channels.{label}", value=name)
    for key in ("channels", "responses"):
        for label, name in getattr(record, key).items():
            if sensors[name].bends and record.statistic != "passage":
                what = f'a sensor of {sensors[name].quantity} goes with statistic = "passage"'
                raise InputError(what, where=f"{where}.{key}.{label}", value=name)
            if sensors[name].quantity == "force" and record.statistic == "passage":
                raise InputError(
                    "a force is not predicted of a passage", where=f"{where}.{key}.{label}", value=name
                )
    if record.law is not None:
        try:
            law = value_at(model, parse_path(record.law, f"{where}.law"))
        except KeyError as error:
            raise InputError(
                f"leads to no law: {error.args[0]}", where=f"{where}.law", value=record.law
            ) from error
        if not isinstance(law, Law):
            raise InputError("leads to no law", where=f"{where}.law", value=record.law)


def _check_group(group: HeldOut, stated: CampaignFile, where: str) -> None:
    names = {
        "record": {record.name for record in stated.records},
        "channel": {sensor.name for sensor in stated.sensors},
    }.get(group.axis)
    if names is not None:
        for index, member in enumerate(group.members):
            _known(str(member), names, group.axis, f"{where}.members[{index}]")
        return
    finders: dict[str, Callable[[Condition, float], bool]] = {
        "speed": lambda c, v: c.speed_m_per_s is not None and abs(c.speed_m_per_s - v) <= SAME_SPEED * v,
        "temperature": lambda c, v: c.temperature_C == v,
    }
    matches = finders.get(group.axis)
    if matches is None:
        return
    for index, member in enumerate(group.members):
        if not any(matches(condition, float(member)) for condition in stated.conditions):
            what = f"no condition has this {group.axis}"
            raise InputError(what, where=f"{where}.members[{index}]", value=member)


def _known(name: str, names: Iterable[str], what: str, where: str) -> None:
    if name not in names:
        known = sorted(names)
        shown = f"{known[:12]}" + (", ..." if len(known) > 12 else "")
        remedy = f"use one of {shown}" if known else "there are none"
        raise InputError(f"there is no {what} of that name", where=where, value=name, remedy=remedy)
