"""Windows and overlapping segments: how many averages they are worth, and how neighbouring lines hang together."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import signal

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.estimates.checks import as_reals, check_positive

_LEAST_SEGMENT = 8
_TOUCHED = 1e-3
"""A line is touched by detrending where the window's transform exceeds this share of its value at 0 Hz."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Segments:
    """Equal segments of a record, under one window.

    Parameters
    ----------
    window : ndarray, shape (N,)
    step : int
        Samples from one segment to the next.
    count : int
        Number of segments.
    """

    window: Reals
    step: int
    count: int

    @property
    def length(self) -> int:
        """Samples in a segment."""
        return int(self.window.size)

    def line_covariance(self, lags: int) -> Reals:
        """Relative covariance of the averaged powers of two lines, by their distance.

        For a Gaussian record whose spectrum is smooth over the window's width, with segments a and b and lines
        j and k, cov(|X_ja|^2, |X_kb|^2) = S_j S_k |sum w(t) w(t + m) exp(-2 pi i (j - k) t / N)|^2 / (sum w^2)^2,
        m = (b - a) step (Welch 1967; Percival and Walden 1993, chapter 6); here averaged over all pairs.

        Returns
        -------
        ndarray, shape (lags + 1,)
            cov(S_j, S_(j+d)) / (S_j S_(j+d)); at d = 0 it is 1 / K.
        """
        lags = min(lags, self.length // 2)
        total = np.zeros(lags + 1)
        for apart, share in self._shares(lags):
            total += (1.0 if apart == 0 else 2.0 * (1.0 - apart / self.count)) * share
        return total / self.count

    def _shares(self, lags: int) -> Iterator[tuple[int, Reals]]:
        """Relative covariance of the powers of two segments, by how far they and their lines are apart."""
        energy = float(np.sum(self.window**2))
        for apart in range(min(self.count, -(-self.length // self.step))):
            shift = apart * self.step
            product = self.window[: self.length - shift] * self.window[shift:]
            yield apart, np.abs(np.fft.rfft(product, self.length)[: lags + 1]) ** 2 / energy**2

    @property
    def averages(self) -> float:
        """Effective number of averages K = n / (1 + 2 sum (1 - m/n) rho_m^2) (Welch 1967)."""
        return float(1.0 / self.line_covariance(0)[0])

    def averages_of(self, logarithms: Reals, lines: int) -> Reals:
        """The same of channels whose level varies from segment to segment: loud ones count more.

        With levels l the variance of the mean is that of a sum with these weights, so that
        K = (sum l)^2 / sum_ab l_a l_b rho_ab^2.

        Parameters
        ----------
        logarithms : ndarray, shape (channels, segments)
            Mean over lines of the logarithm of each segment's power. Each line's scatters with the variance
            pi^2 / 6 (of an exponential), which is taken off.
        lines : int
            Over which the mean is; neighbours hang together.

        Returns
        -------
        ndarray, shape (channels,)
            At most those of a level that stays.
        """
        level = np.exp(logarithms - logarithms.max(axis=1, keepdims=True))
        covariance = self.line_covariance(4)
        together = (covariance[0] + 2.0 * covariance[1:].sum()) / covariance[0]
        scatter = np.expm1(np.pi**2 / 6.0 * together / lines)
        pairs = np.zeros(level.shape[0])
        for apart, share in self._shares(0):
            product = np.sum(level[:, apart:] * level[:, : self.count - apart], axis=1)
            pairs += share[0] * (product / (1.0 + scatter) if apart == 0 else 2.0 * product)
        return np.asarray(np.minimum(level.sum(axis=1) ** 2 / pairs, self.averages))

    def degrees_of_freedom(self) -> Reals:
        """Degrees of freedom of each line's power, shape (N // 2 + 1,).

        2 K between the ends; near 0 Hz and half the sampling rate a line meets its own mirror image, and at
        them it is real: 2 K / (1 + share at twice the distance), which is K at the ends.
        """
        covariance = self.line_covariance(self.length // 2)
        lines = np.arange(self.length // 2 + 1)
        near = np.minimum(2 * lines, np.abs(self.length - 2 * lines))
        image = covariance[np.minimum(near, covariance.size - 1)] / covariance[0]
        return np.asarray(2.0 * self.averages / (1.0 + image))

    def touched_by_detrending(self) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        """Lines that lose power when each segment's mean is taken off, shape (N // 2 + 1,)."""
        transform = np.abs(np.fft.rfft(self.window))
        return np.asarray(transform > _TOUCHED * transform[0])


def segments(
    samples: int, *, sampling_Hz: float, segment_s: float, window: str | ArrayLike = "hann", overlap: float = 0.5
) -> Segments:
    """Lay segments over a record.

    Parameters
    ----------
    samples : int
        Length of the record.
    sampling_Hz : float
    segment_s : float
        Length of a segment; the lines are 1 / segment_s apart.
    window : str or array_like
        A name that scipy.signal.get_window knows, or the values themselves.
    overlap : float
        Share of a segment that the next one repeats, 0 <= overlap < 1.

    Raises
    ------
    InputError
        For a record shorter than one segment, or numbers out of range.
    """
    rate = check_positive(sampling_Hz, "sampling_Hz")
    length = round(check_positive(segment_s, "segment_s") * rate)
    if length < _LEAST_SEGMENT:
        raise InputError(
            f"is {length} sample(s), fewer than {_LEAST_SEGMENT}",
            where="segment_s",
            value=segment_s,
            remedy="lengthen",
        )
    if samples < length:
        raise InputError(
            f"{samples} samples are shorter than one segment of {length} ({length / rate:.4g} s)",
            where="record",
            remedy="shorten segment_s, or take a longer record",
        )
    if isinstance(overlap, bool) or not isinstance(overlap, int | float) or not 0.0 <= overlap < 1.0:
        raise InputError("must lie in [0, 1)", where="overlap", value=overlap, remedy="0.5 suits a Hann window")
    step = max(1, length - round(overlap * length))
    return Segments(window=window_values(window, length), step=step, count=(samples - length) // step + 1)


def window_values(window: str | ArrayLike, length: int) -> Reals:
    """Values of a window, periodic if it is a name."""
    if isinstance(window, str):
        try:
            return np.asarray(signal.get_window(window, length), dtype=np.float64)
        except ValueError as error:
            raise InputError("unknown window", where="window", value=window, remedy='use "hann"') from error
    values = as_reals(window, "window", ndim=1)
    if values.size != length:
        raise InputError(f"{values.size} values for a segment of {length}", where="window")
    if not np.any(values):
        raise InputError("is zero everywhere", where="window")
    return values


def independent_lines(covariance: Reals, weight: Reals, *, estimated: bool = False) -> float:
    """Number of independent lines that a weighted sum of neighbouring lines is worth.

    Parameters
    ----------
    covariance : ndarray, shape (lags + 1,)
        Of :meth:`Segments.line_covariance`; zero beyond.
    weight : ndarray, shape (n,)
        Each line's part of the sum.
    estimated : bool
        Whether the parts hold powers that are themselves estimates: their products are then too large, by
        1 + covariance in the mean, and that is taken off.

    Returns
    -------
    float
        (sum w)^2 / sum_jk w_j w_k c(j - k) / c(0): n for equal weights and independent lines.
    """
    reach = min(covariance.size, weight.size)
    products = np.array([np.dot(weight[: weight.size - d], weight[d:]) for d in range(reach)])
    products[1:] *= 2.0
    square = weight.sum() ** 2
    if not estimated:
        return float(square * covariance[0] / np.dot(covariance[:reach], products))
    spread = float(np.dot(covariance[:reach] / (1.0 + covariance[:reach]), products))
    return float((square - spread) / spread * covariance[0])


def segment_for_peak(bandwidth_Hz: float, averages: float, *, coherence: float = 0.5, share: float = 0.3) -> float:
    """Shortest segment in s that keeps the bias at a narrow peak below a share of the random error.

    With the mean square width 1 / (3 T^2) of a Hann window in frequency, a resonance of half-power bandwidth B
    loses 4/3 (1 / (B T))^2 of its power (Bendat and Piersol 2010, chapter 8). What the response function
    varies by within the window, S_xx |H'|^2 / (3 T^2) with |H'| = 2 |H| / B at the peak, passes for noise: the
    residual power, and with it the coherence and the likelihood of the cross-spectral matrix, is wrong by the
    same 4/3 (1 / (B T))^2 times g2 / (1 - g2) (ibid., chapter 9). Random errors are 1 / sqrt(K).

    Parameters
    ----------
    bandwidth_Hz : float
        Half-power bandwidth of the narrowest peak, 2 zeta f.
    averages : float
        K.
    coherence : float
        True coherence at the peak, if coherence or likelihood matter; up to 0.5 it sets no further demand.
    share : float
        Bias allowed, in standard errors; 0.3 costs a 95 % interval about one per cent of coverage.
    """
    width = check_positive(bandwidth_Hz, "bandwidth_Hz")
    if not 0.0 <= coherence < 1.0:
        raise InputError("must lie in [0, 1)", where="coherence", value=coherence)
    ratio = check_positive(averages, "averages") ** 0.5 / check_positive(share, "share")
    return float((4.0 / 3.0 * ratio * max(1.0, coherence / (1.0 - coherence))) ** 0.5 / width)
