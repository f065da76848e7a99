"""Cross spectra of a record that is read in blocks: memory holds a block, whatever the record's length."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import xarray as xr

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.recordings.estimates.welch import scale, spectra_dataset, transforms
from permway.recordings.estimates.windows import Segments, segments
from permway.recordings.record import TimeRecord


def cross_spectra_of(
    blocks: Iterable[TimeRecord],
    *,
    segment_s: float,
    channels: Sequence[str],
    units: Sequence[str],
    band_Hz: tuple[float, float] = (0.0, np.inf),
) -> xr.Dataset:
    """Cross spectra of all blocks as of one record.

    Parameters
    ----------
    blocks : iterable of TimeRecord
        One after the other, of the same channels and rate.
    segment_s : float
    channels, units : sequence of str
        Names and units of the result.
    band_Hz : (float, float)
        Lines by which the level of a segment is known.

    Returns
    -------
    xarray.Dataset
        As :func:`permway.recordings.estimates.welch.cross_spectra` of the whole record, and `level_averages`
        (channel): the averages that a channel's power is worth, whose level varies along the record.

    Raises
    ------
    InputError
        For a record without a sampling rate, or shorter than a segment.
    """
    count, length, rate = len(channels), 0, None
    total = None
    levels: list[Reals] = []
    rest: Reals = np.zeros((count, 0))
    for block in blocks:
        rate = block.sampling_Hz
        if rate is None:
            raise InputError(
                "missing: the file does not say it", where="sampling_Hz", remedy="give it in the record"
            )
        length += len(block)
        rest = np.concatenate([rest, block.values], axis=1)
        if rest.shape[1] < round(segment_s * rate):
            continue
        layout = segments(rest.shape[1], sampling_Hz=rate, segment_s=segment_s)
        if total is None:
            total = np.zeros((layout.length // 2 + 1, count, count), dtype=np.complex128)
            counted = _counted(layout, rate, band_Hz)
        for transform in transforms(rest, layout, detrend=True):
            lines = transform.transpose(2, 0, 1)
            total += lines @ lines.conj().transpose(0, 2, 1)
            levels.append(_logarithms(transform[:, :, counted]))
        rest = rest[:, layout.count * layout.step :]
    if rate is None:
        raise InputError("holds no samples", where="record")
    layout = segments(length, sampling_Hz=rate, segment_s=segment_s)
    assert total is not None
    total *= scale(layout, rate)[:, None, None] / layout.count
    data = spectra_dataset(
        total.transpose(1, 2, 0),
        layout=layout,
        sampling_Hz=rate,
        detrended=True,
        channels=list(channels),
        units=list(units),
        window="hann",
        duration_s=length / rate,
    )
    worth = layout.averages_of(np.concatenate(levels, axis=1), int(counted.sum()))
    text = {"long_name": "averages that a power is worth whose level varies", "units": "1"}
    return data.assign(level_averages=("channel", worth, text))


def _counted(layout: Segments, rate: float, band_Hz: tuple[float, float]) -> np.ndarray:
    """Lines of a band that detrending does not touch; all of these if the band has none."""
    frequency = np.fft.rfftfreq(layout.length, 1.0 / rate)
    usable = ~layout.touched_by_detrending()
    inside = usable & (frequency >= band_Hz[0]) & (frequency <= band_Hz[1])
    return inside if inside.any() else usable


def _logarithms(transform: Complexes) -> Reals:
    """Mean over lines of the logarithm of the power, (channel, segment); silence counts as the least number."""
    power = transform.real**2 + transform.imag**2
    return np.asarray(np.mean(np.log(np.maximum(power, np.finfo(np.float64).tiny)), axis=2))
