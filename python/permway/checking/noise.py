"""Noise floors that nobody stated, from the quietest lines of the records."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign
from permway.campaign.load import Dataset
from permway.checking.blunder import Blunder
from permway.checking.compared import Compared

QUIET = 0.1
"""Share of the lines that count as quiet. Half of it makes the estimate scatter, twice lifts it."""

SURELY = 4
"""Averages beyond the number of channels from which what channels share can be taken out."""


SEEN = 0.5
"""Share of quiet lines' power that is neither shared nor predicted, from which it is called noise."""


def noise_floors(
    campaign: Campaign, datasets: Sequence[Dataset], compared: Mapping[str, Compared]
) -> Iterator[Blunder]:
    """Channels of runs whose noise is not stated, with the density of their quietest lines.

    Where other channels are there, what they share is taken out first: noise is what no other channel knows of.
    The figure holds everything that is not shared, and is the most that the noise can be.

    Parameters
    ----------
    campaign : Campaign
    datasets : sequence of Dataset
        All lines.
    compared : mapping of record to Compared
        Beside the model, put right by what was found.
    """
    for dataset in datasets:
        if not dataset.record.spectral:
            continue
        beside = compared.get(dataset.record.name)
        for name, (density, unshared_share) in quietest(dataset).items():
            sensor = campaign.sensor(name)
            if sensor.chain.noise_floor or sensor.chain.noise_flicker or not density > 0.0:
                continue
            stated = density / sensor.to_SI**2
            where = f"records.{dataset.record.name}: {name}"
            if unshared_share > SEEN and _predicted(beside, name) > SEEN:
                what = f"no noise floor is stated, and none shows: it is below {stated:.2g} ({sensor.unit})2/Hz"
                remedy = f'sensors "{name}": chain = {{ noise_floor = ... }} by its data sheet'
            else:
                what = (
                    f"no noise floor is stated; in its quietest lines is at most {stated:.2g} ({sensor.unit})2/Hz"
                )
                remedy = f'sensors "{name}": chain = {{ noise_floor = {stated:.2g} }}, or less by its data sheet'
            yield Blunder("noise_floor", where, what, remedy, asked=True)


def _predicted(beside: Compared | None, name: str) -> float:
    """Share of a channel's power in its quiet lines that the model predicts; 0 where it predicts none."""
    if beside is None or name not in beside.channels:
        return 0.0
    row = beside.channels.index(name)
    measured, predicted = np.abs(beside.measured[row]) ** 2, np.abs(beside.predicted[row]) ** 2
    quiet = np.argsort(measured)[: max(3, round(QUIET * measured.size))]
    return float(np.median(predicted[quiet] / measured[quiet]))


def quietest(dataset: Dataset) -> dict[str, tuple[float, float]]:
    """Density of the quietest lines by channel, one-sided in SI, and its share of all power in them."""
    csd = np.moveaxis(np.asarray(dataset.data["csd"].values, dtype=np.complex128), -1, 0)
    density, power = unshared(csd, float(dataset.data.attrs["averages"])), np.einsum("fcc->fc", csd).real
    count = max(1, round(QUIET * density.shape[0]))
    at = np.argsort(density, axis=0)[:count]
    lowest, whole = (np.take_along_axis(values, at, axis=0).mean(axis=0) for values in (density, power))
    pairs = zip(lowest.tolist(), (lowest / np.maximum(whole, 1e-300)).tolist(), strict=True)
    return dict(zip(dataset.names("channel"), pairs, strict=True))


def unshared(csd: Complexes, averages: float) -> Reals:
    """Power of each channel that is in no other, shape (F, channels), from cross spectra (F, channels, channels).

    The inverse of the diagonal of the inverse; of an estimate of n averages it is low by (n - q + 1) / n, with q
    channels (Muirhead, Aspects of Multivariate Statistical Theory, 1982, theorem 3.2.10).
    """
    power = np.einsum("fcc->fc", csd).real
    channels = csd.shape[1]
    if channels < 2 or averages < channels + SURELY:
        return np.asarray(power)
    scale = np.sqrt(power)
    with np.errstate(divide="ignore", invalid="ignore"):
        shared = csd / (scale[:, :, None] * scale[:, None, :])
    usable = np.isfinite(shared).all(axis=(1, 2))
    left = np.ones_like(power)
    # Channels that are one to twelve digits share all.
    inverse = np.linalg.inv(shared[usable] + 1e-12 * np.eye(channels))
    left[usable] = 1.0 / np.maximum(np.einsum("fcc->fc", inverse).real, 1.0)
    return np.asarray(power * left * averages / (averages - channels + 1.0))
