"""A campaign's records, read one by one: what cannot be read is reported, and the others go on."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace

import numpy as np

from permway.campaign.bad_channels import without_bad_channels
from permway.campaign.campaign import Campaign
from permway.campaign.load import Dataset, load_record
from permway.campaign.parts import Record
from permway.campaign.predict import why_not
from permway.checking.blunder import Blunder
from permway.errors import InputError

MOST_LINES = 64
"""Lines of a record that are compared with the model: a check takes in proportion to them."""

COHERENCE = (
    ("coherence lies between 0 and 1", "in percent? say so in the header, as coherence [%], or divide it by 100"),
)
"""What the readers say, and what is usually meant by it."""


@dataclass(frozen=True)
class Reading:
    """What could be read.

    Attributes
    ----------
    whole : tuple of Dataset
        All lines.
    kept : tuple of Dataset
        Those that can be predicted, on few lines.
    blunders : tuple of Blunder
        Why the others are not there.
    left_out : dict of str to str
        Records that are read and not predicted, and why.
    """

    whole: tuple[Dataset, ...]
    kept: tuple[Dataset, ...]
    blunders: tuple[Blunder, ...]
    left_out: dict[str, str]


def read(campaign: Campaign) -> Reading:
    """Read the records of a campaign, each for itself; nothing is raised for a record that cannot be used."""
    whole: list[Dataset] = []
    kept: list[Dataset] = []
    blunders: list[Blunder] = []
    left_out: dict[str, str] = {}
    for record in campaign.stated.records:
        try:
            data, channels_out = _one(campaign, record)
        except InputError as error:
            blunders.append(_unreadable(record, error))
            continue
        blunders += channels_out
        whole.append(data)
        reason = why_not(campaign, data)
        if reason is not None:
            left_out[record.name] = str(reason)
        else:
            kept.append(few_lines(data))
    return Reading(tuple(whole), tuple(kept), tuple(blunders), left_out)


def _one(campaign: Campaign, record: Record) -> tuple[Dataset, list[Blunder]]:
    alone, bad = without_bad_channels(campaign.with_records([record]))
    channels_out = [
        Blunder("bad channel", f"records.{one.record}: {one.channel}", f"{one.kind}: {one.what}", "it is left out")
        for one in bad
    ]
    with warnings.catch_warnings():
        # Estimates of few segments warn; what they are worth is in the intervals.
        warnings.simplefilter("ignore")
        return load_record(campaign, alone.stated.records[0]), channels_out


def _unreadable(record: Record, error: InputError) -> Blunder:
    remedy = next((better for stated, better in COHERENCE if error.what.startswith(stated)), error.remedy)
    got = "" if error.value is None else f" (got {error.value!r})"
    place = error.where.removeprefix(f"records.{record.name}: ")
    return Blunder("unreadable", f"records.{record.name}", f"{place}: {error.what}{got}", remedy or "see the file")


def few_lines(dataset: Dataset, most: int = MOST_LINES) -> Dataset:
    """The record on at most so many lines, evenly over the logarithm of frequency."""
    if "frequency" not in dataset.data.dims:
        return dataset
    frequency = dataset.frequency_Hz
    if frequency.size <= most:
        return dataset
    wanted = np.geomspace(frequency[0], frequency[-1], most)
    at = np.unique(np.searchsorted(frequency, wanted).clip(0, frequency.size - 1))
    return replace(dataset, data=dataset.data.isel(frequency=at))
