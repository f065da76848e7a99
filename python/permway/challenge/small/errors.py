"""Errors of measurement: calibration errors of gain and phase, noise blow by blow, and rounding."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from permway.challenge.beams import Complexes, Reals
from permway.challenge.small.draws import log_between

NEPER_PER_DB = float(np.log(10.0) / 20.0)

SHARE = {"sensor": 0.8, "force": 0.6}
"""Of the calibration errors: those of a sensor and of a hammer point; the squares add to one."""

ROUGH_OCTAVES = 0.5
"""Correlation length below which errors count as rough, octaves."""

ROUNDING = 0.002
"""Relative error of every line that no coherence constrains: real part and imaginary part each, 0.017 dB. At a
tenth of it clean campaigns would show changes that no mesh is fine enough for; at ten times of it none is."""

IDEAL = 0.003
"""Relative error of every line by which a truth states deviances, real part and imaginary part each, 0.026 dB: no
model is free of as much. At a third of it effects of a thousandth count as easy in clean campaigns; at three times
as much, deviances of clean campaigns are a ninth."""

KEPT = 1e-6
"""Share of the largest eigenvalue below which a function of calibration errors is left out."""

BLOWS_NOISE = (0.002, 0.6)
"""Between which the noise of a blow lies, over the median modulus of its pair: from clean to hidden."""


@dataclass(frozen=True)
class Errors:
    """What a campaign is measured with.

    Attributes
    ----------
    size_dB : float
        Standard deviation of the calibration errors of sensor and hammer point together, of level; of phase as
        many neper in rad.
    length_octaves : float
        Over which they correlate: squared exponential in log2 f.
    noise : float
        Standard deviation of a blow's noise, real and imaginary part each, over the median modulus of its pair.
    """

    size_dB: float
    length_octaves: float
    noise: float

    @property
    def rough(self) -> bool:
        """Whether the errors vary fast over frequency."""
        return self.length_octaves < ROUGH_OCTAVES

    def size(self, of: str) -> float:
        """Of one chain, neper and rad."""
        return self.size_dB * NEPER_PER_DB * SHARE[of]


def draw_errors(random: np.random.Generator) -> Errors:
    """Evenly from 0 to 1.5 dB, the length from 0.15 to 2 octaves and the noise evenly in their logarithms."""
    size = round(float(random.uniform(0.0, 1.5)), 3)
    return Errors(size, log_between(random, 0.15, 2.0), log_between(random, *BLOWS_NOISE))


def root(frequency_Hz: Reals, length_octaves: float) -> Reals:
    """Functions whose sum with unit normal coefficients is a calibration error of size 1, shape (F, functions)."""
    at = np.log2(frequency_Hz)
    values, vectors = np.linalg.eigh(np.exp(-0.5 * ((at[:, None] - at) / length_octaves) ** 2))
    keep = values > KEPT * values[-1]
    return np.asarray(vectors[:, keep] * np.sqrt(values[keep]))


def smooth(random: np.random.Generator, functions: Reals, size: float) -> Complexes:
    """A complex gain whose logarithm has so large a smooth real and imaginary part, shape (F,)."""
    draw = random.standard_normal((functions.shape[1], 2)) * size
    parts = functions @ draw
    return np.asarray(np.exp(parts[:, 0] + 1j * parts[:, 1]))


def blow_noise(responses: Complexes, errors: Errors, factors: Reals) -> Reals:
    """Standard deviation of a blow's noise by sensor and point, real and imaginary part each.

    Parameters
    ----------
    responses : ndarray, shape (sensors, points, F)
        What is there with nothing concealed.
    errors : Errors
    factors : ndarray, shape (sensors,)
        On a sensor's noise, of power.
    """
    median = np.median(np.abs(responses), axis=-1)
    return np.asarray(errors.noise * median * np.sqrt(factors)[:, None])


def struck(random: np.random.Generator, responses: Complexes, noise: Reals, blows: int) -> tuple[Complexes, Reals]:
    """Mean of some blows and its coherence, both (sensors, points, F).

    Parameters
    ----------
    responses : ndarray, shape (sensors, points, F)
        Errors of chains included.
    noise : ndarray, shape (sensors, points)
    blows : int
    """
    shape = (blows, *responses.shape)
    drawn = random.standard_normal(shape) + 1j * random.standard_normal(shape)
    read = responses + noise[:, :, None] * drawn
    mean = read.mean(axis=0)
    coherence = np.abs(mean) ** 2 / (np.abs(read) ** 2).mean(axis=0)
    last = random.standard_normal((2, *responses.shape)) * ROUNDING
    return np.asarray(mean * (1.0 + last[0] + 1j * last[1])), np.asarray(coherence)


def run_in_time(
    random: np.random.Generator, frequency_Hz: Reals, density: Complexes, sampling_Hz: float, seconds: float
) -> Reals:
    """A stationary Gaussian record of given one-sided cross-spectral densities, shape (N, channels).

    Parameters
    ----------
    random : Generator
    frequency_Hz : ndarray, shape (F,)
        Ascending; between them densities are interpolated linearly, outside they are zero.
    density : ndarray of complex128, shape (F, channels, channels)
    sampling_Hz, seconds : float
    """
    count = round(sampling_Hz * seconds)
    lines = np.fft.rfftfreq(count, 1.0 / sampling_Hz)
    inside = (lines >= frequency_Hz[0]) & (lines <= frequency_Hz[-1])
    place = np.interp(lines[inside], frequency_Hz, np.arange(frequency_Hz.size))
    left = np.minimum(place.astype(int), frequency_Hz.size - 2)
    part = (place - left)[:, None, None]
    fine = density[left] * (1.0 - part) + density[left + 1] * part
    values, vectors = np.linalg.eigh(fine)
    half = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
    drawn = random.standard_normal((2, int(inside.sum()), density.shape[1]))
    series = np.zeros((lines.size, density.shape[1]), dtype=np.complex128)
    # One-sided density S: E|X|^2 = S N fs / 2 of numpy's unnormalised transform.
    series[inside] = np.einsum("fij,fj->fi", half, drawn[0] + 1j * drawn[1]) * np.sqrt(0.25 * count * sampling_Hz)
    return np.asarray(np.fft.irfft(series, count, axis=0))
