"""Kinds of record: one class each, whose file says all that is particular to it."""

from __future__ import annotations

from permway.campaign.kinds.bands import Bands
from permway.campaign.kinds.decay import DecayRates
from permway.campaign.kinds.kind import RecordKind
from permway.campaign.kinds.material import Moduli
from permway.campaign.kinds.modes import Modes
from permway.campaign.kinds.passage import Passages
from permway.campaign.kinds.power import PowerSpectra
from permway.campaign.kinds.responses import Responses
from permway.campaign.kinds.transmissibility import Transmissibility
from permway.campaign.parts import Record

KINDS: dict[str, RecordKind] = {
    statistic: kind
    for kind in (
        Responses(),
        PowerSpectra(),
        Bands(),
        DecayRates(),
        Transmissibility(),
        Moduli(),
        Modes(),
        Passages(),
    )
    for statistic in kind.statistics
}
"""By statistic."""


def kind_of(record: Record) -> RecordKind:
    """The kind of a record."""
    return KINDS[record.statistic]
