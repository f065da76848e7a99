"""What turns with the wheel and what the track's geometry gives: components tied to distance, by speed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy import signal, special
from scipy.interpolate import make_interp_spline

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.estimates.checks import as_reals, check_level, check_names, check_positive, check_units
from permway.recordings.estimates.welch import labelled

_TIME_BANDWIDTH = 4.0
_TAPERS = 5
"""Tapers that keep all but 6e-4 of their energy within NW / T to either side; the next let out 7e-3 and 6e-2."""

_FINER = 4


def travelled(speed_m_per_s: ArrayLike, *, sampling_Hz: float, samples: int | None = None) -> Reals:
    """Distance at each sample, from a constant speed or one at each sample, by the trapezium rule.

    Parameters
    ----------
    speed_m_per_s : array_like, scalar or shape (sample,)
    sampling_Hz : float
    samples : int, optional
        Needed with a constant speed.

    Returns
    -------
    ndarray, shape (sample,)
        m, from 0.
    """
    speed = as_reals(speed_m_per_s, "speed_m_per_s")
    rate = check_positive(sampling_Hz, "sampling_Hz")
    if speed.ndim == 0:
        if samples is None:
            raise InputError("needed with a constant speed", where="samples")
        speed = np.full(samples, float(speed))
    if speed.ndim != 1 or speed.size < 2 or (samples is not None and speed.size != samples):
        raise InputError(f"{speed.shape} values for {samples} samples", where="speed_m_per_s")
    if np.any(speed <= 0.0):
        index = int(np.argmax(speed <= 0.0))
        raise InputError(
            "must be above zero: a standing train has no orders",
            where=f"speed_m_per_s[{index}]",
            value=float(speed[index]),
            remedy="cut the record to where the train runs",
        )
    return np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))]) / rate


def wheel_orders(diameter_m: float, orders: Sequence[int]) -> Reals:
    """Wavelengths pi D / n of a wheel's orders: at a speed V their frequencies are n V / (pi D)."""
    number = as_reals(orders, "orders", ndim=1)
    if np.any(number <= 0.0):
        raise InputError("must be above zero", where="orders", value=float(number.min()))
    return np.asarray(np.pi * check_positive(diameter_m, "diameter_m") / number)


def component_levels(
    record: ArrayLike | xr.DataArray,
    distance_m: ArrayLike,
    wavelength_m: ArrayLike,
    *,
    sampling_Hz: float,
    level: float = 0.95,
    channels: Sequence[str] | None = None,
    units: str | Sequence[str] | None = None,
) -> xr.Dataset:
    """Amplitude of components of known wavelength under the train, and whether they stand out of the noise.

    A component is a cos(2 pi x(t) / lambda + phase), whatever the speed does. The record is turned back by that
    phase and summed under orthogonal tapers; a component adds to them in the ratio of the tapers' sums, noise
    does not: Thomson's (1982, section XIII) harmonic F-test, F(2, 2 K - 2) without a component, for noise that
    is level within NW / T of it. The amplitude's parts along and across are Student's t with 2 K - 2 degrees of
    freedom.

    Parameters
    ----------
    record : array_like, shape (channel, sample) or (sample,)
    distance_m : array_like, shape (sample,)
        Of :func:`travelled`, ascending.
    wavelength_m : array_like, shape (component,)
        pi D / n of a wheel (:func:`wheel_orders`), a sleeper bay, a corrugation.
    sampling_Hz : float
    level : float
        Of the interval.
    channels, units : optional

    Returns
    -------
    xarray.Dataset
        `amplitude` (channel, component), complex, peak, with the phase at distance 0; `rms`, `rms_low`,
        `rms_high`; `statistic` and `probability` of one at least as large by chance; `frequency_low_Hz`,
        `frequency_high_Hz` over the record; `separate`: False where a neighbour of the list lies within the
        tapers' band.

    Raises
    ------
    InputError
        For NaN, shapes that do not fit, or a component beyond half the sampling rate or below the tapers' band.
    """
    samples, names, known = labelled(record)
    values = as_reals(samples[:, :], "record")
    rate = check_positive(sampling_Hz, "sampling_Hz")
    distance = _distances(distance_m, values.shape[1])
    wavelength = as_reals(wavelength_m, "wavelength_m", ndim=1)
    if wavelength.size == 0 or np.any(wavelength <= 0.0):
        raise InputError("must be above zero", where="wavelength_m", value=wavelength.tolist())
    speed = np.diff(distance) * rate
    low, high = speed.min() / wavelength, speed.max() / wavelength
    half_band = _TIME_BANDWIDTH * rate / values.shape[1]
    for index, (bottom, top) in enumerate(zip(low, high, strict=True)):
        if bottom < half_band or top > 0.5 * rate - half_band:
            raise InputError(
                f"{bottom:.4g} to {top:.4g} Hz lies outside {half_band:.3g} to {0.5 * rate - half_band:.5g} Hz, "
                "what a record of this length and rate can resolve",
                where=f"wavelength_m[{index}]",
                value=float(wavelength[index]),
                remedy="leave it out, or take a longer record",
            )
    tapers = np.asarray(signal.windows.dpss(values.shape[1], _TIME_BANDWIDTH, _TAPERS))
    sums = tapers.sum(axis=1)
    sums[1::2] = 0.0
    energy = float(np.sum(sums**2))
    shape = (values.shape[0], wavelength.size)
    mean, noise = np.empty(shape, dtype=np.complex128), np.empty(shape)
    for column, each in enumerate(wavelength):
        turned = (values * np.exp(-2j * np.pi * distance / each)) @ tapers.T
        mean[:, column] = turned @ sums / energy
        rest = turned - mean[:, column, None] * sums
        noise[:, column] = np.sum(np.abs(rest) ** 2, axis=1) / (_TAPERS - 1)
    freedom = 2 * _TAPERS - 2
    statistic = np.divide(np.abs(mean) ** 2 * energy, noise, out=np.full(shape, np.inf), where=noise > 0.0)
    # F(2, nu) exceeds f with probability (1 + 2 f / nu)^(-nu / 2).
    probability = (1.0 + 2.0 * statistic / freedom) ** (-0.5 * freedom)
    rms = np.sqrt(2.0) * np.abs(mean)
    deviation = np.sqrt(noise / energy)
    reach = special.stdtrit(freedom, 0.5 + 0.5 * check_level(level)) * deviation
    middle = np.sqrt(np.maximum(rms**2 - deviation**2, 0.0))
    dims = ("channel", "component")
    table = {
        "amplitude": (2.0 * mean, "amplitude, peak, with the phase at distance 0", "unit"),
        "rms": (rms, "root mean square of the component", "unit"),
        "rms_low": (np.maximum(middle - reach, 0.0), "lower bound", "unit"),
        "rms_high": (middle + reach, "upper bound", "unit"),
        "statistic": (statistic, "F of the component against the noise about it", "1"),
        "probability": (probability, "of a statistic at least as large without a component", "1"),
    }
    return xr.Dataset(
        {name: (dims, data, {"long_name": text, "units": unit}) for name, (data, text, unit) in table.items()},
        coords={
            "channel": check_names(channels if channels is not None else names, values.shape[0]),
            "unit": ("channel", check_units(units if units is not None else known, values.shape[0])),
            "wavelength_m": ("component", wavelength, {"long_name": "wavelength", "units": "m"}),
            "frequency_low_Hz": ("component", low, {"long_name": "lowest frequency", "units": "Hz"}),
            "frequency_high_Hz": ("component", high, {"long_name": "highest frequency", "units": "Hz"}),
            "separate": ("component", _separate(speed.min() / wavelength, half_band), {"units": "1"}),
        },
        attrs={"degrees_of_freedom": freedom, "half_band_Hz": half_band, "level": level, "sampling_Hz": rate},
    )


