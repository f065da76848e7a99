"""Track decay rate by the positions of EN 15461, measured or predicted, with its uncertainty."""

from __future__ import annotations

import math
import warnings
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy import special

from permway.arrays import Reals, check_frequency, real_numbers
from permway.errors import InputError
from permway.recordings.estimates.bands import Bands, bands_between, bands_within
from permway.recordings.estimates.checks import as_complexes, as_reals, check_level, check_positive

GRID_BAYS = (
    *(0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 3.0, 3.5, 4.0),
    *(5.0, 6.0, 7.0, 8.0, 10.0, 12.0, 16.0, 20.0, 24.0, 30.0, 36.0, 42.0, 48.0, 54.0, 66.0),
)
"""EN 15461:2008+A1:2010, figure 2: the 29 places of the blow, in sleeper bays from the accelerometer."""

_TEN_LG_E = 10.0 / math.log(10.0)
"""4.343, unrounded."""

_FAR_DROP_DB = 10.0
"""EN 15461, 6.7: the response at the farthest position lies at least so far below the direct one."""


class TruncationWarning(UserWarning):
    """The grid ends before the vibration does: the rate found is an upper bound."""


class BandResponse(NamedTuple):
    """Response in one-third octaves."""

    bands: Bands
    modulus: Reals
    """Root of the mean |A|^2 in the band, shape (position, band)."""
    variance: Reals | None
    """Of its logarithm."""


def grid_positions(bay_m: float = 0.6) -> Reals:
    """The 29 positions in m; 0.6 m also where the rail rests on no sleepers (EN 15461, 6.7)."""
    return np.array(GRID_BAYS) * check_positive(bay_m, "bay_m")


def grid_intervals(position_m: ArrayLike) -> Reals:
    """Length of rail that each position stands for (EN 15461, A.2).

    From half way to the position before to half way to the next; the first from 0; the last symmetric about
    itself.

    Parameters
    ----------
    position_m : array_like, shape (N,)
        From 0, ascending.
    """
    position = as_reals(position_m, "position_m", ndim=1)
    if position.size < 2 or position[0] != 0.0 or np.any(np.diff(position) <= 0.0):
        raise InputError(
            "must begin at the accelerometer, 0 m, and ascend",
            where="position_m",
            value=position.tolist(),
            remedy="sort the positions and their responses",
        )
    middle = 0.5 * (position[1:] + position[:-1])
    return np.diff(middle, prepend=0.0, append=position[-1] + (position[-1] - middle[-1]))


@lru_cache(maxsize=16)
def _grid(bay_m: float) -> Reals:
    length = grid_intervals(grid_positions(bay_m))
    length.flags.writeable = False
    return length


def rate_on_grid(modulus: Reals, bay_m: float) -> Reals:
    """The rate alone, dB/m, of responses at the 29 positions: see :func:`track_decay_rate`.

    Parameters
    ----------
    modulus : ndarray, shape (29, frequency)
        Above zero at the accelerometer.
    bay_m : float
    """
    return np.asarray(_TEN_LG_E / (modulus**2 / modulus[0] ** 2 * _grid(bay_m)[:, None]).sum(axis=0))


