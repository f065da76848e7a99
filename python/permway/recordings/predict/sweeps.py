"""Which receptances a set of records needs, asked for in as few solves as can be."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.model.file import Model
from permway.recordings.campaign_factors import Factors, model_under
from permway.response.receptance import Place, receptance

Spot = tuple[str, float]
"""Body and x in m."""

State = tuple[float | None, Factors]
"""Temperature, and factors on the model's numbers."""


@dataclass(frozen=True)
class Need:
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
    rows: tuple[Spot, ...]
    columns: tuple[Spot, ...]
    factors: Factors = ()

    @property
    def state(self) -> State:
        """What needs that one sweep serves have in common."""
        return self.temperature_C, self.factors

    def is_like(self, other: Need) -> bool:
        """Whether another needs the same receptances."""
        alike = (self.state, self.rows, self.columns) == (other.state, other.rows, other.columns)
        return alike and np.array_equal(self.frequency_Hz, other.frequency_Hz)


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
    def state(self) -> State:
        """Temperature and factors."""
        return self.temperature_C, self.factors

    def lines(self, frequency_Hz: Reals) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
        """Places of frequencies in the sweep's.

        Raises
        ------
        InputError
            For a frequency that is not among them.
        """
        found = np.searchsorted(self.frequency_Hz, frequency_Hz)
        found = np.minimum(found, self.frequency_Hz.size - 1)
        if not np.array_equal(self.frequency_Hz[found], frequency_Hz):
            missing = frequency_Hz[self.frequency_Hz[found] != frequency_Hz]
            raise InputError("is not in the sweep", where="frequency_Hz", value=float(missing[0]))
        return found

    def picks(self, rows: Sequence[Spot], columns: Sequence[Spot]) -> tuple[Reals, Reals]:
        """Indices (sensor, force) into the answer for each pair, each of shape (rows, columns).

        Raises
        ------
        InputError
            For a pair that the sweep does not hold.
        """
        forces = {(p.body, p.x_m): i for i, p in enumerate(self.forces)}
        sensors = {(p.body, p.x_m): i for i, p in enumerate(self.sensors)}
        at = np.empty((2, len(rows), len(columns)), dtype=np.int64)
        for i, row in enumerate(rows):
            for j, column in enumerate(columns):
                if column in forces and row in sensors:
                    at[:, i, j] = sensors[row], forces[column]
                elif row in forces and column in sensors:
                    at[:, i, j] = sensors[column], forces[row]
                else:
                    raise InputError("the pair is not in the sweep", where="sweep", value=(row, column))
        return at[0], at[1]


@dataclass(frozen=True)
class Answer:
    """A sweep and its receptances, m/N, shape (F, sensors, forces)."""

    sweep: Sweep
    receptance: Complexes

    def of(self, need: Need) -> Complexes:
        """Receptances of a need, shape (F, rows, columns)."""
        lines = self.sweep.lines(need.frequency_Hz)
        sensor, force = self.sweep.picks(need.rows, need.columns)
        return np.asarray(self.receptance[lines[:, None, None], sensor[None], force[None]])


def plan(needs: Iterable[Need]) -> list[Sweep]:
    """One sweep for each temperature and each set of factors, which serves all needs.

    A force costs a solve, a sensor nearly nothing: of every need the shorter side becomes forces.
    """
    grouped: dict[State, list[Need]] = {}
    for need in needs:
        grouped.setdefault(need.state, []).append(need)
    sweeps = []
    for (temperature, factors), members in grouped.items():
        forces: dict[Spot, None] = {}
        sensors: dict[Spot, None] = {}
        for need in members:
            few, many = sorted((need.rows, need.columns), key=len)
            forces.update(dict.fromkeys(few))
            sensors.update(dict.fromkeys(many))
        frequency = np.unique(np.concatenate([need.frequency_Hz for need in members]))
        sweeps.append(Sweep(temperature, frequency, places_of(forces), places_of(sensors), factors))
    return sweeps


def solve(sweep: Sweep, model: Model, *, threads: int | None = None) -> Answer:
    """The receptances of a sweep, of the model under the sweep's factors.

    Raises
    ------
    InputError, SolveError
        As :func:`permway.response.receptance.receptance`.
    """
    model = model_under(model, sweep.factors)
    data = receptance(
        model.line,
        sweep.frequency_Hz,
        forces=sweep.forces,
        sensors=sweep.sensors,
        temperature_C=sweep.temperature_C,
        formulation=model.formulation,
        threads=threads,
    )
    return Answer(sweep, data["receptance"].values)


def places_of(spots: Iterable[Spot]) -> tuple[Place, ...]:
    """Places for the solver, named by what they are."""
    return tuple(Place(body=body, x_m=x, name=f"{body}@{x!r}") for body, x in spots)
