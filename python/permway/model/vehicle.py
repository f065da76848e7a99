"""A vehicle in its vertical plane: ten degrees of freedom a car, any number of cars."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field, NonNegativeFloat, PositiveFloat, model_validator

from permway.arrays import Complexes, Reals, check_frequency
from permway.errors import InputError
from permway.model import vehicle_car as car
from permway.model.vehicle_additions import AnyAddition, attached_mass_kg, check_additions
from permway.model.vehicle_condensed import Condensed, condensed
from permway.records import FrozenModel

STANDARD_GRAVITY = 9.80665


class Vehicle(FrozenModel):
    """A train of equal cars, each a body on two bogies on four wheelsets (paper, equation (2)).

    Displacement is positive down; a pitch is positive when the leading end goes down. Cars are not coupled
    to each other. The leading car is car 1; bogie 1 and wheelset 1 lead.

    Parameters
    ----------
    car_body_mass_kg, bogie_mass_kg, wheelset_mass_kg : float
        Of the whole body, one bogie frame, one wheelset, kg.
    car_body_inertia_kg_m2, bogie_inertia_kg_m2 : float
        Pitch inertia of the body and of one bogie frame, kg m^2.
    primary_stiffness_N_per_m, primary_damping_Ns_per_m : float
        Of both sides together, per wheelset: twice the spring of one axle box.
    secondary_stiffness_N_per_m, secondary_damping_Ns_per_m : float
        Of both sides together, per bogie: twice the spring of one side.
    bogie_distance_m, wheelbase_m, car_length_m : float
        Between bogie centres; between a bogie's axles; from a car's first wheel to the next car's.
    cars : int
        Number of cars.
    share : float
        Share of everything that the model carries: 1 for the whole vehicle on two rails, 0.5 for the half
        model on one rail.
    additions : sequence of Resonator, FlexibleMode, DamperSeries, AirSpring and Slider
        What the ten degrees do not hold, the same in every car; see :mod:`permway.model.vehicle_additions`. They
        act in the dynamic stiffness over frequency. Matrices, natural frequencies and poles are refused with
        them, and with the matrices every march in time.

    Raises
    ------
    InputError
        For a value out of its range, and for axles that would overlap.
    """

    car_body_mass_kg: PositiveFloat
    bogie_mass_kg: PositiveFloat
    wheelset_mass_kg: PositiveFloat
    car_body_inertia_kg_m2: PositiveFloat
    bogie_inertia_kg_m2: PositiveFloat
    primary_stiffness_N_per_m: PositiveFloat
    primary_damping_Ns_per_m: NonNegativeFloat
    secondary_stiffness_N_per_m: PositiveFloat
    secondary_damping_Ns_per_m: NonNegativeFloat
    bogie_distance_m: PositiveFloat = 17.5
    wheelbase_m: PositiveFloat = 2.5
    car_length_m: PositiveFloat = 25.0
    cars: int = Field(default=1, ge=1, le=100)
    share: float = Field(default=1.0, gt=0.0, le=1.0)
    additions: tuple[AnyAddition, ...] = ()

    @model_validator(mode="after")
    def _check_additions(self) -> Vehicle:
        check_additions(self.additions)
        return self

    @model_validator(mode="after")
    def _check_axles(self) -> Vehicle:
        if self.wheelbase_m >= self.bogie_distance_m:
            raise ValueError(
                f"wheelbase_m = {self.wheelbase_m:g} is not below bogie_distance_m = "
                f"{self.bogie_distance_m:g}: the bogies would overlap"
            )
        if self.cars > 1 and self.car_length_m <= self.bogie_distance_m + self.wheelbase_m:
            raise ValueError(
                f"car_length_m = {self.car_length_m:g} does not exceed the {self.bogie_distance_m:g} + "
                f"{self.wheelbase_m:g} m between a car's outer axles: the cars would overlap"
            )
        return self

    @property
    def degrees(self) -> list[str]:
        """Labels of the 10 n degrees of freedom, as "car1.body.bounce" or "car2.wheelset3"."""
        return [f"car{index + 1}.{degree}" for index in range(self.cars) for degree in car.DEGREES]

    @property
    def wheel_indices(self) -> list[int]:
        """Places of the 4 n wheelsets among the degrees of freedom, leading wheel first."""
        wheels = range(car.N)[car.WHEELS]
        return [car.N * index + wheel for index in range(self.cars) for wheel in wheels]

    @property
    def static_wheel_load_N(self) -> float:
        """Weight on one of the eight wheels of a car, N, whatever the share; resonators' is spread evenly."""
        mass = self.car_body_mass_kg + 2.0 * self.bogie_mass_kg + 4.0 * self.wheelset_mass_kg
        mass += attached_mass_kg(self.additions)
        return mass * STANDARD_GRAVITY / 8.0

    def lags_m(self) -> Reals:
        """Distance (m) of each wheel behind the first, shape (4 n,), ascending (paper, equation (18))."""
        own = np.array([0.0, self.wheelbase_m, self.bogie_distance_m, self.bogie_distance_m + self.wheelbase_m])
        return np.concatenate([own + index * self.car_length_m for index in range(self.cars)])

    def wheel_positions_m(self) -> Reals:
        """Positions x (m) of the wheels about the middle of the train, shape (4 n,), wheel 1 foremost.

        The train runs towards +x; first and last wheel lie as far from x = 0.
        """
        lags = self.lags_m()
        return np.asarray(0.5 * lags[-1] - lags)

    def stretches(self, suspension: Literal["primary", "secondary"]) -> Reals:
        """Rows that give each suspension's compression from the degrees, shape (4 n or 2 n, 10 n), 1 and m."""
        secondary, primary = self._stretches()
        return np.asarray(np.kron(np.eye(self.cars), primary if suspension == "primary" else secondary))

    def matrices(self) -> tuple[Reals, Reals, Reals]:
        """Mass, damping and stiffness matrices, each (10 n, 10 n) (paper, equation (2)).

        Rows in kg, N s/m, N/m for a displacement and times m (m^2) for a pitch.

        Raises
        ------
        InputError
            For a vehicle with additions.
        """
        self._check_rigid()
        mass, damping, stiffness = (
            np.asarray(np.kron(np.eye(self.cars), matrix), dtype=np.float64) for matrix in self._car_matrices()
        )
        return mass, damping, stiffness

    def dynamic_stiffness(self, frequency_Hz: ArrayLike) -> Complexes:
        """Dynamic stiffness K + i omega C - omega^2 M of the free vehicle, and what is added to it.

        Parameters
        ----------
        frequency_Hz : array_like, shape (F,)
            Finite and above zero.

        Returns
        -------
        ndarray of complex128, shape (F, 10 n, 10 n)

        Raises
        ------
        InputError
            For a frequency that is not finite and positive.
        """
        return _blocks(self._condensed(frequency_Hz).stiffness, self.cars)

    def wheel_receptance(self, frequency_Hz: ArrayLike) -> Complexes:
        """Displacement of the wheels per force on the wheels, both positive down, the rail taken away.

        Equation (3) of the paper, its matrix for all wheels; wheels of different cars do not feel each
        other.

        Parameters
        ----------
        frequency_Hz : array_like, shape (F,)
            Finite and above zero.

        Returns
        -------
        ndarray of complex128, shape (F, 4 n, 4 n)
            m/N.

        Raises
        ------
        InputError
            For a frequency that is not finite and positive.
        """
        return _blocks(self._car_per_force(frequency_Hz)[1], self.cars)

    def per_wheel_force(self, frequency_Hz: ArrayLike) -> tuple[Complexes, Complexes]:
        """Displacement of every degree of freedom, and of the contacts, per force on each wheel, positive down.

        The two are alike in the wheels' rows, but for wheelsets that bend: their boxes are the degrees.

        Parameters
        ----------
        frequency_Hz : array_like, shape (F,)
            Finite and above zero.

        Returns
        -------
        degrees, contacts : ndarray of complex128, shapes (F, 10 n, 4 n) and (F, 4 n, 4 n)
            m/N and rad/N.

        Raises
        ------
        InputError
            For a frequency that is not finite and positive.
        """
        degrees, contacts = self._car_per_force(frequency_Hz)
        return _blocks(degrees, self.cars), _blocks(contacts, self.cars)

    def response_to_wheel_force(self, frequency_Hz: ArrayLike, force_N: ArrayLike) -> Complexes:
        """Displacement of every degree of freedom under forces on the wheels.

        Parameters
        ----------
        frequency_Hz : array_like, shape (F,)
            Finite and above zero.
        force_N : array_like, shape (F, 4 n)
            Complex amplitudes on the wheels, positive down. A wheel-rail force in compression pushes the
            wheel up: hand over its negative.

        Returns
        -------
        ndarray of complex128, shape (F, 10 n)
            m and rad per unit of `force_N`, labelled by :attr:`degrees`.

        Raises
        ------
        InputError
            For a frequency that is not finite and positive, a force of another shape or not finite.
        """
        response, _ = self._car_per_force(frequency_Hz)
        force = np.asarray(force_N, dtype=np.complex128)
        expected = (response.shape[0], 4 * self.cars)
        if force.shape != expected:
            raise InputError(
                f"shape {force.shape} does not fit {expected[0]} frequencies and {expected[1]} wheels",
                where="force_N",
                remedy=f"give an array of shape {expected}",
            )
        if not np.isfinite(force).all():
            raise InputError("contains values that are not finite", where="force_N")
        by_car = force.reshape(expected[0], self.cars, 4)
        displacement = np.einsum("fij,fcj->fci", response, by_car).reshape(expected[0], -1)
        return np.asarray(displacement, dtype=np.complex128)

    def natural_frequencies_Hz(self, on_contact: float | None = None) -> Reals:
        """Undamped natural frequencies, ascending.

        Parameters
        ----------
        on_contact : float, optional
            None: the free vehicle, with four modes a car at exactly 0 Hz (bounce and pitch of the whole, and
            each bogie turning with its wheelsets). A number: the stiffness (N/m) of a spring between each
            wheelset of the model and the ground. Infinity: wheelsets held fast.

        Returns
        -------
        ndarray of float64, shape (10 n,), or (6 n,) with wheelsets held fast
            Hz.

        Raises
        ------
        InputError
            For a contact stiffness that is not above zero, and for a vehicle with additions.
        """
        found = car.natural_frequencies_Hz(self._car_on(on_contact), free=on_contact is None)
        return np.sort(np.tile(found, self.cars))

    def damped_poles(self, on_contact: float | None = None) -> Complexes:
        """Poles s of s^2 M + s C + K, rad/s, by ascending modulus.

        Parameters
        ----------
        on_contact : float, optional
            As in :meth:`natural_frequencies_Hz`. Without it the free modes are double poles at zero, which
            come out to about the root of the rounding error.

        Returns
        -------
        ndarray of complex128, shape (20 n,), or (12 n,) with wheelsets held fast
            In conjugate pairs, or real where a mode is over-damped.

        Raises
        ------
        InputError
            For a contact stiffness that is not above zero, and for a vehicle with additions.
        """
        poles = np.tile(car.damped_poles(self._car_on(on_contact)), self.cars)
        return poles[np.lexsort((poles.imag, np.abs(poles)))]

    def _check_rigid(self) -> None:
        if self.additions:
            raise InputError(
                "has parts that no mass, damping and stiffness matrix holds",
                where="vehicle.additions",
                value=[addition.type for addition in self.additions],
                remedy="compute over frequency, or take the additions out",
            )

    def _car_masses(self) -> Reals:
        bogie = [self.bogie_mass_kg, self.bogie_inertia_kg_m2]
        masses = [self.car_body_mass_kg, self.car_body_inertia_kg_m2, *bogie, *bogie]
        return np.array([*masses, *[self.wheelset_mass_kg] * 4])

    def _car_matrices(self) -> car.Matrices:
        mass = np.diag(self._car_masses())
        secondary, primary = self._stretches()
        secondary, primary = secondary.T @ secondary, primary.T @ primary
        damping = self.secondary_damping_Ns_per_m * secondary + self.primary_damping_Ns_per_m * primary
        stiffness = self.secondary_stiffness_N_per_m * secondary + self.primary_stiffness_N_per_m * primary
        return self.share * mass, self.share * damping, self.share * stiffness

    def _stretches(self) -> tuple[Reals, Reals]:
        return car.stretches(self.bogie_distance_m, self.wheelbase_m)

    def _car_on(self, on_contact: float | None) -> car.Matrices:
        self._check_rigid()
        return car.on_contact(self._car_matrices(), on_contact)

    def _condensed(self, frequency_Hz: ArrayLike) -> Condensed:
        omega = 2.0 * np.pi * np.atleast_1d(check_frequency(frequency_Hz))
        if omega.ndim != 1:
            raise InputError("must have one dimension", where="frequency_Hz", value=omega.shape)
        if self.additions:
            springs = (self.secondary_stiffness_N_per_m, self.primary_stiffness_N_per_m)
            dashpots = (self.secondary_damping_Ns_per_m, self.primary_damping_Ns_per_m)
            masses, stretches = self._car_masses(), self._stretches()
            whole = condensed(omega, masses, stretches, springs, dashpots, self.additions)
            return Condensed(self.share * whole.stiffness, whole.push, whole.give / self.share)
        mass, damping, stiffness = self._car_matrices()
        push = np.broadcast_to(np.eye(car.N, dtype=np.complex128)[:, car.WHEELS], (omega.size, car.N, 4))
        give = np.zeros((omega.size, 4, 4), dtype=np.complex128)
        omega = omega[:, None, None]
        return Condensed(np.asarray(stiffness + 1j * omega * damping - omega**2 * mass), push, give)

    def _car_per_force(self, frequency_Hz: ArrayLike) -> tuple[Complexes, Complexes]:
        """Of one car, (F, 10, 4) and (F, 4, 4)."""
        own = self._condensed(frequency_Hz)
        degrees = np.asarray(np.linalg.solve(own.stiffness, own.push), dtype=np.complex128)
        return degrees, np.swapaxes(own.push, 1, 2) @ degrees + own.give


def _blocks(block: Complexes, count: int) -> Complexes:
    """Block-diagonal matrices of `count` equal blocks, frequency by frequency."""
    return np.asarray(np.kron(np.eye(count)[None], block), dtype=np.complex128)
