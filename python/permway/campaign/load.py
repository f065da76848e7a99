"""From the files of a campaign to labelled datasets: what was measured, how surely, and of what it is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from permway.campaign.dataset import Dataset
from permway.campaign.kinds import kind_of
from permway.campaign.kinds.responses import log_variance
from permway.campaign.parts import Record
from permway.errors import InputError

if TYPE_CHECKING:
    from permway.campaign.campaign import Campaign

__all__ = ["Dataset", "load", "load_record", "log_variance"]


def load(campaign: Campaign) -> list[Dataset]:
    """Read all records of a campaign.

    Raises
    ------
    InputError
        With the record and what is wrong in its file.
    """
    return [load_record(campaign, record) for record in campaign.stated.records]


def load_record(campaign: Campaign, record: Record) -> Dataset:
    """Read one record.

    Raises
    ------
    InputError
        With the record and what is wrong in its file.
    """
    condition = campaign.condition(record.condition)
    try:
        data = kind_of(record).load(campaign, record)
    except InputError as error:
        raise InputError(
            error.what, where=f"records.{record.name}: {error.where}", value=error.value, remedy=error.remedy
        ) from error
    data.attrs |= {
        "record": record.name,
        "condition": condition.name,
        "repeat": record.repeat,
        "source": str(campaign.path(record)),
    }
    if condition.temperature_C is not None:
        data.attrs["temperature_C"] = condition.temperature_C
    if condition.speed_m_per_s is not None:
        data.attrs["speed_m_per_s"] = condition.speed_m_per_s
    return Dataset(record, condition, data)
