"""What makes the joints of one layer unequal: changes over an interval, and scatter."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pydantic import Field, model_validator

from permway.arrays import Reals
from permway.errors import InputError
from permway.model.faults import fault
from permway.model.stations import TOUCH_M, Metres
from permway.records import FrozenModel

LARGEST_FACTOR = 1e6


class Change(FrozenModel):
    """A factor on the joints from one place to another, both included: 0 for joints lost.

    Parameters
    ----------
    from_m, to_m : float
        The interval.
    factor : float, optional
        The same for every joint there.
    factor_from, factor_to : float, optional
        Instead: graded linearly in x, from the one place to the other.
    """

    from_m: Metres
    to_m: Metres
    factor: float | None = Field(default=None, ge=0.0, le=LARGEST_FACTOR)
    factor_from: float | None = Field(default=None, ge=0.0, le=LARGEST_FACTOR)
    factor_to: float | None = Field(default=None, ge=0.0, le=LARGEST_FACTOR)

    @model_validator(mode="after")
    def _check(self) -> Change:
        graded = (self.factor_from, self.factor_to)
        if not self.from_m <= self.to_m:
            raise fault(f"to_m = {self.to_m:g} lies left of from_m = {self.from_m:g}", "to_m")
        if (self.factor is None) == (graded == (None, None)) or (self.factor is None and None in graded):
            raise fault("give factor, or factor_from and factor_to", "factor")
        if self.factor is None and self.from_m == self.to_m:
            raise fault("a graded change needs a length: give factor instead", "to_m")
        return self

    def holds(self, x_m: Reals) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        """Whether each of the places lies in the interval."""
        return np.asarray((x_m >= self.from_m - TOUCH_M) & (x_m <= self.to_m + TOUCH_M), dtype=np.bool_)

    def factors(self, x_m: Reals) -> Reals:
        """Factor at each of the places, 1 outside the interval."""
        inside = self.holds(x_m)
        if self.factor is not None:
            return np.where(inside, self.factor, 1.0)
        ramp = np.interp(x_m, [self.from_m, self.to_m], [self.factor_from or 0.0, self.factor_to or 0.0])
        return np.where(inside, ramp, 1.0)


class Scatter(FrozenModel):
    """A log-normal factor on every joint, mean 1, drawn in the order of x: the same for the same seed.

    Parameters
    ----------
    seed : int
    relative_std : float
        Standard deviation over mean.
    """

    seed: int = Field(ge=0, lt=2**63, strict=True)
    relative_std: float = Field(ge=0.0, le=10.0)

    def factors(self, count: int) -> Reals:
        """Factors of `count` joints."""
        # It takes a third of a second to import, which most models do not need.
        from scipy.special import ndtri

        # The raw stream of PCG64 is guaranteed by numpy; that of its normal numbers is not.
        raw = np.atleast_1d(np.random.PCG64(self.seed).random_raw(count))
        uniform = ((raw >> np.uint64(11)).astype(np.float64) + 0.5) * 2.0**-53
        spread = np.sqrt(np.log1p(self.relative_std**2))
        return np.asarray(np.exp(spread * ndtri(uniform) - 0.5 * spread**2), dtype=np.float64)


def changed(changes: Sequence[Change], scatter: Scatter | None, x_m: Reals, *, where: str) -> Reals:
    """Factor on each joint: the product of all changes that hold it, and then of the scatter.

    Parameters
    ----------
    changes : sequence of Change
    scatter : Scatter, optional
    x_m : ndarray, shape (J,)
        Places of the layer's joints, ascending.
    where : str
        Place of the layer in the model.

    Raises
    ------
    InputError
        For a change that holds no joint.
    """
    factors = np.ones(x_m.shape)
    for index, change in enumerate(changes):
        if not change.holds(x_m).any():
            reach = (
                f"the layer's joints are from {x_m.min():g} to {x_m.max():g} m" if x_m.size else "there are none"
            )
            raise InputError(
                "holds no joint of the layer",
                where=f"{where}.changes[{index}]",
                value=(change.from_m, change.to_m),
                remedy=f"move it, or widen it to hold a station; {reach}",
            )
        factors *= change.factors(x_m)
    return factors if scatter is None else factors * scatter.factors(x_m.size)
