"""Forces of axles on springs: they follow how the line moves under them and what unevenness they meet.

F_w = P_w + K (u_w + r), with K the answer of a suspension to its axle's motion, r the unevenness where the axle is
and u_w the line's displacement under it, which the forces of all axles cause. That is linear in what forces are
more than loads, over all times together (Fryba 1999, Vibration of Solids and Structures under Moving Loads,
chapter 8; Saad and Schultz 1986, SIAM J. Sci. Stat. Comput. 7, 856-869, for the solution). Where an axle moves
slowly, a wave r pushes by r / (1/K - alpha), alpha the line's receptance there; here nothing is taken as slow.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

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

ROUGH = 1e-3
"""Share as SETTLED, of a force by unevenness, whose size is known far worse: with half of it a record's covariance
changes by 0.03 %, with twice by 0.6 %."""

FINER = 2.0
"""How much denser waves of the unevenness are than the stretch, and the bounce that axles bring to it, need: with
half of it a record's covariance changes by 5 %, with twice by 0.1 %."""

LEFT_OUT = 1e-6
"""Share of the mean square of forces by unevenness that is left out, of combinations of waves that add less: a
hundred times as much changes a record's covariance by 1e-7."""


@dataclass(frozen=True)
class Waves:
    """Profiles of an unevenness: real parts of amplitude times exp(i k s), s along the way of the axles.

    Attributes
    ----------
    wavenumber : ndarray, shape (waves,)
        rad/m.
    amplitude : ndarray of complex128, shape (waves, profiles)
        m.
    """

    wavenumber: Reals
    amplitude: Complexes

    @staticmethod
    def none() -> Waves:
        """No profile."""
        return Waves(np.zeros(0), np.zeros((0, 0), dtype=np.complex128))


