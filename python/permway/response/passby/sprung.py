"""Vehicles as a march in time sees them: matrices, weights, and an exact step under forces that vary linearly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from pydantic import NonNegativeFloat, PositiveFloat

from permway.arrays import Reals
from permway.errors import InputError
from permway.model.vehicle import STANDARD_GRAVITY, Vehicle
from permway.records import FrozenModel


class SprungMass(FrozenModel):
    """One mass on one wheel; the simplest vehicle.

    Parameters
    ----------
    mass_kg : float
    stiffness_N_per_m, damping_Ns_per_m : float
        Of the suspension.
    wheel_mass_kg : float
        Small beside the mass, if the wheel is to be without inertia; it bounces on the contact spring.
    """

    mass_kg: PositiveFloat
    stiffness_N_per_m: PositiveFloat
    damping_Ns_per_m: NonNegativeFloat = 0.0
    wheel_mass_kg: PositiveFloat

    @property
    def degrees(self) -> list[str]:
        """Labels of the two degrees of freedom."""
        return ["mass", "wheel"]

    @property
    def wheel_indices(self) -> list[int]:
        """Place of the wheel among the degrees of freedom."""
        return [1]

    def lags_m(self) -> Reals:
        """One wheel, 0 m behind the first."""
        return np.zeros(1)

    def matrices(self) -> tuple[Reals, Reals, Reals]:
        """Mass, damping and stiffness, each (2, 2)."""
        tie = np.array([[1.0, -1.0], [-1.0, 1.0]])
        mass = np.diag([self.mass_kg, self.wheel_mass_kg])
        return mass, self.damping_Ns_per_m * tie, self.stiffness_N_per_m * tie


class MassOnSpring(FrozenModel):
    """A mass that the contact spring carries: a moving sprung mass without a wheel (Fryba; Yang and Yau).

    Parameters
    ----------
    mass_kg : float
    """

    mass_kg: PositiveFloat

    @property
    def degrees(self) -> list[str]:
        """Label of the degree of freedom."""
        return ["mass"]

    @property
    def wheel_indices(self) -> list[int]:
        """The mass touches the line itself, through the contact spring."""
        return [0]

    def lags_m(self) -> Reals:
        """One wheel, 0 m behind the first."""
        return np.zeros(1)

    def matrices(self) -> tuple[Reals, Reals, Reals]:
        """Mass, damping and stiffness, each (1, 1)."""
        return np.array([[self.mass_kg]]), np.zeros((1, 1)), np.zeros((1, 1))


AnyVehicle = Vehicle | SprungMass | MassOnSpring


@dataclass(frozen=True)
class Stepper:
    """One step of a free vehicle: state, then contact forces at its two ends, to the next state.

    y' = A y + G - B F with F linear over the step; all by the exponential of one matrix, so exact.

    Attributes
    ----------
    state : ndarray, shape (2 n, 2 n)
    before, after : ndarray, shape (2 n, wheels)
        Effect of the force at the beginning and at the end of the step.
    weight : ndarray, shape (2 n,)
        Effect of gravity.
    wheels : ndarray of int
    rest : ndarray, shape (2 n,)
        State on rigid ground.
    """

    state: Reals
    before: Reals
    after: Reals
    weight: Reals
    wheels: np.ndarray
    rest: Reals


def stepper(vehicle: AnyVehicle, contact_N_per_m: float, step_s: float) -> Stepper:
    """Build the step of a vehicle.

    Parameters
    ----------
    vehicle : Vehicle, SprungMass or MassOnSpring
    contact_N_per_m : float
        Under each wheelset; the state of rest leans on it.
    step_s : float

    Raises
    ------
    InputError
        For a step that the bounce of a wheel on its contact spring does not allow.
    """
    mass, damping, stiffness = vehicle.matrices()
    n = mass.shape[0]
    wheels = np.array(vehicle.wheel_indices)
    # Linear force in a step is Newmark's linear acceleration: stable below sqrt(12); a sixth of that is accurate.
    fastest = float(np.sqrt(np.max((contact_N_per_m + np.diag(stiffness)[wheels]) / np.diag(mass)[wheels])))
    if fastest * step_s > 0.6:
        raise InputError(
            f"wheels bounce on their contact at {fastest / (2.0 * np.pi):.4g} Hz, too fast for the step",
            where="step_s",
            value=step_s,
            remedy=f"at most {0.6 / fastest:.3g} s",
        )
    vertical = np.array([0.0 if name.endswith("pitch") else 1.0 for name in vehicle.degrees])
    load = STANDARD_GRAVITY * vertical * np.diag(mass)
    inverse = np.diag(1.0 / np.diag(mass))
    drive = np.zeros((2 * n, wheels.size + 1))
    drive[n:, 0] = inverse @ load
    drive[n + wheels, 1 + np.arange(wheels.size)] = -1.0 / np.diag(mass)[wheels]
    system = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ stiffness, -inverse @ damping]])
    columns = drive.shape[1]
    size = 2 * n
    whole = np.zeros((size + 2 * columns, size + 2 * columns))
    whole[:size, :size] = system * step_s
    whole[:size, size : size + columns] = drive * step_s
    whole[size : size + columns, size + columns :] = np.eye(columns)
    powers = scipy.linalg.expm(whole)
    constant, ramp = powers[:size, size : size + columns], powers[:size, size + columns :]
    on_ground = stiffness.copy()
    on_ground[wheels, wheels] += contact_N_per_m
    rest = np.concatenate([np.linalg.solve(on_ground, load), np.zeros(n)])
    return Stepper(
        state=powers[:size, :size],
        before=(constant - ramp)[:, 1:],
        after=ramp[:, 1:],
        weight=constant[:, 0],
        wheels=wheels,
        rest=rest,
    )
