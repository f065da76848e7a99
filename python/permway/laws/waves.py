"""What waves do that need time to cross a joint: a rod between two bodies."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from permway.arrays import Complexes, Reals
from permway.laws.base import Law
from permway.records import Number


class Waves(Law):
    """One part of a rod that waves take a time to cross, as a thick soft layer between two bodies is.

    Forces at the ends of a rod of static stiffness k (1 + i eta), b = omega delay / sqrt(1 + i eta), are

        k (1 + i eta) b [[cot b, -1/sin b], [-1/sin b, cot b]]

    times the movements of the ends. That is a joint between the bodies of the `through` part, k (1 + i eta) b /
    sin b, and on each of them a joint to the ground of the `end` part, -k (1 + i eta) b tan(b / 2): the rod's
    mass, k delay^2, half of it at either end as long as waves are long (Cremer, Heckl and Petersson,
    Structure-Borne Sound, 3rd ed., 2005, section 3.1).

    Parameters
    ----------
    stiffness : float
        Of the whole rod at rest, N/m.
    delay_s : float
        Time that a wave takes from one end to the other, s, above zero.
    loss_factor : float
        Dimensionless; kept as the attribute `eta`.
    part : "through" or "end"
    """

    type: Literal["waves"] = "waves"
    stiffness: Number
    delay_s: Number
    eta: Number = Field(default=0.0, alias="loss_factor")
    part: Literal["through", "end"]

    @model_validator(mode="after")
    def _time_is_positive(self) -> Waves:
        if self.delay_s <= 0.0:
            raise ValueError(f"delay_s must be above zero, not {self.delay_s:g}")
        return self

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        loss = 1.0 + 1j * self.eta
        turn = omega * self.delay_s / np.sqrt(loss)
        shape = turn / np.sin(turn) if self.part == "through" else -turn * np.tan(0.5 * turn)
        return np.asarray(self.stiffness * loss * shape, dtype=np.complex128)

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        if self.eta == 0.0:
            return None, ""
        return False, "waves: a loss that does not depend on frequency is not causal"

    def _static(self) -> float | None:
        return self.stiffness if self.part == "through" else 0.0

    def _caveats(self) -> tuple[str, ...]:
        if self.part == "end":
            return ()
        return ("the through part alone may give energy: a rod is passive together with its two ends",)
