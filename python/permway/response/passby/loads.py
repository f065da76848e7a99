"""What passes: axles with their static loads, at a constant speed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from pydantic import Field, field_validator, model_validator

from permway.arrays import Reals
from permway.errors import InputError
from permway.model.faults import fault
from permway.model.irregularity_spectra import check_speed
from permway.model.train import Train
from permway.records import FloatTuple, FrozenModel, Number

_HSLM_A: tuple[tuple[int, float, float, float], ...] = (
    (18, 18.0, 2.0, 170.0),
    (17, 19.0, 3.5, 200.0),
    (16, 20.0, 2.0, 180.0),
    (15, 21.0, 3.0, 190.0),
    (14, 22.0, 2.0, 170.0),
    (13, 23.0, 2.0, 180.0),
    (13, 24.0, 2.0, 190.0),
    (12, 25.0, 2.5, 190.0),
    (11, 26.0, 2.0, 210.0),
    (11, 27.0, 2.0, 210.0),
)
"""(intermediate coaches N, coach length D in m, bogie axle spacing d in m, load P in kN) of A1 to A10."""

_POWER_CAR_M = (0.0, 3.0, 14.0, 17.0)
_COUPLING_M = 3.525
"""From a power car's last axle to the end coach's first."""


def check_axles(lags_m: Sequence[float], loads_N: Sequence[float]) -> None:
    """Refuse axles that do not go with their loads or do not stand behind each other, with their places."""
    if len(lags_m) != len(loads_N):
        raise fault(f"{len(loads_N)} loads for {len(lags_m)} axles: they go in pairs", "loads_N")
    for index, load in enumerate(loads_N):
        if not load > 0.0:
            raise fault("a load must be above 0 N: positive is down", "loads_N", index, value=load)
    if lags_m[0] != 0.0:
        raise fault("the first axle is 0 m behind itself", "lags_m", 0, value=lags_m[0])
    for index, (ahead, behind) in enumerate(pairwise(lags_m)):
        if not behind > ahead:
            what = f"does not lie behind the axle before it, at {ahead:g} m: sort them"
            raise fault(what, "lags_m", index + 1, value=behind)


class Axles(FrozenModel):
    """Axles that carry constant loads along a body towards +x.

    Parameters
    ----------
    lags_m : sequence of float
        Distance of each axle behind the first, from 0, ascending, m.
    loads_N : sequence of float
        Static load of each, positive down, N.
    speed_m_per_s : float
    body : str
        The body that the wheels run on.
    """

    lags_m: FloatTuple = Field(min_length=1)
    loads_N: FloatTuple
    speed_m_per_s: Number
    body: str = "rail"

    @field_validator("speed_m_per_s")
    @classmethod
    def _check_speed(cls, speed: float) -> float:
        try:
            return check_speed(speed)
        except InputError as error:
            raise fault(f"{error.what}: {error.remedy}", value=speed) from error

    @model_validator(mode="after")
    def _check(self) -> Axles:
        check_axles(self.lags_m, self.loads_N)
        return self

    @property
    def lags(self) -> Reals:
        """Distances behind the first axle, m."""
        return np.array(self.lags_m, dtype=np.float64)

    @property
    def loads(self) -> Reals:
        """Loads, N."""
        return np.array(self.loads_N, dtype=np.float64)


def static_axles(train: Train) -> Axles:
    """The static loads of a train's wheelsets, of the share that the model carries."""
    vehicle = train.vehicle
    lags = vehicle.lags_m()
    load = 2.0 * vehicle.share * vehicle.static_wheel_load_N
    return Axles(
        lags_m=tuple(float(x) for x in lags),
        loads_N=(load,) * lags.size,
        speed_m_per_s=train.speed_m_per_s,
        body=train.body,
    )


def hslm_a(number: int, *, speed_m_per_s: float, body: str = "rail", share: float = 1.0) -> Axles:
    """Train A1 to A10 of the high speed load model (EN 1991-2, Table 6.3 and Figure 6.12).

    Two power cars of four axles (3, 11 and 3 m apart), 3.525 m to the bogie of an end coach, bogies every D
    from there, one under each joint of coaches: 2 N + 14 axles. Written from knowledge of the standard, not
    compared with its print.

    Parameters
    ----------
    number : int
        1 to 10.
    speed_m_per_s : float
    body : str
        The body that the wheels run on.
    share : float
        Factor on the loads: 0.5 for the half model on one rail.

    Raises
    ------
    InputError
        For another number or share, and a speed out of range.
    """
    if isinstance(number, bool) or not isinstance(number, int) or not 1 <= number <= len(_HSLM_A):
        raise InputError("HSLM-A has trains 1 to 10", where="number", value=number)
    if not (math.isfinite(share) and 0.0 < share <= 1.0):
        raise InputError("a share must be above 0 and at most 1", where="share", value=share)
    coaches, length, wheelbase, load = _HSLM_A[number - 1]
    power = np.array(_POWER_CAR_M)
    first = power[-1] + _COUPLING_M
    bogies = first + length * np.arange(coaches + 3)
    train = np.concatenate([power, np.sort(np.concatenate([bogies, bogies + wheelbase]))])
    lags = np.concatenate([train, train[-1] + _COUPLING_M + power])
    return Axles(
        lags_m=tuple(float(x) for x in lags),
        loads_N=(1e3 * load * share,) * lags.size,
        speed_m_per_s=speed_m_per_s,
        body=body,
    )
