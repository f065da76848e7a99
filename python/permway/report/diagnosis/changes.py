"""How much better: each record's deviations recalibrated and amended, side by side."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from permway.arrays import Reals
from permway.diagnosis.result import Diagnosis

MOST_CURVES = 6
"""Channels that are drawn, at most."""


@dataclass(frozen=True)
class Change:
    """A record before and after the amendment.

    Attributes
    ----------
    name : str
    before, after : Dataset
        The record as :func:`permway.campaign.compare.curves` has it; `after` is None without an amendment.
    before_dB, after_dB : DataArray (channel, band)
        Deviations in one-third octaves; `after_dB` is None without an amendment.
    """

    name: str
    before: xr.Dataset
    after: xr.Dataset | None
    before_dB: xr.DataArray
    after_dB: xr.DataArray | None

    def mean_square(self) -> tuple[Reals, Reals | None]:
        """Of deviations in one-third octaves by channel, dB2; NaN where no band states anything."""
        before = _mean_square(self.before_dB)
        return before, None if self.after_dB is None else _mean_square(self.after_dB)

    def worth(self) -> Reals:
        """By channel: how much its mean square changed, dB2; without an amendment the mean square itself."""
        before, after = self.mean_square()
        return np.asarray(np.abs(before - (0.0 if after is None else after)))

    def gain(self) -> Reals:
        """By channel: by how much its mean square fell, dB2; without an amendment the mean square itself."""
        before, after = self.mean_square()
        return np.asarray(before - (0.0 if after is None else after))

    def order(self) -> list[int]:
        """Channels by how much they changed; without an amendment by how much they deviate."""
        worth = self.worth()
        return [int(i) for i in np.argsort(-np.where(np.isfinite(worth), worth, -1.0), kind="stable")]


def most_changed(every: Sequence[Change]) -> list[tuple[str, int]]:
    """Records and channels that changed most: of each sensor its own first, then the others."""
    ranked = []
    for change in every:
        worth, met = change.worth(), set[str]()
        for channel in change.order():
            sensor = str(change.before["sensor"].values[channel])
            if np.isfinite(worth[channel]):
                ranked.append((sensor in met, -float(worth[channel]), change.name, channel))
            met.add(sensor)
    return [(name, channel) for _, _, name, channel in sorted(ranked)[:MOST_CURVES]]


def changes(diagnosis: Diagnosis) -> list[Change]:
    """Every record of the comparison, with what the amendment made of it where that is known."""
    amended: dict[str, tuple[xr.Dataset, xr.DataArray]] = {}
    if diagnosis.after is not None:
        for record, bands in zip(diagnosis.after.records, _last(diagnosis.after.bands), strict=True):
            amended[str(record.attrs["record"])] = (record, bands)
    found = []
    for record, bands in zip(diagnosis.comparison.records, _last(diagnosis.comparison.bands), strict=True):
        name = str(record.attrs["record"])
        if name in amended:
            after, after_dB = amended[name]
            same = after_dB.reindex(channel=bands["channel"], band=bands["band"])
            found.append(Change(name, record, after, bands, same))
        else:
            found.append(Change(name, record, None, bands, None))
    return found


def _last(bands: tuple[xr.Dataset, ...]) -> Iterator[xr.DataArray]:
    """Of the last model, which is the best."""
    for one in bands:
        yield one["deviation_dB"].isel(model=-1)


def _mean_square(deviation: xr.DataArray) -> Reals:
    there = np.isfinite(deviation.values)
    total = (np.where(there, deviation.values, 0.0) ** 2).sum(axis=1)
    return np.asarray(total / np.where(there.any(axis=1), there.sum(axis=1), np.nan))
