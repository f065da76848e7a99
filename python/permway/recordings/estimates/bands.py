"""One-third octave bands to IEC 61260-1: exact and nominal frequencies, and the class 1 mask."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.estimates.checks import as_reals, check_positive

OCTAVE_RATIO = 10.0**0.3
"""G of IEC 61260-1:2014."""

_NOMINAL = (1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0)

_CLASS_1 = (
    # octaves from mid-band, least and greatest attenuation in dB
    (0.0, -0.4, 0.4),
    (1 / 8, -0.4, 0.5),
    (1 / 4, -0.4, 0.7),
    (3 / 8, -0.4, 1.4),
    (1 / 2, -0.4, 5.3),
    (1 / 2, 1.2, np.inf),
    (1.0, 16.6, np.inf),
    (2.0, 40.5, np.inf),
    (3.0, 60.0, np.inf),
    (4.0, 70.0, np.inf),
)
"""IEC 61260-1:2014, table 1, class 1 acceptance limits of relative attenuation, for octave bands."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Bands:
    """One-third octave bands, ascending and without gaps.

    Parameters
    ----------
    number : ndarray of int, shape (B,)
        10 lg(mid-band / 1 Hz): 30 is 1 kHz.
    """

    number: NDArray[np.int64]

    @property
    def middle_Hz(self) -> Reals:
        """Exact mid-band frequencies, 1000 G^(x / 3)."""
        return np.asarray(10.0 ** (self.number / 10.0))

    @property
    def low_Hz(self) -> Reals:
        """Lower edges, G^(-1/6) of the middle."""
        return np.asarray(10.0 ** (self.number / 10.0 - 0.05))

    @property
    def high_Hz(self) -> Reals:
        """Upper edges, G^(1/6) of the middle."""
        return np.asarray(10.0 ** (self.number / 10.0 + 0.05))

    @property
    def nominal_Hz(self) -> Reals:
        """Nominal mid-band frequencies (annex E): 1, 1.25, 1.6, 2, 2.5, 3.15, 4, 5, 6.3, 8 and their decades."""
        decade, step = np.divmod(self.number, 10)
        return np.array([round(_NOMINAL[s] * 10.0**d, 10) for d, s in zip(decade, step, strict=True)])

    @property
    def label(self) -> list[str]:
        """Nominal frequencies as text, "1.25k" for 1250 Hz."""
        return [f"{f / 1000.0:g}k" if f >= 1000.0 else f"{f:g}" for f in self.nominal_Hz]

    def weights(self, edges_Hz: Reals) -> Reals:
        """Share of each cell of frequency that lies in each band, shape (B, cells), from the cells' edges."""
        low = np.maximum(self.low_Hz[:, None], edges_Hz[:-1])
        high = np.minimum(self.high_Hz[:, None], edges_Hz[1:])
        return np.asarray(np.maximum(high - low, 0.0) / np.diff(edges_Hz))


def band_of(frequency_Hz: float) -> int:
    """Number of the band in which a frequency, nominal or not, lies."""
    return round(10.0 * float(np.log10(check_positive(frequency_Hz, "frequency_Hz"))))


def bands_between(from_Hz: float, to_Hz: float) -> Bands:
    """The bands from one named by a frequency to another, both included."""
    first, last = band_of(from_Hz), band_of(to_Hz)
    if last < first:
        raise InputError("ends before it begins", where="from_Hz, to_Hz", value=[from_Hz, to_Hz])
    return Bands(number=np.arange(first, last + 1))


def bands_within(low_Hz: float, high_Hz: float) -> Bands:
    """The bands that lie whole between two frequencies; none if there are none."""
    first = int(np.ceil(10.0 * np.log10(max(low_Hz, 1e-6)) + 0.5 - 1e-9))
    last = int(np.floor(10.0 * np.log10(max(high_Hz, 1e-6)) - 0.5 + 1e-9))
    return Bands(number=np.arange(first, max(last + 1, first)))


def class1_limits(ratio: ArrayLike, *, bands_per_octave: int = 3) -> tuple[Reals, Reals]:
    """Least and greatest relative attenuation of a class 1 filter (IEC 61260-1:2014, 5.10 and table 1).

    The octave's breakpoints are brought to 1/b octave by Omega' = 1 + (G^(1/2b) - 1) / (G^(1/2) - 1) (Omega - 1)
    above mid-band and its reciprocal below; between them limits run straight over lg.

    Parameters
    ----------
    ratio : array_like
        Frequency over exact mid-band frequency.
    bands_per_octave : int

    Returns
    -------
    tuple of ndarray
        dB; the greatest is infinite outside the band.
    """
    distance = as_reals(ratio, "ratio")
    if np.any(distance <= 0.0):
        raise InputError("must be above zero", where="ratio", value=float(distance.min()))
    table = np.array(_CLASS_1)
    shrink = (OCTAVE_RATIO ** (0.5 / bands_per_octave) - 1.0) / (OCTAVE_RATIO**0.5 - 1.0)
    points = np.log(1.0 + shrink * (OCTAVE_RATIO ** table[:, 0] - 1.0))
    off = np.abs(np.log(distance))
    inside = off < points[4]
    passing = np.interp(off, points[:5], table[:5, 2])
    stopping = np.interp(off, points[5:], table[5:, 1])
    return np.where(inside, -0.4, stopping), np.where(inside, passing, np.inf)
