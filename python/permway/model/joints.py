"""What ties bodies: layers of equal joints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from permway.arrays import Reals
from permway.model.changes import Change, Scatter
from permway.model.faults import fault
from permway.model.stations import MEETINGS, Interval, JointsAt, groups
from permway.model.stations import Ends as Ends
from permway.model.stations import Spread as Spread
from permway.records import FrozenModel

GROUND = "ground"


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
    at : sequence of float, Spread, sequence of Spread, Ends, or "meetings"
        Where the joints are; "meetings" ties neighbours of one row wherever two of its beams meet, as dowels do,
        and then `between` names the row twice.
    stiffness_is : "each", "total" or "per_metre"
        Whether the law is that of each joint; or that of the layer, shared out by the length that each station
        stands for (between the middles of its bays; `layer_m` bounds the first and last); or that of a metre of
        layer (N/m2), times that length.
    layer_m : (from, to), optional
        Extent of a layer whose stiffness is the total or per metre; by default from first to last station.
    scale : float
        Factor on the law.
    changes : sequence of Change
        Factors over intervals: joints lost, weakened, graded. Where they overlap they multiply.
    scatter : Scatter, optional
        A random factor on each joint, on top of all else.
    """

    between: Annotated[tuple[str, str], BeforeValidator(_two)]
    law: str
    at: JointsAt
    stiffness_is: Literal["each", "total", "per_metre"] = "each"
    layer_m: Interval | None = None
    scale: float = Field(default=1.0, ge=0.0)
    changes: tuple[Change, ...] = ()
    scatter: Scatter | None = None

    @model_validator(mode="after")
    def _check(self) -> Joints:
        upper, lower = self.between
        if upper == GROUND:
            raise fault("the ground can only be the lower of the two bodies", "between")
        if (upper == lower) != (self.at == MEETINGS):
            if upper != lower:
                raise fault('at = "meetings" ties the beams of one row: name it twice', "between")
            raise fault(f'both bodies are {upper!r}: a joint ties two, or a row at its "meetings"', "between")
        if self.stiffness_is == "each":
            if self.layer_m is not None:
                raise fault('layer_m goes with stiffness_is = "total" or "per_metre"', "layer_m")
            return self
        if isinstance(self.at, Ends | str):
            what = f'stiffness_is = "{self.stiffness_is}" needs stations along the layer, not its ends'
            raise fault(what, "stiffness_is")
        self._check_lengths(groups(self.at))
        return self

    def _check_lengths(self, stretches: Sequence[Reals]) -> None:
        """Refuse a layer of which a station has no length to stand for."""
        if self.layer_m is None:
            single = min(x.size for x in stretches) == 1
            if single and (self.stiffness_is == "per_metre" or len(stretches) > 1):
                raise fault("a single station stands for no length: give layer_m, or more stations", "at")
            return
        start, stop = self.layer_m
        if len(stretches) > 1:
            raise fault("layer_m bounds one stretch: write a layer for each", "layer_m")
        if not start < stop:
            raise fault(f"({start:g}, {stop:g}) m does not run from left to right", "layer_m")
        first, last = float(stretches[0][0]), float(stretches[0][-1])
        if first < start - 1e-9 or last > stop + 1e-9:
            what = f"({start:g}, {stop:g}) m does not hold all stations, {first:g} to {last:g} m"
            raise fault(what, "layer_m")

    def weights(self, stretches: Sequence[Reals]) -> Reals:
        """Factor on the law for each station of the stretches, before changes and scatter."""
        if self.stiffness_is == "each":
            return np.full(sum(x.size for x in stretches), self.scale)
        if self.stiffness_is == "total" and len(stretches) == 1 and stretches[0].size == 1:
            return np.array([self.scale])
        lengths = np.concatenate([_lengths(x, self.layer_m) for x in stretches])
        share = 1.0 / lengths.sum() if self.stiffness_is == "total" else 1.0
        return np.asarray(self.scale * share * lengths, dtype=np.float64)


def _lengths(stations: Reals, layer_m: tuple[float, float] | None) -> Reals:
    """Length that each of the ascending stations stands for, m."""
    start, stop = layer_m or (float(stations[0]), float(stations[-1]))
    return np.diff(np.concatenate([[start], 0.5 * (stations[1:] + stations[:-1]), [stop]]))
