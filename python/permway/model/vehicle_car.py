"""One car of a train: its ten degrees of freedom, its suspensions, its modes."""

from __future__ import annotations

import math

import numpy as np
import scipy.linalg

from permway.arrays import Complexes, Reals
from permway.errors import InputError

DEGREES = (
    "body.bounce",
    "body.pitch",
    "bogie1.bounce",
    "bogie1.pitch",
    "bogie2.bounce",
    "bogie2.pitch",
    "wheelset1",
    "wheelset2",
    "wheelset3",
    "wheelset4",
)
N = len(DEGREES)
WHEELS = slice(6, 10)
_FREE = 1e-12
"""Squares under this share of the largest are the free vehicle's zeros in rounding, not slow modes."""

Matrices = tuple[Reals, Reals, Reals]
"""Mass, damping and stiffness."""


def stretches(bogie_distance_m: float, wheelbase_m: float) -> tuple[Reals, Reals]:
    """Rows that give each suspension's compression from the degrees of freedom.

    Returns
    -------
    secondary, primary : ndarray of float64, shapes (2, 10) and (4, 10)
        1 and m.
    """
    secondary, primary = np.zeros((2, N)), np.zeros((4, N))
    ahead = (1.0, -1.0)
    for bogie in range(2):
        bounce, pitch = 2 + 2 * bogie, 3 + 2 * bogie
        secondary[bogie, [0, 1, bounce]] = 1.0, 0.5 * ahead[bogie] * bogie_distance_m, -1.0
        for axle in range(2):
            wheel = 2 * bogie + axle
            primary[wheel, [bounce, pitch, 6 + wheel]] = 1.0, 0.5 * ahead[axle] * wheelbase_m, -1.0
    return secondary, primary


def on_contact(matrices: Matrices, contact_N_per_m: float | None) -> Matrices:
    """A car whose wheelsets stand on springs, or are held fast; free without a stiffness.

    Raises
    ------
    InputError
        For a contact stiffness that is not above zero.
    """
    mass, damping, stiffness = matrices
    if contact_N_per_m is None:
        return matrices
    if not contact_N_per_m > 0.0:
        raise InputError(
            "a contact stiffness must be above 0 N/m",
            where="on_contact",
            value=contact_N_per_m,
            remedy="None for the free vehicle, infinity for wheelsets held fast",
        )
    if math.isinf(contact_N_per_m):
        held = WHEELS.start
        return mass[:held, :held], damping[:held, :held], stiffness[:held, :held]
    wheels = np.arange(N)[WHEELS]
    stiffness = stiffness.copy()
    stiffness[wheels, wheels] += contact_N_per_m
    return mass, damping, stiffness


def natural_frequencies_Hz(matrices: Matrices, *, free: bool) -> Reals:
    """Undamped natural frequencies, Hz; those of a free car's rigid motion are exactly zero."""
    mass, _, stiffness = matrices
    squares = scipy.linalg.eigh(stiffness, mass, eigvals_only=True)
    if free:
        squares = np.where(squares < _FREE * squares[-1], 0.0, squares)
    return np.asarray(np.sqrt(squares) / (2.0 * np.pi))


def damped_poles(matrices: Matrices) -> Complexes:
    """Poles s of s^2 M + s C + K with a diagonal M, rad/s, in no order."""
    mass, damping, stiffness = matrices
    n = mass.shape[0]
    weight = np.diag(mass)[:, None]
    companion = np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness / weight, -damping / weight]])
    return np.linalg.eigvals(companion).astype(np.complex128)
