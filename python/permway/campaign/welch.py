"""Cross spectra of a record that is read in blocks: memory holds a block, whatever the record's length."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import xarray as xr

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.estimates.welch import scale, spectra_dataset, transforms
from permway.recordings.estimates.windows import segments
from permway.recordings.record import TimeRecord


def cross_spectra_of(
    blocks: Iterable[TimeRecord], *, segment_s: float, channels: Sequence[str], units: Sequence[str]
) -> xr.Dataset:
    """Cross spectra of all blocks as of one record.

    Parameters
    ----------
    blocks : iterable of TimeRecord
        One after the other, of the same channels and rate.
    segment_s : float
    channels, units : sequence of str
        Names and units of the result.

    Returns
    -------
    xarray.Dataset
        As :func:`permway.recordings.estimates.welch.cross_spectra` of the whole record.

    Raises
    ------
    InputError
        For a record without a sampling rate, or shorter than a segment.
    """
    count, length, rate = len(channels), 0, None
    total = None
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
        for transform in transforms(rest, layout, detrend=True):
            lines = transform.transpose(2, 0, 1)
            total += lines @ lines.conj().transpose(0, 2, 1)
        rest = rest[:, layout.count * layout.step :]
    if rate is None:
        raise InputError("holds no samples", where="record")
    layout = segments(length, sampling_Hz=rate, segment_s=segment_s)
    assert total is not None
    total *= scale(layout, rate)[:, None, None] / layout.count
    return spectra_dataset(
        total.transpose(1, 2, 0),
        layout=layout,
        sampling_Hz=rate,
        detrended=True,
        channels=list(channels),
        units=list(units),
        window="hann",
        duration_s=length / rate,
    )
