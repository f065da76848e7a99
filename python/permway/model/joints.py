"""What ties bodies: layers of equal joints."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field, PositiveFloat, model_validator

from permway.laws.base import FrozenModel, Reals

GROUND = "ground"


class Spread(FrozenModel):
    """Stations at equal spacing, from the first to the last.

    Parameters
    ----------
    from_m, to_m : float
        First and last station; the last must lie a whole number of spacings from the first.
    spacing_m : float
        Distance between stations.
    """

    from_m: float
    to_m: float
    spacing_m: PositiveFloat

    @model_validator(mode="after")
    def _check(self) -> Spread:
        bays = (self.to_m - self.from_m) / self.spacing_m
        if bays < 0.0 or abs(bays - round(bays)) > 1e-6 * max(bays, 1.0):
            raise ValueError(
                f"from {self.from_m:g} to {self.to_m:g} m is {bays:.6g} spacings of {self.spacing_m:g} m: "
                "it must be a whole number"
            )
        if bays > 1e6:
            raise ValueError(f"{bays:.3g} stations are too many: is the spacing in metres?")
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

    between: tuple[str, str]
    law: str
    at: tuple[float, ...] | Spread | Ends
    stiffness_is: Literal["each", "total"] = "each"
    layer_m: tuple[float, float] | None = None
    scale: float = Field(default=1.0, ge=0.0)

    @model_validator(mode="after")
    def _check(self) -> Joints:
        upper, lower = self.between
        if upper == GROUND:
            raise ValueError("the ground can only be the lower of the two bodies")
        if upper == lower:
            raise ValueError(f"both bodies are {upper!r}: a joint ties two")
        if isinstance(self.at, tuple) and not self.at:
            raise ValueError("at is empty: name at least one station")
        if self.layer_m is not None:
            if self.stiffness_is == "each":
                raise ValueError('layer_m goes with stiffness_is = "total"')
            if not self.layer_m[0] < self.layer_m[1]:
                raise ValueError(f"layer_m {self.layer_m} does not run from left to right")
        if self.stiffness_is == "total" and isinstance(self.at, Ends):
            raise ValueError('stiffness_is = "total" needs stations along the layer, not its ends')
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
