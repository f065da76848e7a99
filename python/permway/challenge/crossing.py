"""A train of several cars that runs over a line, integrated in time: wheels move, and may leave the rail.

Where the runs of a campaign have the train stand while the profile moves under it, here it moves: over spans and
fasteners, off one girder and onto the next. Losses are viscous, and are the hysteretic ones at one frequency.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from permway.challenge.beams import Reals
from permway.challenge.contact import Hertz
from permway.challenge.layout import Values
from permway.challenge.newmark import GAMMA, Marched, Meshed, line_matrices, train_matrices
from permway.challenge.plan import CONTACT_N_PER_M
from permway.challenge.track import Location
from permway.challenge.vehicle import GRAVITY, WHEELS, Arm, vehicle, wheel_load
from permway.challenge.wheels_on_rail import Rail
from permway.errors import InputError, SolveError

ROUNDS, CLOSE = 100, 1e-10
"""Of Newton's method in a step, and the compression (m) to which contacts agree."""

AT_REST = 1e-6
"""Change of a force over the load at which the train stands."""

PITCHING = (1, 3, 5)
"""Degrees of a car that have no weight."""


@dataclass(frozen=True)
class Consist:
    """A train of equal cars, half of each on one rail.

    Parameters
    ----------
    values : Values
        A sheet's; of the vehicle.
    cars : int
    car_m : float
        From one car's middle to the next.
    speed_m_per_s : float
    wheels_m : tuple of float, optional
        How far a car's four wheels are behind its first; by default as the sheet's wheelbase and bogies say.
    """

    values: Values
    cars: int
    car_m: float
    speed_m_per_s: float
    wheels_m: tuple[float, ...] | None = None

    @property
    def behind_m(self) -> Reals:
        """How far each wheel is behind the first, shape (4 cars,)."""
        v = self.values["vehicle"]
        own = (0.0, v["lt"], v["lc"], v["lc"] + v["lt"])
        one = np.array(own if self.wheels_m is None else self.wheels_m)
        return np.concatenate([one + car * self.car_m for car in range(self.cars)])


@dataclass(frozen=True)
class Crossing:
    """What a train did to a line.

    Attributes
    ----------
    times, front_m : ndarray, shape (N,)
        s; where the first wheel is.
    contact_force : ndarray, shape (N, wheels)
        N, with the load; 0 where a wheel has left the rail.
    displacement : ndarray, shape (N, sensors)
        m, down.
    axlebox : ndarray, shape (N, wheels)
        Accelerations of the wheelsets, m/s2, down.
    on_board : ndarray, shape (N, arms)
        Accelerations on board of the first car, m/s2.
    """

    times: Reals
    front_m: Reals
    contact_force: Reals
    displacement: Reals
    axlebox: Reals
    on_board: Reals


def cross(
    line: Meshed,
    train: Consist,
    *,
    from_m: float,
    to_m: float,
    leaves: bool = True,
    profile: Callable[[Reals], Reals] | None = None,
    sensors: Sequence[Location] = (),
    arms: Sequence[Arm] = (),
    step_s: float = 2.5e-4,
    viscous_at_Hz: float = 20.0,
    beams_at_Hz: Mapping[str, float] | None = None,
    gamma: float = GAMMA,
) -> Crossing:
    """Let a train run.

    Parameters
    ----------
    line : Mesh or ClosedMesh
        Its stiffnesses are taken at `viscous_at_Hz`. A mesh's rail ends where its elements do; round a ring a
        train may run as far as it likes, and x is where it is from the first station on.
    train : Consist
    from_m, to_m : float
        Of the first wheel. The train is at rest on the line at `from_m`, and has its speed at once.
    leaves : bool
        Hertz's contact, which wheels may leave; else a linear one, which holds them down.
    profile : callable, optional
        Of x (m): how much lower the rail's surface is, m.
    sensors : sequence of Location
        Places of nodes, whose deflections are wanted.
    arms : sequence of Arm
        Combinations of the first car's degrees, whose accelerations are wanted.
    step_s : float
    viscous_at_Hz : float
        Where viscous losses are the hysteretic ones.
    beams_at_Hz : mapping of str to float, optional
        The same of some bodies.
    gamma : float
        Of the steps, see :class:`permway.challenge.newmark.Marched`.

    Raises
    ------
    InputError
        If a wheel would run off the rail, or not at all.
    SolveError
        If a step's contacts are not found.
    """
    _check(train, from_m, to_m, step_s, viscous_at_Hz)
    rail = Rail(line)
    behind = train.behind_m
    for where, x in (("from_m", from_m - behind[-1]), ("to_m", to_m)):
        if not rail.ends[0] <= x <= rail.ends[1]:
            remedy = f"the rail goes from {rail.ends[0]:g} to {rail.ends[1]:g} m"
            raise InputError("runs a wheel off the rail", where=where, value=x, remedy=remedy)
    surface = profile or np.zeros_like
    law = _Contact(Hertz(wheel_load(train.values), CONTACT_N_PER_M), leaves)
    car = vehicle(train.values, CONTACT_N_PER_M)
    matrices = line_matrices(line, viscous_at_Hz=viscous_at_Hz, beams_at_Hz=beams_at_Hz)
    below = Marched(matrices, step_s, gamma)
    cars = Marched(train_matrices(car, train.cars), step_s, gamma)
    size = len(car.masses)
    wheels = np.array([size * number + wheel for number in range(train.cars) for wheel in WHEELS])
    weight = GRAVITY * cars.mass.diagonal()
    weight[[size * number + degree for number in range(train.cars) for degree in PITCHING]] = 0.0
    rail_gives, wheels_give = below.gives(rail.degrees), cars.gives(wheels)
    read = [line.at(location) for location in sensors]
    rows, still = car.rows(arms), np.zeros(line.size)
    # As many as fit, rounding forgiven.
    steps = int((to_m - from_m) / train.speed_m_per_s / step_s + 1e-6)
    times: Reals = step_s * np.arange(steps + 1, dtype=np.float64)
    front: Reals = np.asarray(from_m + train.speed_m_per_s * times)
    forces, displaced, velocities, on_board = (
        np.zeros((times.size, n)) for n in (wheels.size, len(read), wheels.size, len(rows))
    )
    force = _rest(below, cars, rail, law, wheels, weight, front[0] - behind, surface)
    for step in range(times.size):
        at = front[step] - behind
        under = rail.under(at)
        if step:
            free, hanging = below.free(still), cars.free(weight)
            pressed = under.gathered(rail_gives, rail.places)
            between = under.weigh(pressed) + wheels_give[:, wheels]
            left = hanging[wheels] - under.read(free) - surface(at)
            force = law.settle(left, between, forces[step - 1])
            below.go_on(free + force @ pressed)
            cars.go_on(hanging - force @ wheels_give)
        forces[step] = force
        displaced[step], velocities[step] = below.displaced[read], cars.velocities[wheels]
        on_board[step] = rows @ cars.velocities[:size]
    return Crossing(times, front, forces, displaced, velocities, on_board)