def track_decay_rate(
    response: ArrayLike,
    position_m: ArrayLike,
    *,
    variance: ArrayLike | None = None,
    degrees_of_freedom: ArrayLike = np.inf,
    take_off_noise: bool = False,
    level: float = 0.95,
    warn: bool = True,
) -> xr.Dataset:
    """Decay rate DR = 10 lg e / sum (|A(x_n)| / |A(x_0)|)^2 dx_n (EN 15461:2008+A1:2010, formula (1)).

    Its logarithm has, with w_n = (|A_n|/|A_0|)^2 dx_n / sum and s_n^2 the variance of ln|A_n|, positions
    independent, the variance 4 (sum_(n>0) w_n^2 s_n^2 + (sum_(n>0) w_n)^2 s_0^2). Noise adds 2 s_n^2 of itself
    to |A_n|^2, and so lowers the rate; `noise_bias_dB` states by how much.

    Parameters
    ----------
    response : array_like, shape (position, frequency) or (position,)
        Accelerance, mobility or receptance, complex or modulus: only ratios enter.
    position_m : array_like, shape (position,)
        From the accelerometer, 0 first.
    variance : array_like, optional
        Of ln|A|, the shape of `response`.
    degrees_of_freedom : array_like
        Of those variances.
    take_off_noise : bool
        Whether |A_n|^2 is freed of what its variance states noise has added.
    level : float
        Of the interval.
    warn : bool
        Whether a grid too short gives a :class:`TruncationWarning`.

    Returns
    -------
    xarray.Dataset
        Along `line`: `decay_rate`, `low`, `high` in dB/m; `log_variance` and `degrees_of_freedom` of ln DR;
        `noise_bias_dB`; `far_drop_dB`; `suitable`: the floor 10 lg e / x_max is at most half the rate (clause
        7) and the farthest response 10 dB down (6.7). Attribute `floor_dB_per_m`.

    Raises
    ------
    InputError
        For shapes that do not fit, or a response that is zero or not finite.
    """
    modulus = np.abs(as_complexes(response, "response"))
    position = as_reals(position_m, "position_m", ndim=1)
    length = grid_intervals(position)
    if modulus.ndim == 1:
        modulus = modulus[:, None]
    if modulus.ndim != 2 or modulus.shape[0] != position.size:
        raise InputError(
            f"shape {modulus.shape} for {position.size} positions",
            where="response",
            remedy="give (position, frequency)",
        )
    if np.any(modulus[0] <= 0.0):
        raise InputError(
            "zero at the accelerometer", where=f"response[0, {int(np.argmin(modulus[0]))}]", value=0.0
        )
    square = np.zeros_like(modulus) if variance is None else as_reals(variance, "variance").reshape(modulus.shape)
    if np.any(square < 0.0):
        raise InputError("must not be negative", where="variance", value=float(square.min()))
    freedom = np.broadcast_to(real_numbers(degrees_of_freedom, "degrees_of_freedom"), modulus.shape)
    if np.any(np.isnan(freedom) | (freedom <= 0.0)):
        raise InputError("must be above zero", where="degrees_of_freedom", value=float(freedom.min()))
    power, clean = modulus**2, modulus**2 * np.maximum(1.0 - 2.0 * square, 0.0)
    if take_off_noise and np.any(clean[0] <= 0.0):
        raise InputError("nothing but noise at the accelerometer", where="response[0]", remedy="take more blows")
    sums = [np.sum(p / p[0] * length[:, None], axis=0) for p in (power, np.where(clean[0] > 0.0, clean, power))]
    used, total = (clean, sums[1]) if take_off_noise else (power, sums[0])
    rate = _TEN_LG_E / total
    weight = used / used[0] * length[:, None] / total
    parts = 4.0 * weight**2 * square
    parts[0] = 4.0 * weight[1:].sum(axis=0) ** 2 * square[0]
    spread = parts.sum(axis=0)
    # Welch and Satterthwaite: the freedom of a sum of independent variances.
    shared = np.sum(parts**2 / freedom, axis=0)
    joint = np.divide(spread**2, shared, out=np.full(spread.shape, np.inf), where=shared > 0.0)
    tail = 0.5 * (1.0 - check_level(level))
    quantile = np.where(
        np.isinf(joint),
        special.ndtri(1.0 - tail),
        special.stdtrit(np.where(np.isinf(joint), 1.0, joint), 1.0 - tail),
    )
    reach = np.exp(quantile * np.sqrt(spread))
    with np.errstate(divide="ignore"):
        drop = 20.0 * np.log10(modulus[0] / modulus[-1])
    floor = _TEN_LG_E / position[-1]
    # A rate at exactly twice the floor, or a drop of exactly 10 dB, holds in spite of rounding.
    suitable = (rate >= 2.0 * floor * (1.0 - 1e-9)) & (drop >= _FAR_DROP_DB - 1e-9)
    if warn and not suitable.all():
        first = int(np.argmin(suitable))
        warnings.warn(
            f"the vibration has not died away at {position[-1]:g} m in {int((~suitable).sum())} of {rate.size} "
            f"line(s) or band(s), where the rate is an upper bound; index {first}: drop {drop[first]:.1f} dB, "
            f"rate {rate[first]:.3g} dB/m against a floor of {floor:.3g} dB/m",
            TruncationWarning,
            stacklevel=2,
        )
    table = {
        "decay_rate": (rate, "track decay rate", "dB/m"),
        "low": (rate / reach, "lower bound of the decay rate", "dB/m"),
        "high": (rate * reach, "upper bound of the decay rate", "dB/m"),
        "log_variance": (spread, "variance of the logarithm of the decay rate", "1"),
        "degrees_of_freedom": (joint, "degrees of freedom of that variance", "1"),
        "noise_bias_dB": (
            10.0 * np.log10(sums[1] / sums[0]),
            "what noise adds to 10 lg of the rate as read",
            "dB",
        ),
        "far_drop_dB": (drop, "fall of the response over the grid", "dB"),
        "suitable": (suitable, "grid long enough", "1"),
    }
    return xr.Dataset(
        {
            name: ("line", values, {"long_name": text, "units": unit})
            for name, (values, text, unit) in table.items()
        },
        attrs={
            "method": "EN 15461:2008+A1:2010, formula (1)",
            "floor_dB_per_m": float(floor),
            "level": level,
            "noise_taken_off": int(take_off_noise),
        },
    )


