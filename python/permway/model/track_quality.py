"""An irregularity as track recording reports it: standard deviations D1 to D3, spectra, profiles.

EN 13848-1 splits the longitudinal level by wavelength, D1 above 3 to 25 m, D2 above 25 to 70 m, D3 above 70 to
150 m, and EN 13848-5 and -6 judge the standard deviation of each part.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.fft import next_fast_len

from permway.arrays import Reals
from permway.errors import InputError
from permway.model.irregularity_spectra import EDGE, Irregularity, check_wavenumber

BANDS_M: dict[str, tuple[float, float]] = {"D1": (3.0, 25.0), "D2": (25.0, 70.0), "D3": (70.0, 150.0)}
"""Wavelengths of the longitudinal level, m (EN 13848-1)."""

MOST_SAMPLES = 2**24
"""Of a profile: 128 MiB in memory. Half is still 2000 km at 0.25 m."""
_POINTS = 8001
"""Of the integral over a band, at equal ratios. Half changes a smooth spectrum's by 1e-7, one of third octaves by
2e-4."""


@dataclass(frozen=True)
class BandDeviation:
    """Standard deviation within a band of wavelengths.

    Attributes
    ----------
    band : str
    from_m, to_m : float
        The band.
    covered_m : (float, float) or None
        The part of it that the spectrum's source covers, which alone is counted; None if none is.
    deviation_m : float or None
        Standard deviation, m.
    """

    band: str
    from_m: float
    to_m: float
    covered_m: tuple[float, float] | None
    deviation_m: float | None

    @property
    def whole(self) -> bool:
        """Whether the source covers all of the band."""
        return self.covered_m is not None and all(
            math.isclose(a, b, rel_tol=1e-6) for a, b in zip(self.covered_m, (self.from_m, self.to_m), strict=True)
        )


def band_deviations(irregularity: Irregularity) -> tuple[BandDeviation, ...]:
    """Standard deviations of the bands of EN 13848-1, from the density over wavenumber.

    Parameters
    ----------
    irregularity : Irregularity

    Returns
    -------
    tuple of BandDeviation
        D1, D2, D3. Nothing is extrapolated beyond what the source covers.
    """
    return tuple(_band(irregularity, name, *reach) for name, reach in BANDS_M.items())


def _band(irregularity: Irregularity, name: str, short: float, long: float) -> BandDeviation:
    shortest, longest = irregularity.valid_wavelength_m
    low, high = max(short, shortest), min(long, longest)
    if not high > low * (1.0 + EDGE):
        return BandDeviation(name, short, long, None, None)
    # An ulp inwards, so that a table's own ends are not outside it.
    u = np.linspace(math.log(2.0 * np.pi / high) + EDGE, math.log(2.0 * np.pi / low) - EDGE, _POINTS)
    density = irregularity.wavenumber_density(np.exp(u))
    variance = float(np.trapezoid(density * np.exp(u), u))
    return BandDeviation(name, short, long, (low, high), math.sqrt(variance))


def density_per_cycle(irregularity: Irregularity, cycles_per_m: ArrayLike) -> Reals:
    """One-sided density over spatial frequency n, as track recording gives it: S_n(n) = 2 pi S(2 pi n).

    Parameters
    ----------
    irregularity : Irregularity
    cycles_per_m : array_like, any shape
        Spatial frequencies 1 / wavelength, 1/m, above zero.

    Returns
    -------
    ndarray
        m2/(1/m); times 1e6 it is in mm2 m. Its integral over n is the variance.
    """
    wavenumber = 2.0 * np.pi * check_wavenumber(cycles_per_m)
    return np.asarray(2.0 * np.pi * irregularity.wavenumber_density(wavenumber))


def draw_profile(irregularity: Irregularity, *, length_m: float, spacing_m: float, seed: int = 0) -> Reals:
    """A Gaussian profile in space with the spectrum of an irregularity.

    Parameters
    ----------
    irregularity : Irregularity
    length_m : float
        Of the profile.
    spacing_m : float
        Between its samples.
    seed : int
        The same seed gives the same profile.

    Returns
    -------
    ndarray, shape (floor(length / spacing) + 1,)
        m. Waves of wavelengths that the source covers, and not shorter than two samples. The record is cut out of
        one of twice the length that closes on itself, so that its two ends are independent of each other.

    Raises
    ------
    InputError
        For lengths that are not finite and above zero, too many samples, or samples so far apart that no wave of
        the source is left.
    """
    for name, value in (("length_m", length_m), ("spacing_m", spacing_m)):
        if not (math.isfinite(value) and value > 0.0):
            raise InputError("must be finite and above 0 m", where=name, value=value)
    count = int(length_m / spacing_m * (1.0 + 1e-12)) + 1
    if not 2 <= count <= MOST_SAMPLES:
        raise InputError(
            f"makes {count} samples",
            where="spacing_m",
            value=spacing_m,
            remedy=f"give a length and a spacing that make 2 to {MOST_SAMPLES}",
        )
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise InputError("must be a whole number from 0 on", where="seed", value=seed)
    size = int(next_fast_len(2 * count, real=True))
    step = 2.0 * np.pi / (size * spacing_m)
    wavenumber = step * np.arange(size // 2 + 1)
    shortest, longest = irregularity.valid_wavelength_m
    highest = min(2.0 * np.pi / shortest, np.pi / spacing_m)
    inside = (wavenumber >= 2.0 * np.pi / longest) & (wavenumber <= highest)
    if not inside.any():
        raise InputError(
            f"no wave of {shortest:g} to {longest:g} m is between two samples and the length",
            where="spacing_m",
            value=spacing_m,
            remedy="take a smaller spacing, or a longer profile",
        )
    deviation = np.zeros(wavenumber.size)
    deviation[inside] = np.sqrt(irregularity.wavenumber_density(wavenumber[inside]) * step)
    random = np.random.default_rng(seed)
    waves = random.standard_normal((2, wavenumber.size)) * deviation
    profile = np.fft.irfft(0.5 * size * (waves[0] - 1j * waves[1]), size)
    return np.asarray(profile[:count])
