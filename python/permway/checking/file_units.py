"""Which units files state of their channels: a sensor whose unit is corrected is refused until these are, too."""

from __future__ import annotations

from permway.campaign.campaign import Campaign
from permway.campaign.parts import Record
from permway.errors import InputError
from permway.recordings.readers import read_frf
from permway.recordings.readers.front import opened
from permway.recordings.readers.limits import MOST_BYTES
from permway.recordings.readers.uff58_spectra import spectra_held


def file_units(campaign: Campaign, record: Record) -> dict[str, str]:
    """Units that a record's file, or the record itself, states; without samples of records in time.

    Returns
    -------
    dict of sensor's name to str
        Of responses that of the first pair of the sensor that has one. Without those that are stated nowhere.
    """
    try:
        if record.statistic == "frf":
            return _of_responses(campaign, record)
        if record.spectral:
            return _of_channels(campaign, record)
    except InputError:
        # What cannot be read is reported elsewhere.
        pass
    return {}


def _of_responses(campaign: Campaign, record: Record) -> dict[str, str]:
    file = read_frf(
        campaign.path(record),
        responses=list(record.responses),
        references=list(record.references),
        format=record.format,
        part=record.part,
        hints=record.hints,
        keep_nonfinite=True,
    )
    found: dict[str, str] = {}
    for row, label in enumerate(file.responses):
        unit = file.unit_of(row)
        if label in record.responses and unit is not None:
            found.setdefault(record.responses[label], unit)
    return found


def _of_channels(campaign: Campaign, record: Record) -> dict[str, str]:
    path, hints = campaign.path(record), record.hints
    if not record.sampled:
        densities = {str(row["channel"]): row["unit"] for row in spectra_held(path, hints)}
        found = {name: densities.get(label) for label, name in record.channels.items()}
        return {name: str(unit) for name, unit in found.items() if unit is not None}
    with opened(path, record.format, record.part, hints, True, MOST_BYTES) as (file, _):
        units = dict(zip(file.channels, file.units, strict=True))
    stated = {name: hints.channel_unit(label) or units.get(label) for label, name in record.channels.items()}
    return {name: unit for name, unit in stated.items() if unit is not None}
