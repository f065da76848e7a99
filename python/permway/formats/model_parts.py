"""A model's tables made into its parts: lines, laws from files, trains, presets."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, get_args

from pydantic import ValidationError

from permway.errors import InputError
from permway.laws.base import Law
from permway.laws.lawfile import identified_quantity, load_law
from permway.laws.measured import Quantity, read_measured
from permway.model.faults import below, model_error, refuse_coercion, table_at
from permway.model.irregularity_spectra import FASTEST_M_PER_S
from permway.model.line import Line
from permway.model.presets import LAWS, LINES
from permway.model.vehicle import Vehicle
from permway.model.vehicle_presets import VEHICLES
from permway.reading import inside


def line_of(table: dict[str, Any], folder: Path | None) -> Line | dict[str, Any]:
    """A preset's line, or the table with its laws read."""
    if isinstance(table.get("laws"), Mapping):
        table["laws"] = {name: _law(law, f"line.laws.{name}", folder) for name, law in table["laws"].items()}
    if "preset" not in table:
        return table
    name = table.pop("preset")
    options = table_at(table.pop("options", {}), "line.options")
    laws = table_at(table.pop("laws", {}), "line.laws")
    if table:
        raise InputError(
            "does not go with a preset",
            where=f"line.{next(iter(table))}",
            remedy="a preset takes options and laws",
        )
    if "pad" in options:
        options["pad"] = _law(options["pad"], "line.options.pad", folder)
    line: Line = _preset(LINES, name, options, "line", "options")
    for law in laws:
        if law not in line.laws:
            raise InputError(
                f"the preset {name!r} has no such law",
                where=f"line.laws.{law}",
                remedy=f"use one of {list(line.laws)}",
            )
    changed = {"bodies": line.bodies, "joints": line.joints, "laws": {**line.laws, **laws}}
    try:
        built = Line.model_validate(changed)
    except ValidationError as error:
        raise model_error(error, changed, "line") from error
    refuse_coercion(laws, {key: built.laws[key] for key in laws}, "line.laws")
    return built


def _law(law: object, where: str, folder: Path | None) -> object:
    """A law by name or from a file, also within a law made of laws; else the table as it is."""
    if not isinstance(law, Mapping):
        return law
    if "preset" in law:
        options = dict(law)
        built: Law = _preset(LAWS, options.pop("preset"), options, where)
        return built
    if "file" in law:
        return _law_file(dict(law), where, folder)
    return {key: _law(part, f"{where}.{key}", folder) for key, part in law.items()}


def _law_file(table: dict[str, Any], where: str, folder: Path | None) -> Law:
    name = table.pop("file")
    quantity = None
    if table.get("type") == "measured":
        quantity = table.pop("quantity", None)
        if quantity not in get_args(Quantity):
            raise InputError(
                "unknown",
                where=f"{where}.quantity",
                value=quantity,
                remedy=f"use one of {list(get_args(Quantity))}",
            )
        del table["type"]
    if table:
        raise InputError(
            "does not go with a file", where=f"{where}.{next(iter(table))}", remedy="name the file alone"
        )
    if folder is None:
        raise InputError("a table without a folder cannot name a file", where=f"{where}.file", value=name)
    path = inside(name, folder, where=f"{where}.file", of="the model's", remedy="put it beside the model")
    try:
        if quantity is not None:
            return read_measured(path, quantity)
        law = load_law(path)
        _check_quantity(identified_quantity(path), where)
        return law
    except InputError as error:
        raise InputError(
            error.what, where=f"{where}.file: {error.where}", value=error.value, remedy=error.remedy
        ) from error


def _check_quantity(identified: str | None, where: str) -> None:
    """Refuse the stiffness of a part where a material's modulus belongs, and the other way round."""
    if identified == "stiffness" and where.endswith(".material"):
        raise InputError(
            "was identified from the stiffness of a part, and a pad's material is a modulus",
            where="identification.quantity",
            value=identified,
            remedy="name the file as the law itself, or identify it again with --shape-factor",
        )
    if identified == "modulus" and where.count(".") == 2:
        raise InputError(
            "was identified from a modulus, in Pa, and a joint needs a stiffness, in N/m",
            where="identification.quantity",
            value=identified,
            remedy='use { type = "pad", material = { file = ... }, area_m2 = ..., thickness_m = ...}',
        )


def train_of(table: dict[str, Any]) -> dict[str, Any]:
    """A train's table with its speed in m/s and its vehicle, or a preset's."""
    if "speed_km_per_h" in table:
        if "speed_m_per_s" in table:
            raise InputError(
                "the speed is given twice", where="train", remedy="give speed_m_per_s or speed_km_per_h"
            )
        speed = table.pop("speed_km_per_h")
        if not isinstance(speed, int | float) or isinstance(speed, bool):
            raise InputError("must be a number", where="train.speed_km_per_h", value=speed)
        # Out of all bounds, an integer may not even fit a float.
        if not 0 < speed <= 3.6 * FASTEST_M_PER_S:
            raise InputError(
                f"must be above 0 and at most {3.6 * FASTEST_M_PER_S:g} km/h",
                where="train.speed_km_per_h",
                value=speed,
            )
        table["speed_m_per_s"] = speed / 3.6
    vehicle = table.get("vehicle")
    if isinstance(vehicle, Mapping) and "preset" in vehicle:
        options = dict(vehicle)
        name = options.pop("preset")
        whole: Vehicle = _preset({key: _constant(v) for key, v in VEHICLES.items()}, name, {}, "train.vehicle")
        table["vehicle"] = {**whole.model_dump(), **options}
    return table


def _constant(value: Vehicle) -> Callable[[], Vehicle]:
    return lambda: value


def _preset(
    presets: Mapping[str, Callable[..., Any]],
    name: object,
    options: dict[str, Any],
    where: str,
    key: str | None = None,
) -> Any:
    """Call a preset; its options lie in the table `key` of `where`, or in `where` itself."""
    if not isinstance(name, str) or name not in presets:
        raise InputError(
            "no such preset", where=f"{where}.preset", value=name, remedy=f"use one of {sorted(presets)}"
        )
    inside = f"{where}.{key}" if key else where
    try:
        inspect.signature(presets[name]).bind(**options)
        return presets[name](**options)
    except InputError as error:
        raise below(inside, error) from error
    except TypeError as error:
        raise InputError(f"the preset {name!r}: {error}", where=inside) from error
