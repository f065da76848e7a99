"""Bad channels: reported before anything is estimated from them, and left out of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from permway.campaign.parts import Record
from permway.errors import InputError
from permway.recordings.finding import Finding
from permway.recordings.screening import screen

if TYPE_CHECKING:
    from permway.campaign.campaign import Campaign


@dataclass(frozen=True)
class BadChannel:
    """A channel of a record that nothing should be estimated from.

    Attributes
    ----------
    record, channel : str
        The channel by its sensor's name.
    kind : str
        As of :class:`permway.recordings.finding.Finding`.
    what : str
        In words, with numbers.
    """

    record: str
    channel: str
    kind: str
    what: str


def without_bad_channels(campaign: Campaign) -> tuple[Campaign, tuple[BadChannel, ...]]:
    """A campaign without its bad channels, and what they are.

    A channel is bad if screening finds an error in it: clipped, held, dead, or a copy of another.

    Raises
    ------
    InputError
        If a file cannot be read, or no record is left.
    """
    records: list[Record] = []
    bad: list[BadChannel] = []
    for record in campaign.stated.records:
        found = list(_bad_channels(campaign, record)) if record.sampled else []
        names = {one.channel for one in found}
        kept = {label: name for label, name in record.channels.items() if name not in names}
        if kept or not found:
            records.append(record.model_copy(update={"channels": kept}) if found else record)
        bad += found
    if not records:
        one = bad[0]
        remedy = "measure again, or give the records' sound parts"
        raise InputError("every record is bad", where=f"records.{one.record}", value=one.what, remedy=remedy)
    if not bad:
        return campaign, ()
    return campaign.with_records(tuple(records)), tuple(bad)


def _bad_channels(campaign: Campaign, record: Record) -> Iterator[BadChannel]:
    """One for each kind of error of each channel."""
    errors: dict[tuple[str, str], list[Finding]] = {}
    for block in campaign.samples(record):
        for finding in screen(block).of("error"):
            if finding.channel in record.channels:
                errors.setdefault((finding.channel, finding.kind), []).append(finding)
    for (label, kind), findings in errors.items():
        more = ", and elsewhere" if len(findings) > 1 else ""
        yield BadChannel(record.name, record.channels[label], kind, f"{findings[0].what}{more}")
