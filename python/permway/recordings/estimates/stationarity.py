"""Whether a record is stationary: segments against each other."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy import special

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.estimates.welch import Samples, labelled, transforms
from permway.recordings.estimates.windows import independent_lines, segments

_FEWEST = 8


class Stationarity(NamedTuple):
    """Two tests for each channel; small probabilities are evidence against a stationary record."""

    power: Reals
    """Power of each segment over the mean, line by line and then averaged, shape (channel, segment)."""
    spread_probability: Reals
    """Of powers that differ at least as much, shape (channel,)."""
    runs_probability: Reals
    """Of so few or so many runs above and below the median, two-sided, shape (channel,)."""


def stationarity(
    record: ArrayLike | Samples | xr.DataArray,
    *,
    sampling_Hz: float,
    segment_s: float,
    from_Hz: float = 0.0,
    to_Hz: float = np.inf,
) -> Stationarity:
    """Compare the powers of segments that do not overlap, each line weighed by its own mean.

    Spread: a stationary Gaussian record's segment power q, whitened, is Gamma with 2 L degrees of freedom, L
    the number of independent lines; over its own mean each line is Dirichlet, so L (n + 1) / n sum (q - 1)^2
    has mean n - 1 and, with the Gamma's kurtosis, variance (n - 1) (2 + 6 / L (n - 1) / n); a Gamma law of
    these two is its distribution. Runs: about the median, exact (Wald and Wolfowitz 1940; Bendat and Piersol
    2010, chapter 4). The first sees bursts, the second drifts.

    Parameters
    ----------
    record : array_like, shape (channel, sample) or (sample,)
        Read twice, piece by piece.
    sampling_Hz, segment_s : float
    from_Hz, to_Hz : float
        Lines that count.

    Raises
    ------
    InputError
        For NaN, fewer than eight segments, or no line between the frequencies.
    """
    samples, _, _ = labelled(record)
    layout = segments(samples.shape[1], sampling_Hz=sampling_Hz, segment_s=segment_s, overlap=0.0)
    if layout.count < _FEWEST:
        raise InputError(
            f"{layout.count} segment(s) are too few to compare; {_FEWEST} are needed",
            where="segment_s",
            value=segment_s,
            remedy="shorten it",
        )
    frequency = np.fft.rfftfreq(layout.length, 1.0 / sampling_Hz)
    keep = ~layout.touched_by_detrending() & (frequency >= from_Hz) & (frequency <= to_Hz)
    keep[-1] = False
    if not keep.any():
        raise InputError("no line lies between", where="from_Hz, to_Hz", value=[from_Hz, to_Hz])
    mean = np.zeros((samples.shape[0], int(keep.sum())))
    for transform in transforms(samples, layout, detrend=True):
        mean += np.sum(np.abs(transform[:, :, keep]) ** 2, axis=1) / layout.count
    dead = ~(mean > 0.0)
    if dead.any():
        channel = int(np.argwhere(dead)[0, 0])
        raise InputError("has no power", where=f"record[{channel}]", remedy="leave dead channels out")
    power = np.concatenate(
        [
            np.mean(np.abs(t[:, :, keep]) ** 2 / mean[:, None], axis=2)
            for t in transforms(samples, layout, detrend=True)
        ],
        axis=1,
    )
    covariance = layout.line_covariance(8) * layout.count
    lines = independent_lines(covariance / covariance[0], np.ones(int(keep.sum())))
    return Stationarity(power, _spread(power, lines), _runs(power))


def _spread(power: Reals, lines: float) -> Reals:
    count = power.shape[1]
    value = lines * (count + 1.0) / count * np.sum((power - 1.0) ** 2, axis=1)
    mean, variance = count - 1.0, (count - 1.0) * (2.0 + 6.0 / lines * (count - 1.0) / count)
    return np.asarray(special.gammaincc(mean**2 / variance, value * mean / variance))


def _runs(power: Reals) -> Reals:
    """Two-sided probability of the number of runs, given as many values above the median as below."""
    answer = np.empty(power.shape[0])
    for row, values in enumerate(power):
        above = values[values != np.median(values)] > np.median(values)
        a, b = int(above.sum()), int((~above).sum())
        met = 1 + int(np.count_nonzero(np.diff(above)))
        runs = np.arange(2, a + b + 1)
        chance = np.array([_runs_chance(int(r), a, b) for r in runs])
        below, beyond = chance[runs <= met].sum(), chance[runs >= met].sum()
        answer[row] = min(1.0, 2.0 * min(below, beyond))
    return answer


def _runs_chance(runs: int, a: int, b: int) -> float:
    """Of exactly so many runs among a values above and b below."""
    half = runs // 2
    if runs % 2 == 0:
        ways = 2.0 * special.comb(a - 1, half - 1) * special.comb(b - 1, half - 1)
    else:
        ways = special.comb(a - 1, half) * special.comb(b - 1, half - 1)
        ways += special.comb(a - 1, half - 1) * special.comb(b - 1, half)
    return float(ways / special.comb(a + b, a))
