"""Track decay rates in one-third octaves."""

from __future__ import annotations

import xarray as xr

from permway.arrays import Complexes
from permway.campaign.campaign import Campaign
from permway.campaign.dataset import Dataset
from permway.campaign.kinds.kind import RecordKind, of_solved
from permway.campaign.parts import Condition, Record
from permway.campaign.predictions import decay, hammer
from permway.campaign.predictions.sweeps import Request
from permway.campaign.tabular import decay as decay_rates


class DecayRates(RecordKind):
    """Rates of EN 15461."""

    name = "decay"
    statistics = ("decay",)
    title = "decay rates"
    variable = "decay_rate"
    dimensions = ("band",)
    power = True
    tabular = True

    def load(self, campaign: Campaign, record: Record) -> xr.Dataset:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        return decay_rates(campaign, record)

    def request(self, campaign: Campaign, dataset: Dataset, condition: Condition) -> Request:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        return decay.request(
            campaign, dataset.record, hammer.needed_temperature(campaign, condition), dataset.data
        )

    def predicted(
        self, campaign: Campaign, dataset: Dataset, condition: Condition, solved: tuple[Request, Complexes] | None
    ) -> xr.Dataset:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        return decay.predicted(dataset.record, dataset.data, *of_solved(solved))
