"""The model file: TOML in, a validated model out."""

from __future__ import annotations

import inspect
import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import Field, PositiveFloat, ValidationError, model_validator

from permway.errors import InputError
from permway.laws.base import FrozenModel, Reals, input_error
from permway.model.irregularity import AnyIrregularity, Conversion
from permway.model.line import Line
from permway.model.presets import LINES
from permway.model.vehicle import Vehicle
from permway.model.vehicle_presets import VEHICLES
from permway.response.receptance import Formulation, Place, check_sweep
from permway.response.train import Train

FORMAT = 1
LARGEST_FILE = 64 * 1024 * 1024
MOST_FREQUENCIES = 10_000_000


class Frequencies(FrozenModel):
    """Frequencies of a sweep: a list, equal steps, or equal ratios.

    Parameters
    ----------
    values_Hz : sequence of float, optional
    from_Hz, to_Hz : float, optional
    step_Hz : float, optional
        Equal steps.
    points : int, optional
        Number of frequencies at equal ratios.
    """

    values_Hz: tuple[float, ...] | None = None
    from_Hz: PositiveFloat | None = None
    to_Hz: PositiveFloat | None = None
    step_Hz: PositiveFloat | None = None
    points: int | None = Field(default=None, ge=2, le=MOST_FREQUENCIES)

    @model_validator(mode="after")
    def _check(self) -> Frequencies:
        ranged = (self.from_Hz, self.to_Hz)
        if self.values_Hz is not None:
            if ranged != (None, None) or self.step_Hz is not None or self.points is not None:
                raise ValueError("give values_Hz, or from_Hz and to_Hz, not both")
            return self
        if self.from_Hz is None or self.to_Hz is None:
            raise ValueError("give values_Hz, or from_Hz and to_Hz with step_Hz or points")
        if (self.step_Hz is None) == (self.points is None):
            raise ValueError("give one of step_Hz (equal steps) and points (equal ratios)")
        if self.to_Hz < self.from_Hz:
            raise ValueError(f"to_Hz = {self.to_Hz:g} lies below from_Hz = {self.from_Hz:g}")
        if self.step_Hz is not None and (self.to_Hz - self.from_Hz) / self.step_Hz > MOST_FREQUENCIES:
            raise ValueError(f"step_Hz = {self.step_Hz:g} makes more than {MOST_FREQUENCIES} frequencies")
        return self

    def array(self) -> Reals:
        """The frequencies in Hz."""
        if self.values_Hz is not None:
            return check_sweep(self.values_Hz)
        assert self.from_Hz is not None
        assert self.to_Hz is not None
        if self.points is not None:
            return np.geomspace(self.from_Hz, self.to_Hz, self.points)
        assert self.step_Hz is not None
        count = int(np.floor((self.to_Hz - self.from_Hz) / self.step_Hz * (1.0 + 1e-12))) + 1
        return self.from_Hz + self.step_Hz * np.arange(count, dtype=np.float64)


class Model(FrozenModel):
    """All that a computation needs, as a model file says it.

    Parameters
    ----------
    format : 1
        Version of the file format.
    title : str
    frequencies : Frequencies
    line : Line
    temperature_C : float, optional
        Of all laws that depend on it.
    forces, sensors : sequence of Place
        Receptances are computed from every force to every sensor.
    train : Train, optional
        With an irregularity: power spectra of the train and of the line at contacts and sensors.
    irregularity : irregularity, optional
    conversion : "per_hertz" or "wavenumber_density_called_per_hertz"
    formulation : "chain" or "receptance"
    """

    format: Literal[1] = FORMAT
    title: str = ""
    frequencies: Frequencies
    line: Line
    temperature_C: float | None = Field(default=None, gt=-273.15, lt=200.0)
    forces: tuple[Place, ...] = ()
    sensors: tuple[Place, ...] = ()
    train: Train | None = None
    irregularity: AnyIrregularity | None = None
    conversion: Conversion = "per_hertz"
    formulation: Formulation = "chain"

    @model_validator(mode="after")
    def _check(self) -> Model:
        if (self.train is None) != (self.irregularity is None):
            raise ValueError("a train needs an irregularity, and an irregularity a train: give both or neither")
        if self.train is None and not self.forces:
            raise ValueError("nothing to compute: give [[forces]] and [[sensors]], or [train] and [irregularity]")
        if self.forces and not self.sensors:
            raise ValueError("forces without [[sensors]]: say where the response is wanted")
        return self


