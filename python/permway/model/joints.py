"""What ties bodies: layers of equal joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Literal

import numpy as np
from pydantic import BeforeValidator, Field, PositiveFloat, TypeAdapter, model_validator

from permway.arrays import Reals
from permway.model.bodies import Interval, Metres
from permway.model.faults import fault
from permway.records import FrozenModel

GROUND = "ground"
MOST_STATIONS = 1_000_000


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
    """One station at each end of every interval of a body.

    Parameters
    ----------
    of : str
        The body.
    inset_m : float
        Distance of the station from the end, inwards.
    """

    of: str
    inset_m: float = Field(default=0.0, ge=0.0)


def _stations(value: object) -> object:
    """Read one of the three forms by its looks, so that a fault in it is told as that form's."""
    if isinstance(value, Spread | Ends):
        return value
    if isinstance(value, Mapping):
        return (Ends if "of" in value else Spread).model_validate(dict(value))
    if isinstance(value, np.ndarray) or (isinstance(value, Sequence) and not isinstance(value, str)):
        return _LIST.validate_python(tuple(value))
    raise fault(
        "must be a list of stations in m, {from_m, to_m, spacing_m} or {of = a body} for its ends", value=value
    )


_LIST: TypeAdapter[tuple[Metres, ...]] = TypeAdapter(tuple[Metres, ...])


def _two(value: object) -> object:
    if not (isinstance(value, Sequence) and len(value) == 2 and all(isinstance(name, str) for name in value)):
        raise fault('must be the names of two bodies [upper, lower]; the lower may be "ground"', value=value)
    return value


class Joints(FrozenModel):
    """Joints of one law between two bodies, or a body and the ground.

    Parameters
    ----------
    between : (upper, lower)
        Names of two bodies; the lower may be "ground". Of a row of beams, "girder[2]" names the second.
    law : str
        Name of a law of the line.
    at : sequence of float, Spread, or Ends
        Where the joints are.
    stiffness_is : "each" or "total"
        Whether the law is that of each joint, or that of the layer, shared out by the length that each
        station stands for (between the middles of its bays; `layer_m` bounds the first and last).
    layer_m : (from, to), optional
        Extent of a layer whose stiffness is the total; by default from first to last station.
    scale : float
        Factor on the law.
    """

    between: Annotated[tuple[str, str], BeforeValidator(_two)]
    law: str
    at: Annotated[tuple[float, ...] | Spread | Ends, BeforeValidator(_stations)]
    stiffness_is: Literal["each", "total"] = "each"
    layer_m: Interval | None = None
    scale: float = Field(default=1.0, ge=0.0)

    @model_validator(mode="after")
    def _check(self) -> Joints:
        upper, lower = self.between
        if upper == GROUND:
            raise fault("the ground can only be the lower of the two bodies", "between")
        if upper == lower:
            raise fault(f"both bodies are {upper!r}: a joint ties two", "between")
        if isinstance(self.at, tuple) and not self.at:
            raise fault("at is empty: name at least one station", "at")
        if self.layer_m is not None:
            if self.stiffness_is == "each":
                raise fault('layer_m goes with stiffness_is = "total"', "layer_m")
            start, stop = self.layer_m
            if not start < stop:
                raise fault(f"({start:g}, {stop:g}) m does not run from left to right", "layer_m")
            if not isinstance(self.at, Ends):
                x = self.at if isinstance(self.at, tuple) else (self.at.from_m, self.at.to_m)
                if min(x) < start - 1e-9 or max(x) > stop + 1e-9:
                    what = f"({start:g}, {stop:g}) m does not hold all stations, {min(x):g} to {max(x):g} m"
                    raise fault(what, "layer_m")
        if self.stiffness_is == "total" and isinstance(self.at, Ends):
            raise fault('stiffness_is = "total" needs stations along the layer, not its ends', "stiffness_is")
        return self

    def weights(self, stations: Reals) -> Reals:
        """Factor on the law for each of the ascending stations."""
        if self.stiffness_is == "each":
            return np.full(stations.shape, self.scale)
        start, stop = self.layer_m or (float(stations[0]), float(stations[-1]))
        if stop <= start:
            return np.full(stations.shape, self.scale / stations.size)
        bounds = np.concatenate([[start], 0.5 * (stations[1:] + stations[:-1]), [stop]])
        return np.asarray(self.scale * np.diff(bounds) / (stop - start), dtype=np.float64)
