"""A campaign's records, read and made ready to be compared with models."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from permway.campaign.bad_channels import BadChannel, without_bad_channels
from permway.campaign.campaign import Campaign
from permway.campaign.kinds import kind_of
from permway.campaign.load import Dataset
from permway.campaign.predict import predict, why_not
from permway.diagnosis.block_of import block_of
from permway.diagnosis.blocks_noise import NoiseBlock
from permway.diagnosis.frf_lines import LINES_PER_FREQUENCY, thinned
from permway.diagnosis.observations import Observations
from permway.errors import InputError

NOT_MEASURED = "was not measured: the file has no such pair"
"""Of a pair of a sensor and a force point."""


class Readable(NamedTuple):
    """What of a campaign's records can be used.

    Attributes
    ----------
    kept : list of Dataset
    left_out : dict of str to str
        Why not, by name of a record, or of a record and its channel.
    bad : tuple of BadChannel
        Channels that are left out because their samples are no measurement.
    """

    kept: list[Dataset]
    left_out: dict[str, str]
    bad: tuple[BadChannel, ...]


def predictable(campaign: Campaign, *, screened: bool = True) -> Readable:
    """Read a campaign's records: those that can be predicted, and of the others why not.

    Parameters
    ----------
    campaign : Campaign
    screened : bool
        Whether channels that screening finds bad are left out.

    Raises
    ------
    InputError
        If none can be predicted, all are bad, or a file cannot be read.
    """
    whole, bad = without_bad_channels(campaign) if screened else (campaign, ())
    datasets = whole.load()
    reasons = {dataset.record.name: why_not(campaign, dataset) for dataset in datasets}
    left_out = {name: str(why) for name, why in reasons.items() if why is not None}
    kept = [dataset for dataset in datasets if reasons[dataset.record.name] is None]
    if not kept:
        name, why = next(iter(left_out.items()))
        raise InputError("no record can be predicted", where=f"records.{name}", remedy=why)
    left_out |= {f"{one.record}: {one.channel}": f"{one.kind}: {one.what}" for one in bad}
    for dataset in kept:
        missing = kind_of(dataset.record).unmeasured(dataset)
        left_out |= {f"{dataset.record.name}: {pair}": NOT_MEASURED for pair in missing}
    return Readable(kept, left_out, bad)


def gather(
    campaign: Campaign,
    datasets: Sequence[Dataset] | None = None,
    *,
    threads: int | None = None,
    lines: float = LINES_PER_FREQUENCY,
) -> Observations:
    """Read a campaign's records and make them ready to be compared with models.

    Parameters
    ----------
    campaign : Campaign
    datasets : sequence of Dataset, optional
        By default those of the campaign's files.
    threads : int, optional
        Of the solver.
    lines : float
        Of a frequency response within its own frequency, at most.

    Raises
    ------
    InputError
        From reading, or for a record that cannot be predicted.
    """
    observations = _blocked(campaign, campaign.load() if datasets is None else datasets, threads, lines)
    sources = observations.columns.sources
    return observations.with_sizes({o.name: 1.0 if o.fixed else first_size(campaign, o.name) for o in sources})


def observations_of(campaign: Campaign, datasets: Sequence[Dataset], like: Observations) -> Observations:
    """Datasets that need not be of the campaign's files, with the sizes of calibration errors that another has."""
    observations = _blocked(campaign, datasets, like.threads)
    estimated = [like.sizes[o.name] for o in like.columns.sources if not o.fixed]
    usual = float(np.median(estimated)) if estimated else first_size(campaign, "")
    sizes = {o.name: 1.0 if o.fixed else like.sizes.get(o.name, usual) for o in observations.columns.sources}
    return observations.with_sizes(sizes, like.length)


def _blocked(
    campaign: Campaign, datasets: Sequence[Dataset], threads: int | None, lines: float = LINES_PER_FREQUENCY
) -> Observations:
    """Records whose calibration errors have no sizes yet."""
    loaded = [thinned(dataset, lines) for dataset in datasets]
    predicted = predict(campaign, loaded, threads=threads)
    spans = _spans(loaded)
    blocks = [
        block_of(campaign, dataset, prediction, spans)
        for dataset, prediction in zip(loaded, predicted, strict=True)
    ]
    for block in blocks:
        if not block.is_usable:
            raise InputError(
                "no line of it can be used",
                where=f"records.{block.dataset.record.name}",
                remedy="look at its coherence, its units and its band",
            )
    # Of several tests by the same sensors each has the same noise.
    tests = {tuple(d.names("sensor")): d for d in reversed(loaded) if NoiseBlock.is_constrained(d)}
    blocks += [NoiseBlock(dataset) for dataset in tests.values()]
    return Observations(campaign, tuple(blocks), {}, threads=threads)


def _spans(datasets: Sequence[Dataset]) -> dict[str, tuple[float, float]]:
    """Lowest and highest frequency of all records of a kind, which share their chains."""
    spans: dict[str, tuple[float, float]] = {}
    for dataset in datasets:
        name = next((n for n in ("frequency", "band") if n in dataset.data.dims), None)
        if name is not None and dataset.data[name].size:
            frequency, kind = np.asarray(dataset.data[name].values, dtype=np.float64), kind_of(dataset.record).name
            low, high = spans.get(kind, (np.inf, -np.inf))
            spans[kind] = min(low, float(frequency.min())), max(high, float(frequency.max()))
    return spans


def first_size(campaign: Campaign, source: str) -> float:
    """Size of a source's calibration errors before anything is estimated, neper; the irregularity's as stated."""
    known = campaign.stated.irregularity
    if source == "irregularity":
        # Two standard deviations, of a power.
        return {"known": 0.01, "unknown": 1.0}.get(known.knowledge, 0.5 * (known.within_dB or 2.0) / 4.343)
    return 0.02