def read_model(path: str | Path) -> Model:
    """Read and check a model file.

    Parameters
    ----------
    path : path
        TOML; see `docs/model-file.md`.

    Raises
    ------
    InputError
        With file, place in the file, value and remedy, for a file that cannot be read, is not TOML, or says
        something that cannot be.
    """
    path = Path(path)
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise InputError("too large for a model file", where=str(path), value=f"{path.stat().st_size} bytes")
        table = tomllib.loads(path.read_bytes().decode("utf-8"))
    except OSError as error:
        raise InputError("cannot be read", where=str(path), value=error.strerror or str(error)) from error
    except UnicodeDecodeError as error:
        raise InputError("is not text in UTF-8", where=f"{path}, byte {error.start}") from error
    except tomllib.TOMLDecodeError as error:
        raise InputError("is not TOML", where=str(path), value=str(error)) from error
    try:
        return model_from_dict(table)
    except InputError as error:
        raise InputError(
            error.what, where=f"{path}: {error.where}", value=error.value, remedy=error.remedy
        ) from error


def model_from_dict(table: Mapping[str, Any]) -> Model:
    """Build a model from a table, as TOML gives it; presets are filled in.

    Raises
    ------
    InputError
        With the place in the table.
    """
    filled = dict(table)
    if "line" in filled:
        filled["line"] = _line(_table(filled["line"], "line"))
    if "train" in filled:
        filled["train"] = _train(_table(filled["train"], "train"))
    try:
        return Model.model_validate(filled)
    except ValidationError as error:
        raise input_error(error, place="model") from error


def _table(value: object, where: str) -> dict[str, Any]:
    if not isinstance(value, Mapping):
        raise InputError("must be a table", where=where, value=value, remedy=f"write [{where}]")
    return dict(value)


def _line(table: dict[str, Any]) -> Line | dict[str, Any]:
    if "preset" not in table:
        return table
    name = table.pop("preset")
    options = _table(table.pop("options", {}), "line.options")
    laws = _table(table.pop("laws", {}), "line.laws")
    if table:
        raise InputError(
            "does not go with a preset",
            where=f"line.{next(iter(table))}",
            remedy="a preset takes options and laws",
        )
    line: Line = _preset(LINES, name, options, "line")
    for law in laws:
        if law not in line.laws:
            raise InputError(
                f"the preset {name!r} has no such law",
                where=f"line.laws.{law}",
                remedy=f"use one of {list(line.laws)}",
            )
    try:
        return Line.model_validate({"bodies": line.bodies, "joints": line.joints, "laws": {**line.laws, **laws}})
    except ValidationError as error:
        raise input_error(error, place="line") from error


def _train(table: dict[str, Any]) -> dict[str, Any]:
    if "speed_km_per_h" in table:
        if "speed_m_per_s" in table:
            raise InputError(
                "the speed is given twice", where="train", remedy="give speed_m_per_s or speed_km_per_h"
            )
        speed = table.pop("speed_km_per_h")
        if not isinstance(speed, int | float) or isinstance(speed, bool):
            raise InputError("must be a number", where="train.speed_km_per_h", value=speed)
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


def _preset(presets: Mapping[str, Callable[..., Any]], name: object, options: dict[str, Any], where: str) -> Any:
    if not isinstance(name, str) or name not in presets:
        raise InputError(
            "no such preset", where=f"{where}.preset", value=name, remedy=f"use one of {sorted(presets)}"
        )
    try:
        inspect.signature(presets[name]).bind(**options)
        return presets[name](**options)
    except InputError as error:
        raise InputError(
            error.what, where=f"{where}: {error.where}", value=error.value, remedy=error.remedy
        ) from error
    except TypeError as error:
        raise InputError(f"the preset {name!r}: {error}", where=where) from error
