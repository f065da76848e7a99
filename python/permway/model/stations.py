"""Places along a line, and the forms in which a file names many of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Literal

import numpy as np
from pydantic import BeforeValidator, Field, PositiveFloat, TypeAdapter, model_validator

from permway.arrays import Reals
from permway.model.faults import fault
from permway.records import FrozenModel, Number

FARTHEST_M = 1e6
"""Coordinates beyond this are taken for a wrong unit."""

MOST_STATIONS = 1_000_000

MEETINGS = "meetings"
"""In the place of stations: wherever two beams of a row meet."""

TOUCH_M = 1e-9
"""Stations closer than this are one, as in the core."""

Metres = Annotated[Number, Field(ge=-FARTHEST_M, le=FARTHEST_M)]


def _pair(value: object) -> object:
    if isinstance(value, Sequence) and not isinstance(value, str) and len(value) != 2:
        raise fault("must be two places [from, to]", value=value)
    return value


Interval = Annotated[tuple[Metres, Metres], BeforeValidator(_pair)]
"""From and to, m."""


class Spread(FrozenModel):
    """Stations at equal spacing, from the first to the last.

    Parameters
    ----------
    from_m, to_m : float
        First and last station; the last must lie a whole number of spacings from the first.
    spacing_m : float
        Distance between stations.
    """

    from_m: Metres
    to_m: Metres
    spacing_m: PositiveFloat

    @model_validator(mode="after")
    def _check(self) -> Spread:
        if self.to_m < self.from_m:
            raise fault(f"to_m = {self.to_m:g} lies left of from_m = {self.from_m:g}", "to_m")
        bays = (self.to_m - self.from_m) / self.spacing_m
        if bays > MOST_STATIONS:
            raise fault(f"makes {bays:.3g} stations: is the spacing in metres?", "spacing_m", value=self.spacing_m)
        if abs(bays - round(bays)) > 1e-6 * max(bays, 1.0):
            near = self.from_m + round(bays) * self.spacing_m
            what = (
                f"from {self.from_m:g} to {self.to_m:g} m is {bays:.6g} spacings of {self.spacing_m:g} m: it must "
                f"be a whole number; the nearest to_m is {near:g}"
            )
            raise fault(what, "to_m")
        return self

    def stations(self) -> Reals:
        """Stations in m, ascending."""
        bays = round((self.to_m - self.from_m) / self.spacing_m)
        return self.from_m + self.spacing_m * np.arange(bays + 1, dtype=np.float64)


class Ends(FrozenModel):
    """The places of another row: both ends of every beam, or every mass.

    Parameters
    ----------
    of : str
        The row: a beam with `intervals_m`, or a mass with `at`.
    inset_m : float
        Distance of the station from a beam's end, inwards.
    within_m : float
        Where masses are placed: ends no farther apart share one mass, in their middle (a pier under two girders).
        Where masses are joined: each end is joined to the nearest mass of a row, which may lie so far from it.
    """

    of: str
    inset_m: float = Field(default=0.0, ge=0.0)
    within_m: float = Field(default=0.0, ge=0.0, le=FARTHEST_M)


def shared(stations: Reals, within_m: float) -> Reals:
    """Ascending stations, each group that fits into `within_m` drawn together to its middle, m."""
    groups: list[list[float]] = []
    for x in np.sort(stations).tolist():
        if groups and x - groups[-1][0] <= within_m + TOUCH_M:
            groups[-1].append(x)
        else:
            groups.append([x])
    return np.array([0.5 * (group[0] + group[-1]) for group in groups], dtype=np.float64)


Along = tuple[Metres, ...] | tuple[Spread, ...] | Spread
"""Stations that the file itself spells out."""

_FORMS = "a list of stations in m, {from_m, to_m, spacing_m}, a list of these, or {of = a row} for its ends"
_LIST: TypeAdapter[tuple[Metres, ...]] = TypeAdapter(tuple[Metres, ...])
_SPREADS: TypeAdapter[tuple[Spread, ...]] = TypeAdapter(tuple[Spread, ...])


def _read(value: object) -> object:
    """Read one of the forms by its looks, so that a fault in it is reported as that form's."""
    if isinstance(value, Spread | Ends):
        return value
    if isinstance(value, Mapping):
        return (Ends if "of" in value else Spread).model_validate(dict(value))
    if isinstance(value, np.ndarray) or (isinstance(value, Sequence) and not isinstance(value, str)):
        items = tuple(value)
        if not items:
            raise fault("at is empty: name at least one station")
        spread = any(isinstance(item, Spread | Mapping) for item in items)
        return _SPREADS.validate_python(items) if spread else _LIST.validate_python(items)
    raise fault(f"must be {_FORMS}", value=value)


def _read_joints(value: object) -> object:
    return value if isinstance(value, str) and value == MEETINGS else _read(value)


MassesAt = Annotated[Along | Ends, BeforeValidator(_read)]
"""Where the masses of a row stand."""

JointsAt = Annotated[Along | Ends | Literal["meetings"], BeforeValidator(_read_joints)]
"""Where the joints of a layer are."""


def groups(at: Along) -> list[Reals]:
    """Ascending stations of every stretch that the file spells out: one, or as many as there are spreads."""
    if isinstance(at, Spread):
        return [at.stations()]
    spreads = [item for item in at if isinstance(item, Spread)]
    if spreads:
        return [spread.stations() for spread in sorted(spreads, key=lambda spread: spread.from_m)]
    return [np.sort(np.asarray(at, dtype=np.float64))]