def _check(train: Consist, from_m: float, to_m: float, step_s: float, viscous_at_Hz: float) -> None:
    positive = {"step_s": step_s, "viscous_at_Hz": viscous_at_Hz, "train.speed_m_per_s": train.speed_m_per_s}
    for where, value in {**positive, "train.cars": train.cars, "train.car_m": train.car_m}.items():
        if not (np.isfinite(value) and value > 0):
            raise InputError("must be above zero", where=where, value=value)
    if not to_m > from_m:
        raise InputError("must lie before to_m", where="from_m", value=[from_m, to_m])


@dataclass(frozen=True)
class _Contact:
    """Whole force per compression from touch."""

    hertz: Hertz
    leaves: bool

    @property
    def rest(self) -> float:
        """Compression under the load, m."""
        return (1.5 if self.leaves else 1.0) * self.hertz.load_N / self.hertz.stiffness

    def force(self, compression: Reals) -> Reals:
        if self.leaves:
            return self.hertz.load_N + self.hertz.force(compression - self.rest)
        return np.asarray(self.hertz.stiffness * compression)

    def closing(self, force: Reals) -> Reals:
        """Compression under forces above zero."""
        share = np.maximum(force / self.hertz.load_N, 0.0)
        return np.asarray(self.rest * share ** (2.0 / 3.0 if self.leaves else 1.0))

    def slope(self, compression: Reals) -> Reals:
        if self.leaves:
            return np.asarray(self.hertz.stiffness * np.sqrt(np.maximum(compression / self.rest, 0.0)))
        return np.full(compression.shape, self.hertz.stiffness)

    def settle(self, left: Reals, gives: Reals, force: Reals) -> Reals:
        """Forces F of compressions `left` - `gives` F, by Newton's method."""
        compression = left - gives @ force
        for _ in range(ROUNDS):
            slope = self.slope(compression)
            off = compression - left + gives @ self.force(compression)
            by = np.linalg.solve(np.eye(left.size) + gives * slope, off)
            compression = compression - by
            if np.abs(by).max() < CLOSE:
                return self.force(compression)
        raise SolveError("the contacts of a step are not found; take a shorter step")


def _rest(
    line: Marched,
    cars: Marched,
    rail: Rail,
    law: _Contact,
    wheels: NDArray[np.int64],
    weight: Reals,
    at: Reals,
    surface: Callable[[Reals], Reals],
) -> Reals:
    """Line and cars as they are while the train stands; the forces between them."""
    held, under = splu(line.stiffness), rail.under(at)
    stiffness = cars.stiffness.toarray()
    others = np.setdiff1d(np.arange(weight.size), wheels)
    above = stiffness[np.ix_(others, others)]
    force = np.full(wheels.size, law.hertz.load_N)
    for _ in range(ROUNDS):
        line.displaced = held.solve(under.press(force, line.displaced.size))
        stands = under.read(line.displaced, force) + surface(at) + law.closing(force)
        hangs = np.linalg.solve(above, weight[others] - stiffness[np.ix_(others, wheels)] @ stands)
        cars.displaced = np.zeros(weight.size)
        cars.displaced[wheels], cars.displaced[others] = stands, hangs
        last, force = force, weight[wheels] - (stiffness @ cars.displaced)[wheels]
        if np.abs(force - last).max() < AT_REST * law.hertz.load_N:
            return force
    raise SolveError(f"the train at rest is not found in {ROUNDS} rounds; give another from_m")