def band_response(
    response: ArrayLike,
    frequency_Hz: ArrayLike,
    *,
    variance: ArrayLike | None = None,
    line_covariance: ArrayLike = (1.0,),
    from_Hz: float | None = None,
    to_Hz: float | None = None,
) -> BandResponse:
    """Root mean square of responses over one-third octaves, from lines at equal steps.

    Parameters
    ----------
    response : array_like, shape (position, frequency)
    frequency_Hz : array_like, shape (frequency,)
        At equal steps.
    variance : array_like, optional
        Of ln|A|, the shape of `response`.
    line_covariance : array_like
        Of :func:`permway.recordings.estimates.welch.cross_spectra`; only ratios to the first count.
    from_Hz, to_Hz : float, optional
        First and last band; by default all that the lines cover.
    """
    frequency = check_frequency(frequency_Hz)
    power = np.abs(as_complexes(response, "response")) ** 2
    if frequency.ndim != 1 or frequency.size < 2 or power.ndim != 2 or power.shape[1] != frequency.size:
        raise InputError(f"shape {power.shape} for {frequency.shape} frequencies", where="response")
    step = np.diff(frequency)
    if np.ptp(step) > 1e-6 * step[0] or step[0] <= 0.0:
        raise InputError(
            "must ascend in equal steps", where="frequency_Hz", value=[float(step.min()), float(step.max())]
        )
    width = float(step[0])
    edges = np.append(frequency - 0.5 * width, frequency[-1] + 0.5 * width)
    whole = bands_within(float(edges[0]), float(edges[-1]))
    bands = whole
    if from_Hz is not None or to_Hz is not None:
        ends = whole.middle_Hz if whole.number.size else frequency
        bands = bands_between(
            float(ends[0]) if from_Hz is None else from_Hz, float(ends[-1]) if to_Hz is None else to_Hz
        )
    if not bands.number.size or np.setdiff1d(bands.number, whole.number).size:
        raise InputError(
            f"lines from {frequency[0]:g} to {frequency[-1]:g} Hz do not cover a band asked for",
            where="frequency_Hz",
            value=bands.label,
            remedy="widen the lines or leave the band out",
        )
    share = bands.weights(edges)
    share /= share.sum(axis=1, keepdims=True)
    mean = power @ share.T
    if variance is None:
        return BandResponse(bands, np.sqrt(mean), None)
    spread = as_reals(variance, "variance")
    if spread.shape != power.shape:
        raise InputError(f"shape {spread.shape}, the response {power.shape}", where="variance")
    covariance = as_reals(line_covariance, "line_covariance", ndim=1)
    deviation = 2.0 * power * np.sqrt(spread)
    total = np.zeros_like(mean)
    for apart, value in enumerate(covariance[: frequency.size] / covariance[0]):
        part = deviation[:, : frequency.size - apart], deviation[:, apart:]
        pair = share[:, : frequency.size - apart] * share[:, apart:]
        total += (1.0 if apart == 0 else 2.0) * value * ((part[0] * part[1]) @ pair.T)
    return BandResponse(bands, np.sqrt(mean), total / (4.0 * mean**2))
