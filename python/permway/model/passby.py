"""What a model file states about a passage."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, PositiveFloat, model_validator

from permway.model.bodies import Metres
from permway.model.faults import fault
from permway.records import FrozenModel

Quantity = Literal["displacement", "velocity", "acceleration"]


class PassBy(FrozenModel):
    """The table `[passby]` of a model file; see :func:`permway.response.passby.run.passby`.

    Parameters
    ----------
    highest_Hz : float
    quantity : "displacement", "velocity" or "acceleration"
    dynamic : bool
        Whether to add the random forces of the model's irregularity.
    seed : int
        Of those.
    window_s, from_m, to_m, ramp_m, order, averaging_s, wraparound_limit
        As there.
    """

    highest_Hz: PositiveFloat
    quantity: Quantity = "velocity"
    dynamic: bool = True
    seed: int = Field(default=0, ge=0, strict=True)
    window_s: PositiveFloat | None = None
    from_m: Metres | None = None
    to_m: Metres | None = None
    ramp_m: float | None = Field(default=None, ge=0.0)
    order: int = Field(default=6, ge=3, le=16, strict=True)
    averaging_s: PositiveFloat | None = None
    wraparound_limit: float = Field(default=0.02, gt=0.0, le=0.5)

    @model_validator(mode="after")
    def _check(self) -> PassBy:
        if self.from_m is not None and self.to_m is not None and not self.from_m < self.to_m:
            raise fault(f"does not lie beyond from_m = {self.from_m:g}", "to_m", value=self.to_m)
        return self