class AxlesOnSprings:
    """Axles on their way over a line.

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

    Raises
    ------
    InputError
        For masses that do not come to rest within the window.
    """

    def __init__(
        self,
        axles: PassingAxles,
        speed_m_per_s: float,
        path: Path,
        frequency_Hz: Reals,
        coefficients: Complexes,
    ) -> None:
        _check_rest(axles, path, speed_m_per_s, 1.0 / float(frequency_Hz[1]))
        assert axles.suspension is not None
        self._axles, self._suspension, self._speed = axles, axles.suspension, speed_m_per_s
        self._highest_Hz, self._coefficients = float(frequency_Hz[-1]), coefficients
        omega, step_Hz = 2.0 * np.pi * frequency_Hz, float(frequency_Hz[1])
        run = speed_m_per_s if axles.direction == "forward" else -speed_m_per_s
        inside, weight = leggauss(points_needed(path, float(omega[-1]), float(omega[-1]), speed_m_per_s))
        x = path.points(inside)
        self._time: Reals = x.ravel() / run
        self._seconds: Reals = (weight * path.half[:, None]).ravel() / speed_m_per_s
        self._crossing_s = (path.stop - path.start) / speed_m_per_s
        self._basis, self._shape = legvander(inside, path.order - 1), (omega.size, *x.shape)
        panel, self._between = path.interpolation(x.ravel())
        self._nodes = (panel * path.order)[:, None] + np.arange(path.order)
        self._along: Complexes = np.exp(-1j * np.outer(omega, self._time))
        self._late: Complexes = np.exp(
            -1j * np.outer(omega, axles.arrivals_s(speed_m_per_s, path.start, path.stop))
        )
        self._answer: Complexes = self._suspension.answer(axles.loads, omega).T
        # Of a real signal the lines above 0 Hz count twice.
        self._line: Reals = step_Hz * np.where(omega > 0.0, 2.0, 1.0)[:, None]

    def carrying(self, constant: Complexes, profile: Waves) -> Complexes:
        """Moments of all forces, (F, panels, order), N s, from those of the loads, over a known profile.

        Raises
        ------
        SolveError
            If forces and motion do not settle.
        """
        imposed = self._pushed_back(constant) + self._on_rigid(profile).sum(axis=0)
        return np.asarray(constant + self._moments(self._settled(imposed, SETTLED)))

    def on(self, waves: Waves) -> Iterator[Complexes]:
        """Moments of the forces by each of some profiles alone, (F, panels, order), N s.

        Before the stretch axles run over the same unevenness on rigid ground.
        """
        for forces in self._on_rigid(waves):
            yield self._moments(self._settled(forces, ROUGH))

    def waves(self) -> Waves:
        """Profiles that independent normal coefficients add up to an irregularity; none where none is stated."""
        irregularity = self._axles.irregularity
        if irregularity is None:
            return Waves.none()
        memory_s = 1.0 / self._suspension.decay_per_s(self._axles.loads)
        step_Hz = 1.0 / (FINER * (self._crossing_s + memory_s))
        frequency: Reals = np.arange(1, int(self._highest_Hz / step_Hz) + 1, dtype=np.float64) * step_Hz
        shortest, longest = irregularity.valid_wavelength_m
        frequency = frequency[(frequency * shortest <= self._speed) & (frequency * longest >= self._speed)]
        if not frequency.size:
            return Waves.none()
        size = np.sqrt(irregularity.density(frequency, self._speed) * step_Hz)
        wavenumber = np.asarray(2.0 * np.pi * frequency / self._speed)
        forces = self._on_rigid(Waves(wavenumber, np.hstack([np.diag(size), -1j * np.diag(size)])))
        # Turned, coefficients stay independent; far fewer combinations of waves differ on the stretch.
        weighed = (np.sqrt(self._seconds) * forces).reshape(len(forces), -1)
        shown, turn = np.linalg.eigh(weighed @ weighed.T)
        kept = turn[:, np.cumsum(shown) > LEFT_OUT * shown.sum()]
        return Waves(wavenumber, size[:, None] * (kept[: size.size] - 1j * kept[size.size :]))

    def _on_rigid(self, waves: Waves) -> Reals:
        """Forces that profiles would cause on a rigid line, (profiles, axles, points)."""
        omega = np.asarray(waves.wavenumber * self._speed)
        answer = self._suspension.answer(self._axles.loads, omega)
        met = np.exp(1j * np.outer(self._time, omega))
        return np.asarray(((answer[:, None, :] * met) @ waves.amplitude).real.transpose(2, 0, 1))

    def _moments(self, forces: Reals) -> Complexes:
        """Of forces of all axles at the points, (F, panels, order)."""
        imposed = self._along * (self._late @ (forces * self._seconds))
        return np.asarray(imposed.reshape(self._shape) @ self._basis)

    def _at_points(self, spectra: Complexes) -> Reals:
        """From spectra of each axle at each point, (F, points), to what is there as it passes, (axles, points)."""
        return np.asarray((self._late.conj().T @ (self._line * self._along.conj() * spectra)).real)

    def _pushed_back(self, of: Complexes) -> Reals:
        """What suspensions make of the line's motion by forces of these moments, (axles, points)."""
        moved = carried(self._coefficients, of)[0]
        under = self._at_points(np.einsum("gk,fgk->fg", self._between, moved[:, self._nodes]))
        pushed = self._answer * self._late * (self._along @ (under * self._seconds).T)
        return np.asarray(((self._late.conj() * self._line * pushed).T @ self._along.conj()).real)

    def _settled(self, imposed: Reals, share: float) -> Reals:
        """Forces with what the line's motion under them adds, (axles, points)."""
        left = LinearOperator(
            (imposed.size, imposed.size),
            matvec=lambda f: f - self._pushed_back(self._moments(f.reshape(imposed.shape))).ravel(),
            dtype=np.float64,
        )
        forces, failed = gmres(left, imposed.ravel(), rtol=share, restart=TURNS, maxiter=1)
        if failed:
            raise SolveError("forces of suspended axles and the motion of the line under them do not settle")
        return np.asarray(forces.reshape(imposed.shape))


def _check_rest(axles: PassingAxles, path: Path, speed_m_per_s: float, window_s: float) -> None:
    """Refuse masses that still bounce when the periodic window begins anew."""
    assert axles.suspension is not None
    rest = window_s - (path.stop - path.start) / speed_m_per_s
    rate = axles.suspension.decay_per_s(axles.loads)
    if np.exp(-rate * rest) > AT_REST:
        raise InputError(
            f"lets axles bounce on for longer than the {rest:.3g} s that the window has",
            where="axles.suspension.damping_Ns_per_m",
            value=axles.suspension.damping_Ns_per_m,
            remedy=f"give the record window_s = {window_s - np.log(AT_REST) / rate - rest:.3g}, or more damping",
        )
