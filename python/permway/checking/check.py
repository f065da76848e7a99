"""A campaign checked in seconds: what was read, how it compares with the model as it stands, what is wrong."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from permway.campaign.campaign import Campaign
from permway.campaign.load import Dataset
from permway.campaign.predict import predict
from permway.checking.angles import angles
from permway.checking.blunder import Blunder
from permway.checking.compared import Compared, compared
from permway.checking.file_units import file_units
from permway.checking.noise import noise_floors
from permway.checking.reading import Reading, read
from permway.checking.search import reported
from permway.checking.stated import places, same_places, tolerances
from permway.checking.unlike import is_unlike, questioned, unlike
from permway.checking.words import blunder_of
from permway.errors import InputError, SolveError

COMPARABLE = ("frf", "csd", "psd", "transmissibility")

LEVEL, LEVEL_FREE = 0.3, 2.3
"""Standard deviation of a level that all rows of a record share, neper: 2.6 dB; 20 dB where nobody knows the
irregularity. At half of the first, honest campaigns are doubted; at twice, g for m/s2 is not found in a record."""

SLOPE, SLOPE_FREE = 0.1, 0.5
"""The same of its slope in runs, neper an octave."""

FROM_TOLERANCE = 0.3
"""Neper of level for a standard deviation of one in the logarithm of the least known parameter."""


@dataclass(frozen=True)
class Checked:
    """What a check found.

    Attributes
    ----------
    campaign : Campaign
    reading : Reading
    records : tuple of (Dataset, Compared, Compared)
        Records that can be compared: read, beside their prediction, and put right by what was found.
    blunders : tuple of Blunder
        Found, the surest first; then what is asked.
    """

    campaign: Campaign
    reading: Reading
    records: tuple[tuple[Dataset, Compared, Compared], ...]
    blunders: tuple[Blunder, ...]

    @property
    def found(self) -> tuple[Blunder, ...]:
        """Blunders that are no questions."""
        return tuple(one for one in self.blunders if not one.asked)


def check(campaign: Campaign, *, threads: int | None = None) -> Checked:
    """Check a campaign against its model as it stands; nothing is fitted.

    Parameters
    ----------
    campaign : Campaign
    threads : int, optional

    Raises
    ------
    SolveError
        If the model cannot be solved.
    """
    reading = read(campaign)
    blunders = list(reading.blunders)
    records: list[tuple[Dataset, Compared, Compared]] = []
    usable = [one for one in reading.kept if one.record.statistic in COMPARABLE]
    for dataset, predicted in zip(usable, _predicted(campaign, usable, blunders, threads), strict=False):
        given = compared(dataset, predicted, common(campaign, dataset))
        sensors = [campaign.sensor(name) for name in given.channels]
        points = [campaign.point(name) for name in given.points]
        changes, right = reported(given, sensors, [point.unit for point in points])
        records.append((dataset, given, right))
        sized = any(one.change.kind in ("factor", "quantity") for one in changes)
        of_file = file_units(campaign, dataset.record) if sized else {}
        found = [blunder_of(one, dataset.record, given, sensors, points, of_file) for one in changes]
        blunders += [questioned(one) for one in found] if is_unlike(dataset, right) else found
    blunders += angles(campaign)
    beside = {dataset.record.name: right for dataset, _, right in records}
    blunders += noise_floors(campaign, reading.whole, beside)
    blunders += tolerances(campaign)
    blunders += places(campaign)
    blunders += same_places(campaign)
    # The first of the questions: what follows rests on the model.
    blunders = _together([*unlike([(dataset, right) for dataset, _, right in records]), *blunders])
    blunders.sort(key=lambda one: (one.asked, one.log_odds is not None, -(one.log_odds or 0.0)))
    return Checked(campaign, reading, tuple(records), tuple(blunders))


def _predicted(
    campaign: Campaign, datasets: Sequence[Dataset], blunders: list[Blunder], threads: int | None
) -> list[xr.Dataset]:
    try:
        return predict(campaign, datasets, threads=threads)
    except (InputError, SolveError) as error:
        blunders.append(Blunder("unreadable", "model", f"cannot be solved: {error}", "mend the model file"))
        return []


def common(campaign: Campaign, dataset: Dataset) -> tuple[float, float]:
    """Standard deviations of a level that all rows share, and of its slope: neper, and neper an octave."""
    least_known = max((k.sigma for k in campaign.parameters.known.values() if k.log), default=0.0)
    level = float(np.hypot(LEVEL, FROM_TOLERANCE * least_known))
    if not dataset.record.spectral:
        return level, 0.0
    known = campaign.stated.irregularity
    if known.knowledge == "unknown":
        return LEVEL_FREE, SLOPE_FREE
    return float(np.hypot(level, 0.5 * (known.within_dB or 0.0) / 8.686)), SLOPE


def _together(blunders: Sequence[Blunder]) -> list[Blunder]:
    """Records that say the same of the same are one blunder; odds of independent records multiply."""
    found: dict[tuple[str, str, str, str], Blunder] = {}
    for one in blunders:
        head, _, members = one.where.partition(": ")
        # Only what is stated about sensors and points, not of files, can be the same of several records.
        key = (one.kind, one.what, one.remedy, members if head.startswith("records.") else one.where)
        if one.log_odds is None:
            key = (*key[:3], one.where)
        old = found.get(key)
        if old is None:
            found[key] = one
            continue
        names = old.where.partition(": ")[0] + ", " + head.removeprefix("records.")
        odds = (old.log_odds or 0.0) + (one.log_odds or 0.0)
        found[key] = replace(old, where=names + (f": {members}" if members else ""), log_odds=odds)
    return list(found.values())
