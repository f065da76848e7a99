"""Moduli of a material, point by point."""

from __future__ import annotations

import xarray as xr

from permway.arrays import Complexes
from permway.campaign.campaign import Campaign
from permway.campaign.dataset import Dataset
from permway.campaign.kinds.kind import RecordKind
from permway.campaign.parts import Condition, Record
from permway.campaign.predictions import material
from permway.campaign.predictions.sweeps import Request
from permway.campaign.tabular import material as moduli


class Moduli(RecordKind):
    """Of a law, without the line."""

    name = "material"
    statistics = ("material",)
    title = "moduli"
    variable = "modulus"
    dimensions = ("point",)
    tabular = True

    def load(self, campaign: Campaign, record: Record) -> xr.Dataset:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        return moduli(campaign, record)

    def request(self, campaign: Campaign, dataset: Dataset, condition: Condition) -> Request | None:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        return None

    def predicted(
        self, campaign: Campaign, dataset: Dataset, condition: Condition, solved: tuple[Request, Complexes] | None
    ) -> xr.Dataset:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        return material.predicted(campaign, dataset.record, dataset.data)
