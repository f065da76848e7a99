"""Poles of a line's response: natural frequencies and damping ratios that no peak has to show.

A line without infinite beams answers forces by a meromorphic function of frequency, whose poles are its modes. A
rational function through the response at real frequencies has the same poles near them to rounding, however close
together they lie. Source: Nakatsukasa, Sete and Trefethen (2018), SIAM J. Sci. Comput. 40, A1494-A1522 (AAA), with
one denominator for several responses as in Lietaert et al. (2022), IMA J. Numer. Anal. 42, 1087-1115.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import linalg

from permway.arrays import Complexes, Reals
from permway.errors import SolveError

TOLERANCE = 1e-12
"""Of the rational function, relative to the root mean square of each response: some digits above rounding."""

ROUGHEST = 1e-7
"""The same, above which the response is not that of so many poles."""

MOST_POLES = 150

MIXTURES = 2
"""Combinations of all responses that poles are sought in; one alone could by chance see little of a mode."""

SAME = 1e-6
"""Relative distance at which two poles are one: what every second line gives must be what all lines give."""

HEAVIEST = 0.7
"""Damping ratio above which a pole is no mode that a test would list."""

SLIGHTEST = 1e-4
"""Share of the largest inverse modal mass below which a mode is not seen: a hundredth of its motion."""

LINES_PER_OCTAVE, FEWEST_LINES = 40, 120


@dataclass(frozen=True)
class Poles:
    """Modes of a line as places see them, by ascending frequency.

    Attributes
    ----------
    omega : ndarray of complex128, shape (M,)
        Poles, rad/s; a positive imaginary part is damping under exp(+i omega t).
    residue : ndarray of complex128, shape (M, rows, columns)
        Of the receptances there, m/N rad/s: close to a pole the receptance is residue / (omega - pole).
    """

    omega: Complexes
    residue: Complexes

    @property
    def frequency_Hz(self) -> Reals:
        """Natural frequencies, the modulus of the poles over 2 pi."""
        return np.asarray(np.abs(self.omega) / (2.0 * np.pi))

    @property
    def damping(self) -> Reals:
        """Damping ratios, imaginary part over modulus; of an undamped mode 0 to rounding."""
        return np.asarray(self.omega.imag / np.abs(self.omega))

    @property
    def shape(self) -> Complexes:
        """Mode shapes at the rows, the largest 1, shape (M, rows)."""
        found = []
        for residue in self.residue:
            left, size, _ = np.linalg.svd(residue)
            motion = left[:, 0] * size[0]
            found.append(motion / motion[np.argmax(np.abs(motion))])
        return np.array(found, dtype=np.complex128).reshape(self.omega.size, -1)


def lines_for(low_Hz: float, high_Hz: float) -> Reals:
    """Frequencies at which to take the response, for poles between two of them."""
    count = max(FEWEST_LINES, int(np.ceil(LINES_PER_OCTAVE * np.log2(high_Hz / low_Hz))))
    return np.asarray(np.geomspace(low_Hz, high_Hz, count))


def poles_of(frequency_Hz: Reals, receptance: Complexes) -> Poles:
    """The modes that receptances show between the first and the last of their frequencies.

    Parameters
    ----------
    frequency_Hz : ndarray, shape (F,)
        As of :func:`lines_for`.
    receptance : ndarray of complex128, shape (F, rows, columns)
        Free of noise, m/N, between the same places for rows and columns.

    Raises
    ------
    SolveError
        If the response is not that of at most :data:`MOST_POLES` poles, as of an infinite beam.
    """
    omega = 2.0 * np.pi * frequency_Hz
    # Accelerances are of one size over the band where receptances fall by powers of ten.
    responses = receptance.reshape(omega.size, -1) * omega[:, None] ** 2
    mixed = responses @ _mixtures(responses)
    whole = _fitted(omega, mixed)
    again = _fitted(omega[::2], mixed[::2])
    error = whole.error(omega, mixed)
    if error > ROUGHEST:
        raise SolveError(
            f"the response between {frequency_Hz[0]:g} and {frequency_Hz[-1]:g} Hz is not that of "
            f"{MOST_POLES} modes or fewer: a rational function misses it by {error:.1e}"
        )
    found = _modes(whole.poles(), omega)
    second = again.poles()
    if second.size:
        found = found[np.abs(found[:, None] - second).min(axis=1) < SAME * np.abs(found)]
    residue = whole.residues(found, responses) / found[:, None] ** 2
    # A mode's residue at a driving point is shape^2 / (2 omega modal mass).
    weight = np.abs(residue * found[:, None]).max(axis=1, initial=0.0)
    found, residue = (values[weight > SLIGHTEST * weight.max(initial=0.0)] for values in (found, residue))
    order = np.argsort(np.abs(found))
    return Poles(found[order], residue[order].reshape(-1, *receptance.shape[1:]))


def _mixtures(responses: Complexes) -> Reals:
    """Weights by which all responses, each of size 1, are summed; the same at every call."""
    size = np.sqrt(np.mean(np.abs(responses) ** 2, axis=0))
    weights = np.random.default_rng(0).standard_normal((size.size, MIXTURES))
    return np.asarray(weights / np.where(size > 0.0, size, np.inf)[:, None])


def _modes(poles: Complexes, omega: Reals) -> Complexes:
    """Those of the band that are damped as modes are."""
    size = np.abs(poles)
    with np.errstate(divide="ignore", invalid="ignore"):
        damping = np.where(size > 0.0, poles.imag / size, np.inf)
    inside = (size >= omega[0]) & (size <= omega[-1]) & (poles.real > 0.0)
    return np.asarray(poles[inside & (damping > -SAME) & (damping < HEAVIEST)])


@dataclass(frozen=True)
class _Rational:
    """Rational functions of one denominator, in barycentric form."""

    at: np.ndarray
    nodes: Reals
    weights: Complexes
    values: Complexes

    def error(self, omega: Reals, mixed: Complexes) -> float:
        """Largest error over the root mean square of each."""
        apart = ~np.isin(np.arange(omega.size), self.at)
        if not apart.any():
            return np.inf
        cauchy = 1.0 / (omega[apart, None] - self.nodes)
        fit = cauchy @ (self.weights[:, None] * self.values) / (cauchy @ self.weights)[:, None]
        size = np.sqrt(np.mean(np.abs(mixed) ** 2, axis=0))
        return float((np.abs(fit - mixed[apart]) / size).max())

    def poles(self) -> Complexes:
        """Zeros of the denominator, from the arrowhead pencil (Nakatsukasa et al., equation (3.11))."""
        count = self.nodes.size
        pencil = np.zeros((count + 1, count + 1), dtype=np.complex128)
        pencil[0, 1:], pencil[1:, 0] = self.weights, 1.0
        pencil[1:, 1:] = np.diag(self.nodes)
        mass = np.eye(count + 1)
        mass[0, 0] = 0.0
        with np.errstate(divide="ignore", invalid="ignore"):
            found = linalg.eigvals(pencil, mass)
        return np.asarray(found[np.isfinite(found)])

    def residues(self, poles: Complexes, responses: Complexes) -> Complexes:
        """Of all responses at the poles, (poles, responses)."""
        cauchy = 1.0 / (poles[:, None] - self.nodes)
        slope = -(cauchy**2) @ self.weights
        return np.asarray(cauchy @ (self.weights[:, None] * responses[self.at]) / slope[:, None])


def _fitted(omega: Reals, mixed: Complexes) -> _Rational:
    """AAA: the point that is missed most becomes a node, weights are the least singular vector."""
    size = np.sqrt(np.mean(np.abs(mixed) ** 2, axis=0))
    scaled = mixed / np.where(size > 0.0, size, 1.0)
    count = omega.size
    apart = np.ones(count, dtype=np.bool_)
    at: list[int] = []
    fit = np.broadcast_to(scaled.mean(axis=0), scaled.shape)
    weights = np.zeros(0, dtype=np.complex128)
    most = min(MOST_POLES, count // 2 - 1)
    while len(at) < most:
        missed = np.abs(fit - scaled).max(axis=1) * apart
        if at and missed.max() < TOLERANCE:
            break
        at.append(int(np.argmax(missed)))
        apart[at[-1]] = False
        cauchy = 1.0 / (omega[apart, None] - omega[at])
        loewner = (scaled[apart, None] - scaled[None, at]) * cauchy[:, :, None]
        tall = np.moveaxis(loewner, 2, 0).reshape(-1, len(at))
        # Of a tall matrix the triangle of its QR decomposition has the same right singular vectors.
        triangle = np.linalg.qr(tall, mode="r")
        weights = np.linalg.svd(triangle)[2][-1].conj()
        fit = scaled.copy()
        fit[apart] = cauchy @ (weights[:, None] * scaled[at]) / (cauchy @ weights)[:, None]
    return _Rational(np.array(at), omega[at], weights, mixed[at])
