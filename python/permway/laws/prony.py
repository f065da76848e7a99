"""Generalised Maxwell solid: a Prony series."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import model_validator

from permway.arrays import Complexes, Reals
from permway.laws.base import Law
from permway.records import FloatTuple, Number


class Prony(Law):
    """Spring beside any number of Maxwell elements, k0 + sum_j g_j i omega tau_j / (1 + i omega tau_j).

    Parameters
    ----------
    relaxed : float
        k0, limit at low frequency, N/m or Pa.
    strengths : tuple of float, shape (n,)
        g_j, N/m or Pa.
    relaxation_times_s : tuple of float, shape (n,)
        tau_j, in seconds, above zero.
    """

    type: Literal["prony"] = "prony"
    relaxed: Number
    strengths: FloatTuple
    relaxation_times_s: FloatTuple

    @model_validator(mode="after")
    def _terms_match(self) -> Prony:
        if len(self.strengths) != len(self.relaxation_times_s):
            raise ValueError(
                f"{len(self.strengths)} strengths but {len(self.relaxation_times_s)} relaxation times; "
                "every term needs both"
            )
        for index, time in enumerate(self.relaxation_times_s):
            if time <= 0.0:
                raise ValueError(f"relaxation_times_s[{index}] must be above zero, not {time:g}")
        return self

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        value = np.full(omega.shape, self.relaxed, dtype=np.complex128)
        for strength, time in zip(self.strengths, self.relaxation_times_s, strict=True):
            turn = 1j * omega * time
            value = value + strength * turn / (1.0 + turn)
        return value

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        return True, "all its poles lie in the stable half plane"

    def _static(self) -> float | None:
        return self.relaxed
