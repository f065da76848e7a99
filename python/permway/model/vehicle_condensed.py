"""Dynamic stiffness of a car with additions, what moves beside its ten degrees condensed into them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from permway.arrays import Complexes, Reals
from permway.model.vehicle_additions import (
    BODY,
    WHEELSETS,
    AirSpring,
    AnyAddition,
    DamperSeries,
    FlexibleMode,
    Resonator,
    Slider,
)


@dataclass(frozen=True, eq=False)
class Condensed:
    """A car as its ten degrees see it.

    Attributes
    ----------
    stiffness : ndarray of complex128, shape (F, n, n)
        Dynamic stiffness.
    push : ndarray of complex128, shape (F, n, wheels)
        Forces on the degrees per force on the contacts; turned over, what contacts move with the degrees.
    give : ndarray of complex128, shape (F, wheels, wheels)
        What contacts move per force on them while the degrees are held, m/N.
    """

    stiffness: Complexes
    push: Complexes
    give: Complexes


def condensed(
    omega: Reals,
    masses: Reals,
    stretches: tuple[Reals, Reals],
    springs: tuple[float, float],
    dashpots: tuple[float, float],
    additions: Sequence[AnyAddition],
) -> Condensed:
    """One whole car.

    A flexible mode q, scaled to 1 at the point y that is read, leaves the mass of its part at y - q and the other
    springs of the part, or the contact of a wheelset, at y + (shape - 1) q. Every q is then eliminated, which
    keeps what is passive passive.

    Parameters
    ----------
    omega : ndarray, shape (F,)
        rad/s.
    masses : ndarray, shape (n,)
        Of the rigid degrees.
    stretches : (ndarray, ndarray)
        Rows that give the compression of each secondary and of each primary suspension from the degrees.
    springs, dashpots : (float, float)
        Of one secondary and of one primary suspension, N/m and N s/m.
    additions : sequence of additions

    Returns
    -------
    Condensed
    """
    modes = [(mode, degree) for mode in additions if isinstance(mode, FlexibleMode) for degree in mode.at()]
    n, q = masses.size, len(modes)
    rigid = np.hstack([np.eye(n), np.zeros((n, q))])
    secondary, primary = (np.hstack([rows, np.zeros((rows.shape[0], q))]) for rows in stretches)
    modal = np.zeros(q)
    own = np.zeros(q, dtype=np.complex128)
    contacts = np.eye(n + q)[:, list(WHEELSETS)]
    for index, (mode, degree) in enumerate(modes):
        rigid[degree, n + index] = -1.0
        modal[index] = mode.modal_mass_kg
        own[index] = mode.modal_mass_kg * mode.spring()
        if degree in WHEELSETS:
            contacts[n + index, WHEELSETS.index(degree)] = mode.shape - 1.0
            continue
        held = secondary if degree == BODY else primary
        held[:, n + index] = (mode.shape - 1.0) * held[:, degree]
    mass = rigid.T @ (masses[:, None] * rigid) + np.diag(np.concatenate([np.zeros(n), modal]))
    stiffness = _suspensions(omega, springs, dashpots, additions)
    # In place: arrays of this size cost more to come by than to fill.
    whole = stiffness[0][:, None, None] * (secondary.T @ secondary)
    whole += stiffness[1][:, None, None] * (primary.T @ primary)
    if modes:
        whole += np.diag(np.concatenate([np.zeros(n), own]))
    whole.real -= omega[:, None, None] ** 2 * mass
    for addition in additions:
        if isinstance(addition, Resonator):
            degrees = list(addition.at())
            whole[:, degrees, degrees] += addition.stiffness(omega)[:, None]
    if not modes:
        push = np.broadcast_to(contacts.astype(np.complex128), (omega.size, *contacts.shape))
        give = np.zeros((omega.size, len(WHEELSETS), len(WHEELSETS)), dtype=np.complex128)
        return Condensed(whole, push, give)
    pushed = np.broadcast_to(contacts[n:], (omega.size, q, len(WHEELSETS)))
    out = np.linalg.solve(whole[:, n:, n:], np.concatenate([whole[:, n:, :n], pushed], axis=2))
    return Condensed(
        stiffness=np.asarray(whole[:, :n, :n] - whole[:, :n, n:] @ out[:, :, :n]),
        push=np.asarray(contacts[:n] - whole[:, :n, n:] @ out[:, :, n:]),
        give=np.asarray(contacts[n:].T @ out[:, :, n:]),
    )


def _suspensions(
    omega: Reals, springs: tuple[float, float], dashpots: tuple[float, float], additions: Sequence[AnyAddition]
) -> list[Complexes]:
    """Complex stiffness of one secondary and of one primary suspension, N/m, each (F,)."""
    found = []
    for name, spring, dashpot in zip(("secondary", "primary"), springs, dashpots, strict=True):
        sliders = [a for a in additions if isinstance(a, Slider) and a.suspension == name]
        elastic = np.full(omega.size, spring, dtype=np.complex128)
        viscous = 1j * omega * (0.0 if any(slider.alone for slider in sliders) else dashpot)
        for addition in additions:
            if isinstance(addition, DamperSeries) and addition.suspension == name:
                viscous = viscous / (1.0 + viscous / addition.stiffness_N_per_m)
            elif isinstance(addition, AirSpring) and name == "secondary":
                late = 1j * omega / (2.0 * np.pi * addition.transition_Hz)
                elastic = elastic * (1.0 + addition.rise * late / (1.0 + late))
        slid = sum(slider.damping_Ns_per_m for slider in sliders)
        found.append(elastic + viscous + 1j * omega * slid)
    return found
