"""The train of a passage: axles with their loads, when they come, and which way they run."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat, model_validator

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.model.bodies import Metres
from permway.model.faults import fault
from permway.model.irregularity import AnyIrregularity
from permway.model.vehicle import STANDARD_GRAVITY
from permway.records import FloatTuple, FrozenModel, Number
from permway.response.passby.loads import check_axles


class Suspension(FrozenModel):
    """What lies between each axle and the mass above it.

    Parameters
    ----------
    stiffness_N_per_m, damping_Ns_per_m : float
        Of all springs and dampers of one axle, of what the model carries.
    unsprung_kg : float
        Of the axle itself; its load less this weight is what the springs carry.
    contact_N_per_m : float, optional
        Spring between the axle and what it runs on; without one it is rigid.
    """

    stiffness_N_per_m: PositiveFloat
    damping_Ns_per_m: PositiveFloat
    unsprung_kg: NonNegativeFloat = 0.0
    contact_N_per_m: PositiveFloat | None = None

    def answer(self, loads_N: Reals, omega: Reals) -> Complexes:
        """Force on the line per displacement of the line under the axle, N/m, shape (axles, F)."""
        spring = self.stiffness_N_per_m + 1j * omega * self.damping_Ns_per_m
        inertia = omega**2 * self._sprung_kg(loads_N)[:, None]
        of_axle = spring * inertia / (spring - inertia) + omega**2 * self.unsprung_kg
        return np.asarray(of_axle / (1.0 - of_axle / (self.contact_N_per_m or np.inf)))

    def decay_per_s(self, loads_N: Reals) -> float:
        """Rate at which the slowest mass comes to rest behind the line."""
        return float(0.5 * self.damping_Ns_per_m / max(self._sprung_kg(loads_N).max(), 1e-12))

    def _sprung_kg(self, loads_N: Reals) -> Reals:
        sprung = loads_N / STANDARD_GRAVITY - self.unsprung_kg
        if (sprung < 0.0).any():
            raise InputError(
                f"weighs more than a load of {loads_N.min():g} N",
                where="axles.suspension.unsprung_kg",
                value=self.unsprung_kg,
            )
        return np.asarray(sprung)


class PassingAxles(FrozenModel):
    """Axles that carry their loads along a body at the condition's speed.

    Parameters
    ----------
    loads_N : sequence of float
        Of each axle, of what the model carries: half of them on the model of one rail.
    lags_m : sequence of float
        Distance of each axle behind the first, from 0.
    load_factor : float
        On all loads.
    body : str
        A beam, or a row of beams without gaps, that the axles run on.
    entry_s : float
        When the first axle enters the stretch, on the clock of the records: their first sample is at 0 unless
        their files say otherwise.
    direction : "forward" or "backward"
        Towards larger or smaller x.
    from_m, to_m : float, optional
        The stretch; by default the ends of the body, or its first and last joint.
    ramp_m : float, optional
        Over which loads come on and go off at both ends; by default none at an end of the body, elsewhere a tenth
        of the stretch and at most 10 m.
    suspension : Suspension, optional
        With which the axles' forces follow the motion of the line; by default they are the loads.
    irregularity : irregularity, optional
        Unevenness that axles with a suspension meet, each at its time, as a model file names one.
    """

    loads_N: FloatTuple = Field(min_length=1)
    lags_m: FloatTuple
    load_factor: PositiveFloat = 1.0
    body: str
    entry_s: Number = 0.0
    direction: Literal["forward", "backward"] = "forward"
    from_m: Metres | None = None
    to_m: Metres | None = None
    ramp_m: float | None = Field(default=None, ge=0.0)
    suspension: Suspension | None = None
    irregularity: AnyIrregularity | None = None

    @model_validator(mode="after")
    def _check(self) -> PassingAxles:
        check_axles(self.lags_m, self.loads_N)
        if self.from_m is not None and self.to_m is not None and not self.from_m < self.to_m:
            raise fault(f"does not lie beyond from_m = {self.from_m:g}", "to_m", value=self.to_m)
        if self.irregularity is not None and self.suspension is None:
            raise fault("pushes axles that have a suspension: describe it", "irregularity")
        return self

    @property
    def loads(self) -> Reals:
        """Loads with their factor, N."""
        return self.load_factor * np.array(self.loads_N, dtype=np.float64)

    def arrivals_s(self, speed_m_per_s: float, start_m: float, stop_m: float) -> Reals:
        """When each axle is, or would be, at x = 0, s; running backward they come from `stop_m`."""
        ahead = -start_m if self.direction == "forward" else stop_m
        return self.entry_s + (np.array(self.lags_m, dtype=np.float64) + ahead) / speed_m_per_s
