"""Levels in one-third octaves from a power spectral density, with their degrees of freedom."""

from __future__ import annotations

import numpy as np
import xarray as xr

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.estimates.bands import Bands, bands_between, bands_within
from permway.recordings.estimates.checks import attribute, check_finite, check_positive, variable
from permway.recordings.estimates.intervals import Interval, power_interval
from permway.recordings.estimates.windows import independent_lines

_FEWEST_LINES = 3.0
"""A band narrower than this many lines is not resolved: the window is as wide as the band."""


def band_levels(
    spectra: xr.Dataset,
    *,
    reference: float,
    from_Hz: float | None = None,
    to_Hz: float | None = None,
    level: float = 0.95,
) -> xr.Dataset:
    """Power in one-third octaves (IEC 61260-1), as level, interval and degrees of freedom.

    A line stands for the frequencies half a line to either side of it and counts in a band by its share. The
    degrees of freedom are twice the squared mean over the variance of the sum, with the covariance of neighbouring
    lines: 2 K times the number of independent lines, fewer where one peak rules the band.

    Parameters
    ----------
    spectra : xarray.Dataset
        Of :func:`permway.recordings.estimates.welch.cross_spectra`.
    reference : float
        Reference value of the level, in the channel's own unit (1e-6 for a level re 1e-6 m/s^2).
    from_Hz, to_Hz : float, optional
        First and last band by mid-band frequency; by default all that are resolved.
    level : float
        Of the interval.

    Returns
    -------
    xarray.Dataset
        `power` (channel, band), unit^2; `level_dB`, `low_dB`, `high_dB`; `degrees_of_freedom`; with `middle_Hz`,
        `low_Hz`, `high_Hz` and `lines` along `band`, whose coordinate is the nominal frequency.

    Raises
    ------
    InputError
        For a band asked for that the spectrum does not reach or resolve.
    """
    unit = check_positive(reference, "reference")
    psd = variable(spectra, "psd", "spectra").transpose("channel", "frequency")
    covariance: Reals = variable(spectra, "line_covariance", "spectra").values
    step = attribute(spectra, "resolution_Hz", "spectra")
    frequency: Reals = psd["frequency"].values
    check_finite(psd.values, "spectra.psd")
    bands = chosen_bands(frequency, spectra["usable"].values, step, from_Hz, to_Hz)
    edges = np.append(frequency - 0.5 * step, frequency[-1] + 0.5 * step)
    share = bands.weights(edges)
    power = psd.values @ share.T * step
    freedom = np.empty_like(power)
    for row, line_power in enumerate(psd.values):
        for column, weight in enumerate(share):
            held = weight > 0.0
            part = weight[held] * line_power[held]
            if part.sum() > 0.0:
                alike = independent_lines(covariance, part, estimated=True)
            else:
                alike = independent_lines(covariance, weight[held])
            freedom[row, column] = 2.0 * alike / covariance[0]
    interval = power_interval(power, freedom, level=level)
    return band_dataset(
        power,
        freedom,
        interval,
        bands=bands,
        reference=unit,
        level=level,
        lines=share.sum(axis=1),
        spectra=spectra,
    )


def chosen_bands(
    frequency: Reals, usable: np.ndarray, step: float, from_Hz: float | None, to_Hz: float | None
) -> Bands:
    """Bands that a spectrum resolves, or those asked for if it resolves them all."""
    good = frequency[np.asarray(usable, dtype=bool)]
    if good.size == 0:
        raise InputError("no usable line", where="spectra", remedy="lengthen the segments")
    bottom, top = float(good[0] - 0.5 * step), float(good[-1] + 0.5 * step)
    narrowest = _FEWEST_LINES * step / (10.0**0.05 - 10.0**-0.05)
    possible = bands_within(max(bottom, narrowest * 10.0**-0.05), min(top, float(frequency[-1])))
    if from_Hz is None and to_Hz is None:
        asked = possible
    else:
        ends = possible.middle_Hz if possible.number.size else np.array([narrowest])
        asked = bands_between(
            float(ends[0]) if from_Hz is None else from_Hz, float(ends[-1]) if to_Hz is None else to_Hz
        )
    missing = np.setdiff1d(asked.number, possible.number)
    if missing.size or not asked.number.size:
        worst = Bands(number=missing if missing.size else np.array([round(10.0 * np.log10(narrowest))]))
        width = float(worst.high_Hz[0] - worst.low_Hz[0])
        raise InputError(
            f"the spectrum, {bottom:.4g} to {top:.4g} Hz in steps of {step:.4g} Hz, does not resolve this band",
            where="from_Hz, to_Hz",
            value=f"{worst.label[0]} Hz",
            remedy=f"take segments of {_FEWEST_LINES / width:.3g} s or longer, or other bands",
        )
    return asked


def band_dataset(
    power: Reals,
    freedom: Reals,
    interval: Interval,
    *,
    bands: Bands,
    reference: float,
    level: float,
    lines: Reals,
    spectra: xr.Dataset,
) -> xr.Dataset:
    """Label band powers with levels, frequencies and units."""
    dims = ("channel", "band")
    note = {"units": "dB", "reference": reference}

    def decibel(values: Reals) -> Reals:
        with np.errstate(divide="ignore"):
            return np.asarray(10.0 * np.log10(values / reference**2))

    return xr.Dataset(
        {
            "power": (dims, power, {"long_name": "mean square in the band", "units": "unit^2"}),
            "level_dB": (dims, decibel(power), {"long_name": "level", **note}),
            "low_dB": (dims, decibel(interval.low), {"long_name": "lower bound of the level", **note}),
            "high_dB": (dims, decibel(interval.high), {"long_name": "upper bound of the level", **note}),
            "degrees_of_freedom": (dims, freedom, {"long_name": "degrees of freedom of the power", "units": "1"}),
        },
        coords={
            "channel": spectra["channel"].values,
            "unit": ("channel", spectra["unit"].values),
            **band_coordinates(bands),
            "lines": ("band", lines, {"long_name": "lines in the band", "units": "1"}),
        },
        attrs={**spectra.attrs, "level": level, "reference": reference, "bands": "one-third octave, IEC 61260-1"},
    )


def band_coordinates(bands: Bands) -> dict[str, tuple[str, Reals, dict[str, str]]]:
    """Coordinates along `band`: nominal, exact, lower and upper frequency."""
    table = {
        "band": ("nominal mid-band frequency", bands.nominal_Hz),
        "middle_Hz": ("exact mid-band frequency", bands.middle_Hz),
        "low_Hz": ("lower edge of the band", bands.low_Hz),
        "high_Hz": ("upper edge of the band", bands.high_Hz),
    }
    return {name: ("band", values, {"long_name": text, "units": "Hz"}) for name, (text, values) in table.items()}
