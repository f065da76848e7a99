"""Power and cross spectra of a record by Welch's method, with what they are worth."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Protocol

import numpy as np
import xarray as xr
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike

from permway._core import __version__
from permway.arrays import Complexes, Reals, real_numbers
from permway.errors import InputError
from permway.recordings.estimates.checks import check_finite, check_names, check_positive, check_units
from permway.recordings.estimates.windows import Segments, segments

_CHUNK = 1 << 21
"""Numbers transformed at once: what is held in memory, whatever the record's length."""

_LAGS = 8


class Samples(Protocol):
    """What can be sliced like an array (channel, sample): an array, a memory map, an HDF5 dataset."""

    @property
    def shape(self) -> tuple[int, ...]:
        """(channels, samples)."""
        ...

    def __getitem__(self, key: Any, /) -> Any:
        """Part of it."""
        ...


def cross_spectra(
    record: ArrayLike | Samples | xr.DataArray,
    *,
    sampling_Hz: float,
    segment_s: float,
    window: str | ArrayLike = "hann",
    overlap: float = 0.5,
    detrend: bool = True,
    channels: Sequence[str] | None = None,
    units: str | Sequence[str] | None = None,
) -> xr.Dataset:
    """Power and cross spectra of all channels, one-sided, per Hz (Welch 1967; Bendat and Piersol 2010).

    Parameters
    ----------
    record : array_like, shape (channel, sample) or (sample,)
        Memory maps and HDF5 datasets are read piece by piece.
    sampling_Hz : float
    segment_s : float
        Length of a segment; the lines are 1 / segment_s apart.
    window : str or array_like
    overlap : float
        Share of a segment that the next repeats.
    detrend : bool
        Whether each segment's mean is taken off.
    channels : sequence of str, optional
        Names; by default those of a DataArray, or numbers.
    units : str or sequence of str, optional
        Unit of each channel.

    Returns
    -------
    xarray.Dataset
        `csd` (channel, channel2, frequency), complex, E[X_channel conj(X_channel2)]; `psd` (channel,
        frequency); `degrees_of_freedom` (frequency) of a power; `usable` (frequency): False where detrending
        took power off; `line_covariance` (lag). Attributes: `averages` K, `segments`, `sampling_Hz`,
        `resolution_Hz`, `duration_s`.

    Raises
    ------
    InputError
        For NaN, a record shorter than a segment, or names and units that do not fit.
    """
    samples, names, known = labelled(record)
    count, length = samples.shape
    layout = segments(length, sampling_Hz=sampling_Hz, segment_s=segment_s, window=window, overlap=overlap)
    total: Complexes = np.zeros((layout.length // 2 + 1, count, count), dtype=np.complex128)
    for transform in transforms(samples, layout, detrend=detrend):
        lines = transform.transpose(2, 0, 1)
        total += lines @ lines.conj().transpose(0, 2, 1)
    total *= scale(layout, sampling_Hz)[:, None, None] / layout.count
    return spectra_dataset(
        total.transpose(1, 2, 0),
        layout=layout,
        sampling_Hz=sampling_Hz,
        detrended=detrend,
        channels=check_names(channels if channels is not None else names, count),
        units=check_units(units if units is not None else known, count),
        window=window if isinstance(window, str) else "given",
        duration_s=length / sampling_Hz,
    )


def labelled(record: ArrayLike | Samples | xr.DataArray) -> tuple[Samples, list[str] | None, list[str] | None]:
    """A record as something with two axes, and the names and units it brings."""
    if isinstance(record, xr.DataArray):
        names = [str(name) for name in record["channel"].values] if "channel" in record.coords else None
        unit = record.attrs.get("units")
        array = record.transpose("channel", ...) if "channel" in record.dims else record
        samples, _, _ = labelled(array.values)
        return samples, names, [str(unit)] * samples.shape[0] if unit is not None else None
    if isinstance(record, list | tuple):
        record = real_numbers(record, "record")
    shape = getattr(record, "shape", None)
    if shape is None or len(shape) not in (1, 2):
        raise InputError(
            "must be (channel, sample) or (sample,)", where="record", value=f"shape {shape}", remedy="reshape it"
        )
    rows: Any = np.asarray(record)[None, :] if len(shape) == 1 else record
    if rows.shape[0] == 0 or rows.shape[1] == 0:
        raise InputError("is empty", where="record", value=f"shape {shape}")
    return rows, None, None


def transforms(samples: Samples, layout: Segments, *, detrend: bool) -> Iterator[Complexes]:
    """Windowed transforms of the segments, (channel, some segments, line), piece by piece."""
    count = samples.shape[0]
    at_once = max(1, _CHUNK // (count * layout.length))
    for first in range(0, layout.count, at_once):
        last = min(first + at_once, layout.count)
        start, stop = first * layout.step, (last - 1) * layout.step + layout.length
        piece = real_numbers(np.asarray(samples[:, start:stop]), "record")
        check_finite(piece, "record", offset=start)
        cut = sliding_window_view(piece, layout.length, axis=1)[:, :: layout.step]
        centred = cut - cut.mean(axis=2, keepdims=True) if detrend else cut
        yield np.fft.rfft(centred * layout.window, axis=2)


def scale(layout: Segments, sampling_Hz: float) -> Reals:
    """From |X|^2 to a one-sided density per Hz: doubled, except at 0 Hz and half the sampling rate."""
    factor = np.full(layout.length // 2 + 1, 2.0 / (sampling_Hz * float(np.sum(layout.window**2))))
    factor[0] *= 0.5
    if layout.length % 2 == 0:
        factor[-1] *= 0.5
    return factor


def spectra_dataset(
    csd: Complexes,
    *,
    layout: Segments,
    sampling_Hz: float,
    detrended: bool,
    channels: list[str],
    units: list[str],
    window: str,
    duration_s: float,
) -> xr.Dataset:
    """Label a cross-spectral matrix (channel, channel2, line) with what it is worth."""
    check_positive(sampling_Hz, "sampling_Hz")
    touched = layout.touched_by_detrending() if detrended else np.zeros(csd.shape[2], dtype=bool)
    covariance = layout.line_covariance(_LAGS)
    power = np.ascontiguousarray(np.einsum("aaf->af", csd).real)
    text = {"long_name": "one-sided power spectral density", "units": "unit^2/Hz"}
    return xr.Dataset(
        {
            "csd": (
                ("channel", "channel2", "frequency"),
                csd,
                {
                    "long_name": "one-sided cross-spectral density",
                    "units": "unit unit2/Hz",
                    "convention": "E[X_channel conj(X_channel2)], exp(+i omega t)",
                },
            ),
            "psd": (("channel", "frequency"), power, text),
            "degrees_of_freedom": (
                "frequency",
                layout.degrees_of_freedom(),
                {"long_name": "degrees of freedom of a power", "units": "1"},
            ),
            "line_covariance": (
                "lag",
                covariance,
                {"long_name": "relative covariance of the powers of two lines, by distance", "units": "1"},
            ),
        },
        coords={
            "channel": channels,
            "channel2": channels,
            "frequency": (
                "frequency",
                np.fft.rfftfreq(layout.length, 1.0 / sampling_Hz),
                {"long_name": "frequency", "units": "Hz"},
            ),
            "lag": ("lag", np.arange(covariance.size), {"long_name": "distance in lines", "units": "1"}),
            "unit": ("channel", units),
            "usable": ("frequency", ~touched, {"long_name": "not touched by detrending", "units": "1"}),
        },
        attrs={
            "averages": layout.averages,
            "segments": layout.count,
            "segment_samples": layout.length,
            "step_samples": layout.step,
            "sampling_Hz": float(sampling_Hz),
            "resolution_Hz": float(sampling_Hz) / layout.length,
            "duration_s": float(duration_s),
            "window": window,
            "permway": __version__,
        },
    )