def _separate(frequency: Reals, half_band: float) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    apart = np.abs(frequency[:, None] - frequency) + np.where(np.eye(frequency.size, dtype=bool), np.inf, 0.0)
    return np.asarray(apart.min(axis=1) > half_band)


def _distances(distance_m: ArrayLike, samples: int) -> Reals:
    distance = as_reals(distance_m, "distance_m", ndim=1)
    if distance.size != samples:
        raise InputError(f"{distance.size} distances for {samples} samples", where="distance_m")
    if samples < 64:
        raise InputError(f"{samples} samples are too few", where="record", remedy="give 64 or more")
    if np.any(np.diff(distance) <= 0.0):
        index = int(np.argmax(np.diff(distance) <= 0.0)) + 1
        raise InputError("must ascend", where=f"distance_m[{index}]", value=float(distance[index]))
    return distance


def resample_to_distance(record: ArrayLike, distance_m: ArrayLike, *, step_m: float) -> Reals:
    """A record at equal steps of distance, for spectra over wavenumber when the speed varies.

    The record is made four times finer by band-limited interpolation, then read by a cubic spline. Where the
    step is coarser than the slowest sample, what it cannot hold is filtered off first (zero phase, Butterworth
    of order eight at 0.8 of half the new rate at the lowest speed).

    Parameters
    ----------
    record : array_like, shape (channel, sample) or (sample,)
    distance_m : array_like, shape (sample,)
    step_m : float

    Returns
    -------
    ndarray, shape (channel, step)
        At distance_m[0] + 0, step_m, 2 step_m, ...
    """
    samples, _, _ = labelled(record)
    values = as_reals(samples[:, :], "record")
    distance = _distances(distance_m, values.shape[1])
    step = check_positive(step_m, "step_m")
    if step > 0.1 * (distance[-1] - distance[0]):
        raise InputError("fewer than ten steps in the record", where="step_m", value=step_m, remedy="shorten it")
    slowest = float(np.diff(distance).min())
    if step > slowest:
        sections = signal.butter(8, 0.8 * slowest / step, output="sos")
        values = signal.sosfiltfilt(sections, values, axis=1)
    finer = signal.resample_poly(values, _FINER, 1, axis=1, padtype="line")[
        :, : _FINER * (values.shape[1] - 1) + 1
    ]
    count = int(np.floor((distance[-1] - distance[0]) / step + 1e-9)) + 1
    place = np.arange(values.shape[1], dtype=np.float64)
    at = make_interp_spline(distance, place, k=3)(distance[0] + step * np.arange(count))
    spline = make_interp_spline(np.arange(finer.shape[1]) / _FINER, finer, k=3, axis=1)
    return np.asarray(spline(np.clip(at, 0.0, place[-1])))
