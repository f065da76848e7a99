"""Levels in one-third octaves, which are kept and not predicted."""

from __future__ import annotations

import xarray as xr

from permway.arrays import Complexes
from permway.campaign.campaign import Campaign
from permway.campaign.dataset import Dataset
from permway.campaign.kinds.kind import RecordKind, not_predicted
from permway.campaign.parts import Condition, Record
from permway.campaign.predictions.sweeps import Request
from permway.campaign.tabular import bands


class Bands(RecordKind):
    """Mean squares in bands."""

    name = "bands"
    statistics = ("bands",)
    title = "bands"
    variable = "mean_square"
    dimensions = ("channel", "band")
    power = True

    def load(self, campaign: Campaign, record: Record) -> xr.Dataset:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        return bands(campaign, record)

    def request(self, campaign: Campaign, dataset: Dataset, condition: Condition) -> Request | None:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        raise not_predicted(dataset.record)

    def predicted(
        self, campaign: Campaign, dataset: Dataset, condition: Condition, solved: tuple[Request, Complexes] | None
    ) -> xr.Dataset:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        raise not_predicted(dataset.record)
