"""The form of a measuring team's `sheet.json`."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, ConfigDict, Field, PositiveFloat, ValidationError, model_validator

from permway.errors import InputError
from permway.model.faults import fault, model_error, refuse_coercion
from permway.reading import read_bytes
from permway.records import FrozenModel, Number

LARGEST_SHEET = 4 * 1024 * 1024


class _Part(FrozenModel):
    """A table of the sheet, which may say more than is read."""

    model_config = ConfigDict(frozen=True, extra="ignore", allow_inf_nan=False)


class Layout(_Part):
    """Spans, slabs, fasteners and approaches, m."""

    spans: int = Field(ge=1, le=1000, strict=True)
    span_m: PositiveFloat
    fastener_spacing_m: PositiveFloat
    approach_m: Number = Field(ge=0.0)
    slab_length_m: PositiveFloat


class RailValues(_Part):
    """Rail, SI."""

    E: PositiveFloat
    I: PositiveFloat  # noqa: E741
    rho: PositiveFloat
    A: PositiveFloat
    G: PositiveFloat
    kappa: PositiveFloat
    eta: Number = Field(ge=0.0)


class BeamValues(_Part):
    """Slab, base or girder, SI."""

    E: PositiveFloat
    I: PositiveFloat  # noqa: E741
    rho: PositiveFloat
    A: PositiveFloat
    eta: Number = Field(ge=0.0)


class LayerValues(_Part):
    """A layer's stiffness, N/m, and loss factor; with `viscous_at_Hz` that there, and a dashpot's elsewhere."""

    k: PositiveFloat
    eta: Number = Field(ge=0.0)
    viscous_at_Hz: PositiveFloat | None = None


class VehicleValues(_Part):
    """Vehicle: masses of the whole, suspensions of one side; `half` is the share of the masses in the model."""

    Mc: PositiveFloat
    Mt: PositiveFloat
    Mw: PositiveFloat
    Jc: PositiveFloat
    Jt: PositiveFloat
    kp: PositiveFloat
    cp: PositiveFloat
    ks: PositiveFloat
    cs: PositiveFloat
    lc: PositiveFloat
    lt: PositiveFloat
    half: float = Field(gt=0.0, le=1.0)


class Values(_Part):
    """The designer's values."""

    rail: RailValues
    slab: BeamValues
    base: BeamValues
    girder: BeamValues
    pad: LayerValues
    mortar: LayerValues
    sliding: LayerValues
    bearing: LayerValues
    vehicle: VehicleValues


def _place(value: object) -> object:
    if not (isinstance(value, list | tuple) and len(value) == 2 and isinstance(value[0], str)):
        raise fault("must be [body, x in m]", value=value)
    return value


Location = Annotated[tuple[str, Number], BeforeValidator(_place)]
"""Body and x, m."""


class Hammer(_Part):
    """The hammer test."""

    quantity: str
    lines_Hz: tuple[Number, Number, Number]
    sensors: tuple[Location, ...] = Field(min_length=1)
    points: tuple[Location, ...] = Field(min_length=1)


def _position(value: object) -> object:
    numbers = isinstance(value, list | tuple) and all(
        isinstance(x, int | float) and not isinstance(x, bool) and math.isfinite(x) for x in value
    )
    if not (isinstance(value, str) or numbers):
        raise fault("must be words, or a list of where each wheelset stands in m", value=value)
    return value


class Runs(_Part):
    """The train's runs."""

    sampling_Hz: PositiveFloat
    seconds: PositiveFloat
    unit: str
    speeds_kmh: tuple[PositiveFloat, ...] = Field(min_length=1)
    channels: tuple[str, ...] = Field(min_length=1)
    position: Annotated[str | tuple[Number, ...], BeforeValidator(_position)] = ""
    irregularity: str = ""


class Sheet(_Part):
    """A sheet, checked."""

    layout: Layout
    values: Values
    contact_stiffness_N_per_m: PositiveFloat
    tolerance_2sigma_relative: dict[str, dict[str, PositiveFloat]]
    temperature_C: tuple[Number, ...] = Field(min_length=1)
    hammer: Hammer
    runs: Runs | None = None

    @model_validator(mode="after")
    def _check(self) -> Sheet:
        for group, table in self.tolerance_2sigma_relative.items():
            values = getattr(self.values, group, None)
            if values is None:
                raise fault(f"there are no values of {group!r}", "tolerance_2sigma_relative", group)
            for key, tolerance in table.items():
                if not hasattr(values, key):
                    raise fault(f"{group} has no value {key!r}", "tolerance_2sigma_relative", group, key)
                if tolerance >= 1.0:
                    what = "reaches below zero: give a ratio, not percent"
                    raise fault(what, "tolerance_2sigma_relative", group, key, value=tolerance)
        return self


def read_sheet(folder: Path) -> Sheet:
    """Read and check `sheet.json` of a folder.

    Raises
    ------
    InputError
        With the place in the sheet.
    """
    path = folder / "sheet.json"
    table = _load(path)
    try:
        sheet = Sheet.model_validate(table)
        refuse_coercion(table, sheet, "")
        return sheet
    except (ValidationError, InputError) as error:
        reported = error if isinstance(error, InputError) else model_error(error, table, "")
        raise InputError(
            reported.what, where=f"{path}: {reported.where}", value=reported.value, remedy=reported.remedy
        ) from error


def _load(path: Path) -> Mapping[str, Any]:
    content = read_bytes(path, LARGEST_SHEET, remedy="name a folder that holds one")
    try:
        table = json.loads(content.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        raise InputError(
            "is not text in UTF-8", where=f"{path}, byte {error.start}", remedy="save it as UTF-8"
        ) from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"is not JSON: {error}", where=str(path)) from error
    if not isinstance(table, dict):
        raise InputError("must be a table", where=str(path))
    return table
