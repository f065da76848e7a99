"""Which receptances a set of records needs, asked for in as few solves as can be."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from permway.arrays import Complexes, Reals
from permway.campaign.factors import Factors, model_under
from permway.errors import InputError
from permway.model.place import Place
from permway.problem.model import Model
from permway.response.receptance import between

Location = tuple[str, float]
"""Body and x in m."""

Key = tuple[float | None, Factors, bytes]
"""Temperature, factors on the model's numbers, and the frequencies as they stand in memory."""


@dataclass(frozen=True)
class Request:
    """Receptances between all of some places and all of others, at some frequencies, under one condition.

    Attributes
    ----------
    temperature_C : float or None
    frequency_Hz : ndarray, shape (F,)
        Ascending.
    rows, columns : tuple of (body, x)
        Where displacement is read and where the force acts; the line is reciprocal, so either may be the other.
    factors : tuple of (path, factor)
        Of the condition.
    """

    temperature_C: float | None
    frequency_Hz: Reals
    rows: tuple[Location, ...]
    columns: tuple[Location, ...]
    factors: Factors = ()

    @property
    def key(self) -> Key:
        """What needs that one sweep serves have in common."""
        return self.temperature_C, self.factors, self.frequency_Hz.tobytes()

    def is_like(self, other: Request) -> bool:
        """Whether another needs the same receptances."""
        return (self.key, self.rows, self.columns) == (other.key, other.rows, other.columns)


@dataclass(frozen=True)
class Sweep:
    """One call of the solver that serves several needs.

    Attributes
    ----------
    temperature_C : float or None
    frequency_Hz : ndarray, shape (F,)
    forces, sensors : tuple of Place
    factors : tuple of (path, factor)
    """

    temperature_C: float | None
    frequency_Hz: Reals
    forces: tuple[Place, ...]
    sensors: tuple[Place, ...]
    factors: Factors = ()

    @property
    def key(self) -> Key:
        """See :attr:`Request.state`."""
        return self.temperature_C, self.factors, self.frequency_Hz.tobytes()


@dataclass(frozen=True)
class Result:
    """A sweep and its receptances, m/N, shape (F, sensors, forces)."""

    sweep: Sweep
    receptance: Complexes

    def of(self, request: Request) -> Complexes:
        """Receptances of a need, shape (F, rows, columns).

        Raises
        ------
        InputError
            For a need of another state, or a pair that the sweep does not hold.
        """
        if request.key != self.sweep.key:
            raise InputError("is of another temperature, factor or frequency", where="need", value=request)
        held = [tuple((p.body, p.x_m) for p in places) for places in (self.sweep.sensors, self.sweep.forces)]
        sensor, force = _picks(request.rows, request.columns, *held)
        return np.asarray(self.receptance[:, sensor, force])


@lru_cache(maxsize=64)
def _picks(
    rows: tuple[Location, ...],
    columns: tuple[Location, ...],
    sensors: tuple[Location, ...],
    forces: tuple[Location, ...],
) -> tuple[np.ndarray, np.ndarray]:
    """Indices of sensor and of force for each pair, each of shape (rows, columns); the line is reciprocal.

    Raises
    ------
    InputError
        For a pair that is not held.
    """
    of_sensor, of_force = (
        {location: i for i, location in enumerate(locations)} for locations in (sensors, forces)
    )
    at = np.empty((2, len(rows), len(columns)), dtype=np.int64)
    for i, row in enumerate(rows):
        for j, column in enumerate(columns):
            if column in of_force and row in of_sensor:
                at[:, i, j] = of_sensor[row], of_force[column]
            elif row in of_force and column in of_sensor:
                at[:, i, j] = of_sensor[column], of_force[row]
            else:
                raise InputError("the pair is not in the sweep", where="sweep", value=(row, column))
    return at[0], at[1]


def plan(requests: Iterable[Request]) -> list[Sweep]:
    """One sweep for each temperature, each set of factors and each set of frequencies, which serves all its needs.

    A force costs a solve at every frequency, a sensor nearly nothing: of every need the shorter side becomes
    forces, and what pushes at other frequencies is solved by itself.
    """
    grouped: dict[Key, list[Request]] = {}
    for request in requests:
        grouped.setdefault(request.key, []).append(request)
    sweeps = []
    for members in grouped.values():
        forces: dict[Location, None] = {}
        sensors: dict[Location, None] = {}
        for request in members:
            few, many = sorted((request.rows, request.columns), key=len)
            forces.update(dict.fromkeys(few))
            sensors.update(dict.fromkeys(many))
        one = members[0]
        sweeps.append(
            Sweep(one.temperature_C, one.frequency_Hz, places_of(forces), places_of(sensors), one.factors)
        )
    return sweeps


def solve(sweep: Sweep, model: Model, *, threads: int | None = None) -> Result:
    """The receptances of a sweep, of the model under the sweep's factors.

    Raises
    ------
    InputError, SolveError
        As :func:`permway.response.receptance.receptance`.
    """
    model = model_under(model, sweep.factors)
    solved = between(
        model.line,
        sweep.frequency_Hz,
        forces=sweep.forces,
        sensors=sweep.sensors,
        temperature_C=sweep.temperature_C,
        formulation=model.formulation,
        threads=threads,
    )
    return Result(sweep, solved.receptance)


def places_of(locations: Iterable[Location]) -> tuple[Place, ...]:
    """Places for the solver, numbered: sensors of a campaign may share one, and have names of their own."""
    return _numbered(tuple(locations))


# A search asks for the same ones thousands of times.
@lru_cache(maxsize=64)
def _numbered(locations: tuple[Location, ...]) -> tuple[Place, ...]:
    return tuple(Place(body=body, x_m=x, name=str(i)) for i, (body, x) in enumerate(locations))
