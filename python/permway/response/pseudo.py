"""Pseudo-excitation: random response as the deterministic one to sqrt(density) under each wheel.

All wheels meet the same profile, the later ones later, so the excitation is fully coherent and one complex
vector stands for its whole cross-spectral matrix (paper, section 2.4).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from permway.arrays import Complexes, Reals, check_frequency, real_numbers
from permway.errors import InputError, SolveError
from permway.model.irregularity_spectra import check_speed

WORST_CONDITION = 1e14
"""Condition number (1-norm) above which a solution has no digit left."""


def pseudo_excitation(
    frequency_Hz: ArrayLike, density: ArrayLike, lags_m: ArrayLike, speed_m_per_s: float
) -> Complexes:
    """Pseudo-excitation under each wheel, exp(-i omega lag / V) sqrt(S) (paper, equation (18)).

    Parameters
    ----------
    frequency_Hz : array_like, shape (F,)
        Finite and above zero.
    density : array_like, shape (F,)
        One-sided density of the profile, m^2/Hz, not negative.
    lags_m : array_like, shape (n,)
        Distance of each wheel behind the first, m.
    speed_m_per_s : float
        Speed of the train V.

    Returns
    -------
    ndarray of complex128, shape (F, n)
        m/sqrt(Hz), positive down like the profile.

    Raises
    ------
    InputError
        For a value that is not finite, a negative density, shapes that do not fit, a speed out of range.
    """
    frequency = np.atleast_1d(check_frequency(frequency_Hz))
    speed = check_speed(speed_m_per_s)
    values = np.atleast_1d(_floats(density, "density"))
    lags = np.atleast_1d(_floats(lags_m, "lags_m"))
    if frequency.ndim != 1 or values.shape != frequency.shape:
        raise InputError(
            f"shape {values.shape} does not fit the frequencies' {frequency.shape}",
            where="density",
            remedy="one value for each frequency",
        )
    if (values < 0.0).any():
        index = int(np.flatnonzero(values < 0.0)[0])
        raise InputError(
            "a density cannot be negative",
            where=f"density[{index}], at {frequency[index]:g} Hz",
            value=float(values[index]),
        )
    delay = np.exp(-2j * np.pi * frequency[:, None] * lags[None, :] / speed)
    return np.asarray(delay * np.sqrt(values)[:, None])


def wheel_rail_forces(
    wheel_receptance: ArrayLike,
    track_receptance: ArrayLike,
    contact_receptance: ArrayLike,
    excitation: ArrayLike,
    *,
    frequency_Hz: ArrayLike | None = None,
) -> Complexes:
    """Wheel-rail forces P = -(B_wheel + B_track + I B_contact)^-1 R (paper, equation (19)).

    Parameters
    ----------
    wheel_receptance, track_receptance : array_like, shape (F, n, n)
        Displacement at the contacts per force there, m/N, all positive down.
    contact_receptance : array_like, scalar or shape (F,)
        Flexibility of one contact spring, m/N.
    excitation : array_like, shape (F, n)
        Profile R under each wheel, positive down.
    frequency_Hz : array_like, shape (F,), optional
        Only to name the frequency in an error.

    Returns
    -------
    ndarray of complex128, shape (F, n)
        Compressive force beyond the static one: it pushes the rail down and the wheel up. A dip (R > 0)
        unloads a stiff contact, hence the sign. Displacements of the track are B_track P, of the wheels
        -B_wheel P.

    Raises
    ------
    InputError
        For shapes that do not fit.
    SolveError
        For receptances that are not finite, or whose sum is singular or worse conditioned than
        :data:`WORST_CONDITION`, with the frequency.
    """
    wheel = np.asarray(wheel_receptance, dtype=np.complex128)
    track = np.asarray(track_receptance, dtype=np.complex128)
    contact = np.asarray(contact_receptance, dtype=np.complex128)
    profile = np.asarray(excitation, dtype=np.complex128)
    if wheel.ndim != 3 or wheel.shape[1] != wheel.shape[2]:
        raise InputError(f"shape {wheel.shape} is not (F, n, n)", where="wheel_receptance")
    count, n = wheel.shape[:2]
    for name, array, expected in (
        ("track_receptance", track, (count, n, n)),
        ("excitation", profile, (count, n)),
        ("contact_receptance", contact, () if contact.ndim == 0 else (count,)),
    ):
        if array.shape != expected:
            raise InputError(
                f"shape {array.shape} does not fit {count} frequencies and {n} wheels",
                where=name,
                remedy=f"give an array of shape {expected}",
            )
    at = _namer(frequency_Hz, count)
    springs = np.broadcast_to(contact, (count,))[:, None, None] * np.eye(n)
    flexibility = np.asarray(wheel + track + springs, dtype=np.complex128)
    for name, array in (("receptance", flexibility), ("excitation", profile)):
        bad = ~np.isfinite(array).reshape(count, -1).all(axis=1)
        if bad.any():
            raise SolveError(f"wheel-rail forces: the {name} is not finite at {at(bad)}")
    unit = np.broadcast_to(np.eye(n), (count, n, n))
    right = np.concatenate([profile[:, :, None], unit], axis=2)
    try:
        solution = np.asarray(np.linalg.solve(flexibility, right), dtype=np.complex128)
    except np.linalg.LinAlgError:
        singular = np.array([np.linalg.matrix_rank(matrix) < n for matrix in flexibility])
        place = at(singular) if singular.any() else "some frequency"
        raise SolveError(
            f"wheel-rail forces: wheel, track and contact flexibility together are singular at {place}"
        ) from None
    condition: Reals = np.multiply(_norm(flexibility), _norm(solution[:, :, 1:]))
    bad = ~(condition < WORST_CONDITION)
    if bad.any():
        raise SolveError(
            f"wheel-rail forces: condition number {condition[bad][0]:.1e} exceeds {WORST_CONDITION:.0e} "
            f"at {at(bad)}"
        )
    return np.asarray(-solution[:, :, 0])


def power_spectrum(response: ArrayLike, frequency_Hz: ArrayLike | None = None, *, derivatives: int = 0) -> Reals:
    """One-sided density of a response to pseudo-excitation, |(i omega)^d z|^2.

    Parameters
    ----------
    response : array_like, shape (F, ...)
        Force or displacement under :func:`pseudo_excitation`.
    frequency_Hz : array_like, shape (F,), optional
        Needed for a derivative.
    derivatives : {0, 1, 2}
        0: as it is; 1: velocity; 2: acceleration (paper, equation (20)).

    Returns
    -------
    ndarray of float64, shape of `response`
        Its unit squared, per s^(2 d), per Hz.

    Raises
    ------
    InputError
        For another derivative, and for frequencies that are missing or do not fit.
    """
    amplitude = np.asarray(response, dtype=np.complex128)
    if derivatives == 0:
        return np.abs(amplitude) ** 2
    if derivatives not in (1, 2):
        raise InputError("must be 0, 1 or 2", where="derivatives", value=derivatives)
    if frequency_Hz is None:
        raise InputError("a derivative needs the frequencies", where="frequency_Hz")
    frequency = np.atleast_1d(check_frequency(frequency_Hz))
    if frequency.shape != amplitude.shape[:1]:
        raise InputError(
            f"shape {frequency.shape} does not fit a response of shape {amplitude.shape}",
            where="frequency_Hz",
        )
    omega = (2.0 * np.pi * frequency).reshape(-1, *[1] * (amplitude.ndim - 1))
    return np.asarray(omega ** (2 * derivatives) * np.abs(amplitude) ** 2)


def _norm(matrices: Complexes) -> Reals:
    return np.asarray(np.abs(matrices).sum(axis=1).max(axis=1))


def _floats(values: ArrayLike, name: str) -> Reals:
    array = real_numbers(values, name)
    if not np.isfinite(array).all():
        index = tuple(int(axis[0]) for axis in np.nonzero(~np.isfinite(array))) if array.ndim else ()
        raise InputError("not finite", where=f"{name}{list(index) or ''}", value=float(array[index]))
    return array


class _Namer:
    """Names the first frequency that a mask marks."""

    def __init__(self, frequency: Reals | None) -> None:
        self._frequency = frequency

    def __call__(self, mask: ArrayLike) -> str:
        index = int(np.flatnonzero(np.asarray(mask))[0])
        return f"index {index}" if self._frequency is None else f"{self._frequency[index]:g} Hz (index {index})"


def _namer(frequency_Hz: ArrayLike | None, count: int) -> _Namer:
    if frequency_Hz is None:
        return _Namer(None)
    frequency = np.atleast_1d(check_frequency(frequency_Hz))
    if frequency.shape != (count,):
        raise InputError(f"shape {frequency.shape} does not fit {count} frequencies", where="frequency_Hz")
    return _Namer(frequency)
