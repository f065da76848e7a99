"""Loads of axles on springs: they follow how the line moves under them, and the line moves as they push.

F_w = P_w + K u_w, with K the answer of a suspension to its axle's motion and u_w the line's displacement under it,
which the forces of all axles cause. That is linear in what forces are more than loads, over all times together
(Fryba 1999, Vibration of Solids and Structures under Moving Loads, chapter 8; Saad and Schultz 1986, SIAM J. Sci.
Stat. Comput. 7, 856-869, for the solution).
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander
from scipy.sparse.linalg import LinearOperator, gmres

from permway.arrays import Complexes, Reals
from permway.errors import InputError, SolveError
from permway.recordings.passing_axles import PassingAxles
from permway.response.passby.carry import carried, points_needed
from permway.response.passby.path import Path

SETTLED, TURNS = 1e-12, 200
"""Share of what forces are more than loads at which the solution ends, and products at most: fits difference
predictions at parameters that are 1e-5 apart."""

AT_REST = 0.01
"""Share of its motion that a mass may still have when the periodic window begins anew. Windows are made for a
400th (:data:`permway.campaign.passage.DECAYS`), so that loads may grow by a quarter in a fit."""


def suspended(
    axles: PassingAxles,
    speed_m_per_s: float,
    path: Path,
    frequency_Hz: Reals,
    coefficients: Complexes,
    constant: Complexes,
) -> Complexes:
    """Moments of all forces, (F, panels, order), N s.

    Forces are sought at Gauss's points of the path, where each axle passes at a time of its own.

    Parameters
    ----------
    axles : PassingAxles
        With a suspension.
    speed_m_per_s : float
    path : Path
    frequency_Hz : ndarray, shape (F,)
        Of a periodic window, from 0 Hz on.
    coefficients : ndarray of complex128, shape (F, nodes, panels, order)
        Of the receptances from the path to its own nodes, m/N.
    constant : ndarray of complex128, shape (F, panels, order)
        Moments of the loads.

    Raises
    ------
    InputError
        For masses that do not come to rest within the window.
    SolveError
        If forces and motion do not settle.
    """
    assert axles.suspension is not None
    window = 1.0 / float(frequency_Hz[1])
    rest = window - (path.stop - path.start) / speed_m_per_s
    rate = axles.suspension.decay_per_s(axles.loads)
    if np.exp(-rate * rest) > AT_REST:
        raise InputError(
            f"lets axles bounce on for longer than the {rest:.3g} s that the window has",
            where="axles.suspension.damping_Ns_per_m",
            value=axles.suspension.damping_Ns_per_m,
            remedy=f"give the record window_s = {window - np.log(AT_REST) / rate - rest:.3g}, or more damping",
        )
    omega, step_Hz = 2.0 * np.pi * frequency_Hz, float(frequency_Hz[1])
    run = speed_m_per_s if axles.direction == "forward" else -speed_m_per_s
    inside, weight = leggauss(points_needed(path, float(omega[-1]), float(omega[-1]), speed_m_per_s))
    x = path.points(inside)
    seconds = (weight * path.half[:, None]).ravel() / speed_m_per_s
    basis = legvander(inside, path.order - 1)
    panel, between = path.interpolation(x.ravel())
    nodes = (panel * path.order)[:, None] + np.arange(path.order)
    along = np.exp(-1j * np.outer(omega, x.ravel() / run))
    late = np.exp(-1j * np.outer(omega, axles.arrivals_s(speed_m_per_s, path.start, path.stop)))
    answer = axles.suspension.answer(axles.loads, omega).T
    # Of a real signal the lines above 0 Hz count twice.
    line = step_Hz * np.where(omega > 0.0, 2.0, 1.0)[:, None]

    def moments(forces: Reals) -> Complexes:
        """Of forces of all axles at the points, (F, panels, order)."""
        imposed = along * (late @ (forces * seconds))
        return np.asarray(imposed.reshape(omega.size, *x.shape) @ basis)

    def at_points(spectra: Complexes) -> Reals:
        """From spectra of each axle at each point, (F, points), to what is there as it passes, (axles, points)."""
        return np.asarray((late.conj().T @ (line * along.conj() * spectra)).real)

    def pushed_back(of: Complexes) -> Reals:
        """What suspensions make of the line's motion by forces of these moments, (axles, points)."""
        moved = carried(coefficients, of)[0]
        under = at_points(np.einsum("gk,fgk->fg", between, moved[:, nodes]))
        pushed = answer * late * (along @ (under * seconds).T)
        return np.asarray(((late.conj() * line * pushed).T @ along.conj()).real)

    more = pushed_back(constant)
    left = LinearOperator(
        (more.size, more.size),
        matvec=lambda f: f - pushed_back(moments(f.reshape(more.shape))).ravel(),
        dtype=np.float64,
    )
    forces, failed = gmres(left, more.ravel(), rtol=SETTLED, restart=TURNS, maxiter=1)
    if failed:
        raise SolveError("forces of suspended axles and the motion of the line under them do not settle")
    return np.asarray(constant + moments(forces.reshape(more.shape)))
