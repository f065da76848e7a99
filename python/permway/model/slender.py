"""What beams and shafts share: where they lie, what holds their ends, and where their section changes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Literal, get_args

from pydantic import BeforeValidator, Field, NonNegativeFloat, PositiveFloat, model_validator

from permway.model.faults import fault
from permway.model.stations import TOUCH_M, Interval, Metres
from permway.records import FrozenModel

End = Literal["free", "pinned", "clamped"]

SHORTEST_M = 1e-6
"""A change of section over less is a mistake."""

Factor = Annotated[float, Field(gt=0.0, le=1e6)]


def _ends(value: object) -> object:
    given = [value] if isinstance(value, str) else value
    known = isinstance(given, Sequence) and all(isinstance(e, str) and e in get_args(End) for e in given)
    if not known or (value is given and len(given) != 2):  # type: ignore[arg-type]
        raise fault('must be "free", "pinned" or "clamped", or one of them for each end', value=value)
    return value


Ends = Annotated[End | tuple[End, End], BeforeValidator(_ends)]


class SectionChange(FrozenModel):
    """Factors on the section from one place to another.

    Parameters
    ----------
    from_m, to_m : float
        The interval.
    mass_factor : float
        On mass and rotary inertia.
    """

    from_m: Metres
    to_m: Metres
    mass_factor: Factor = 1.0

    @model_validator(mode="after")
    def _check(self) -> SectionChange:
        if not self.to_m >= self.from_m + SHORTEST_M:
            what = f"to_m = {self.to_m:g} lies left of from_m = {self.from_m:g}, or too near to it"
            raise fault(what, "to_m")
        if not self.model_fields_set - {"from_m", "to_m"}:
            factors = [name for name in type(self).model_fields if name.endswith("_factor")]
            raise fault(f"changes nothing: give one of {sorted(factors)}")
        return self


class Slender(FrozenModel):
    """A body along x, or a row of equal ones.

    Parameters
    ----------
    loss_factor : float
        Of all moduli, hysteretic.
    intervals_m : sequence of (from, to), optional
        Where the bodies lie; left out, the body has no end on either side.
    ends : "free", "pinned" or "clamped", or one for each end
        A pinned end does not move; a clamped end of a beam neither moves nor turns.
    share : float
        Factor on stiffness and mass: 0.5 for half of the body, 2 for two as one.
    """

    loss_factor: NonNegativeFloat = 0.0
    intervals_m: tuple[Interval, ...] | None = Field(default=None, min_length=1)
    ends: Ends = "free"
    share: PositiveFloat = 1.0

    @model_validator(mode="after")
    def _check_intervals(self) -> Slender:
        reach = -math.inf
        for index, (start, stop) in enumerate(self.intervals_m or ()):
            if not start < stop:
                what = f"the interval ({start:g}, {stop:g}) m does not run from left to right"
                raise fault(what, "intervals_m", index)
            if start < reach:
                what = (
                    f"the interval ({start:g}, {stop:g}) m begins before {reach:g} m, where the one before it "
                    "ends: name the beams from left to right, without overlap"
                )
                raise fault(what, "intervals_m", index)
            reach = stop
        return self

    @property
    def pinned(self) -> tuple[bool, bool]:
        """Whether the left and the right end do not move, pinned or clamped."""
        left, right = (self.ends, self.ends) if isinstance(self.ends, str) else self.ends
        return left != "free", right != "free"

    @property
    def clamped(self) -> tuple[bool, bool]:
        """Whether the left and the right end neither move nor turn."""
        left, right = (self.ends, self.ends) if isinstance(self.ends, str) else self.ends
        return left == "clamped", right == "clamped"


def check_changes(changes: Sequence[SectionChange], intervals_m: Sequence[tuple[float, float]] | None) -> None:
    """Refuse changes of section that lie off the bodies, on two of them, or over each other."""
    order = sorted(range(len(changes)), key=lambda index: changes[index].from_m)
    reach = -math.inf
    for index in order:
        change = changes[index]
        reported = f"the interval ({change.from_m:g}, {change.to_m:g}) m"
        if change.from_m < reach - TOUCH_M:
            what = f"{reported} begins before {reach:g} m, where another change ends: leave no overlap"
            raise fault(what, "changes", index)
        reach = change.to_m
        held = [
            start - TOUCH_M <= change.from_m and change.to_m <= stop + TOUCH_M
            for start, stop in intervals_m or ((-math.inf, math.inf),)
        ]
        if not any(held):
            runs = ", ".join(f"{start:g} to {stop:g} m" for start, stop in (intervals_m or ())[:4])
            more = ", ..." if intervals_m is not None and len(intervals_m) > 4 else ""
            raise fault(f"{reported} does not lie on one body, which runs {runs}{more}", "changes", index)
