"""One-third octave levels over time by a bank of class 1 filters, for pass-bys."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy import signal

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.estimates.bands import Bands, bands_between, class1_limits
from permway.recordings.estimates.checks import as_reals, check_names, check_positive, check_units
from permway.recordings.estimates.intervals import power_interval
from permway.recordings.estimates.third_octaves import band_coordinates
from permway.recordings.estimates.welch import labelled

_ORDERS = (3, 4)
"""Of the Butterworth low-pass behind it: six poles keep class 1, eight do so near half the sampling rate."""

_SETTLED = 1e-3
"""A filter is settled when this share of its impulse response's energy is still to come."""


def band_filter(number: int, sampling_Hz: float) -> Reals:
    """Second-order sections of the Butterworth filter of one band, checked against the class 1 mask.

    Parameters
    ----------
    number : int
        Of the band, 10 lg(mid-band / Hz).
    sampling_Hz : float

    Returns
    -------
    ndarray, shape (3 or 4, 6)

    Raises
    ------
    InputError
        If the band lies too near half the sampling rate, or so far below it that rounding spoils the filter.
    """
    return _filter(int(number), check_positive(sampling_Hz, "sampling_Hz")).copy()


@lru_cache(maxsize=256)
def _filter(number: int, sampling_Hz: float) -> Reals:
    band = Bands(number=np.array([number]))
    low, high, middle = float(band.low_Hz[0]), float(band.high_Hz[0]), float(band.middle_Hz[0])
    for order in _ORDERS if high < 0.5 * sampling_Hz else ():
        sections = np.asarray(signal.butter(order, [low, high], "bandpass", fs=sampling_Hz, output="sos"))
        ratio = np.concatenate([np.geomspace(1.0 / 30.0, 30.0, 1201), np.geomspace(0.85, 1.18, 601)])
        ratio = ratio[ratio * middle < 0.4999 * sampling_Hz]
        _, response = signal.sosfreqz(sections, ratio * middle, fs=sampling_Hz)
        with np.errstate(divide="ignore"):
            attenuation = -20.0 * np.log10(np.abs(response))
        least, most = class1_limits(ratio)
        if np.all((least <= attenuation) & (attenuation <= most)):
            return sections
    raise InputError(
        f"no class 1 filter for the band of {band.label[0]} Hz at {sampling_Hz:g} samples per second",
        where="from_Hz, to_Hz",
        value=middle,
        remedy="sample at 2.5 to 1e7 times the mid-band frequency, or leave the band out",
    )


def band_levels_over_time(
    record: ArrayLike | xr.DataArray,
    *,
    sampling_Hz: float,
    from_Hz: float,
    to_Hz: float,
    interval_s: float,
    reference: float,
    level: float = 0.95,
    channels: Sequence[str] | None = None,
    units: str | Sequence[str] | None = None,
) -> xr.Dataset:
    """Mean squares of the filtered record over intervals one after the other.

    The degrees of freedom are those of the mean square over M samples of Gaussian noise, flat within the band,
    M / (1 + 2 sum (1 - m/M) rho_m^2), rho the autocorrelation that the filter gives it (Bendat and Piersol 2010,
    chapter 8): 2.5 B T once B T is large.

    Parameters
    ----------
    record : array_like, shape (channel, sample) or (sample,)
    sampling_Hz : float
    from_Hz, to_Hz : float
        First and last band by mid-band frequency.
    interval_s : float
    reference : float
        Of the level, in the channel's unit.
    level : float
        Of the interval.
    channels, units : optional

    Returns
    -------
    xarray.Dataset
        `power` (channel, band, time), unit^2, with `level_dB`, `low_dB`, `high_dB`; `degrees_of_freedom` (band);
        `settled` (band, time): False while the filter still swings in. Times are middles of intervals.

    Raises
    ------
    InputError
        For NaN, a record shorter than an interval, or a band no class 1 filter serves.
    """
    samples, names, known = labelled(record)
    values = as_reals(samples[:, :], "record")
    rate, unit = check_positive(sampling_Hz, "sampling_Hz"), check_positive(reference, "reference")
    length = round(check_positive(interval_s, "interval_s") * rate)
    count = values.shape[1] // length if length else 0
    if count < 1:
        raise InputError(
            f"{values.shape[1]} samples do not fill an interval of {length}",
            where="interval_s",
            value=interval_s,
            remedy="shorten it to a sample at least and the record at most",
        )
    bands = bands_between(from_Hz, to_Hz)
    power = np.empty((values.shape[0], bands.number.size, count))
    freedom, settling = np.empty(bands.number.size), np.empty(bands.number.size)
    for column, number in enumerate(bands.number):
        sections = band_filter(int(number), rate)
        filtered = signal.sosfilt(sections, values, axis=1)[:, : count * length]
        power[:, column] = np.mean(filtered.reshape(-1, count, length) ** 2, axis=2)
        freedom[column], settling[column] = _mean_square_freedom(
            sections, length, float(bands.low_Hz[column]) / rate
        )
    dims = ("channel", "band", "time")
    interval = power_interval(power, freedom[:, None], level=level)
    with np.errstate(divide="ignore"):
        levels = {
            name: (dims, 10.0 * np.log10(part / unit**2), {"units": "dB", "reference": unit, "long_name": text})
            for name, part, text in (
                ("level_dB", power, "level"),
                ("low_dB", interval.low, "lower bound of the level"),
                ("high_dB", interval.high, "upper bound of the level"),
            )
        }
    start = np.arange(count) * length
    return xr.Dataset(
        {
            "power": (dims, power, {"long_name": "mean square in the band", "units": "unit^2"}),
            **levels,
            "degrees_of_freedom": (
                "band",
                freedom,
                {"long_name": "degrees of freedom of the power", "units": "1"},
            ),
        },
        coords={
            "channel": check_names(channels if channels is not None else names, values.shape[0]),
            "unit": ("channel", check_units(units if units is not None else known, values.shape[0])),
            **band_coordinates(bands),
            "time": ("time", (start + 0.5 * length) / rate, {"long_name": "middle of the interval", "units": "s"}),
            "settled": (
                ("band", "time"),
                start >= settling[:, None],
                {"long_name": "filter settled", "units": "1"},
            ),
        },
        attrs={
            "sampling_Hz": rate,
            "interval_s": length / rate,
            "reference": unit,
            "level": level,
            "bands": "one-third octave, IEC 61260-1 class 1, Butterworth",
        },
    )


def _mean_square_freedom(sections: Reals, length: int, low: float) -> tuple[float, float]:
    """Degrees of freedom of a mean square over `length` samples, and samples until the filter has settled."""
    reach = int(np.ceil(20.0 / low))
    impulse = np.zeros(reach)
    impulse[0] = 1.0
    response = signal.sosfilt(sections, impulse)
    left = 1.0 - np.cumsum(response**2) / np.sum(response**2)
    correlation = signal.fftconvolve(response, response[::-1])[reach - 1 :]
    lags = np.arange(1, min(length, reach))
    square = (correlation[lags] / correlation[0]) ** 2
    freedom = length / (1.0 + 2.0 * float(np.dot(1.0 - lags / length, square)))
    return freedom, float(np.argmax(left < _SETTLED))
