"""Swept sines: motion over that of the ground."""

from __future__ import annotations

import numpy as np
import xarray as xr

from permway.arrays import Complexes
from permway.campaign.campaign import Campaign
from permway.campaign.dataset import Dataset
from permway.campaign.kinds.kind import RecordKind, of_solved
from permway.campaign.parts import Condition, Record
from permway.campaign.predictions import hammer, shaker
from permway.campaign.predictions.sweeps import Request
from permway.campaign.tabular import transmissibility


class Transmissibility(RecordKind):
    """Of a shaker table."""

    name = "transmissibility"
    statistics = ("transmissibility",)
    title = "transmissibilities"
    variable = "transmissibility"
    dimensions = ("channel", "frequency")
    tabular = True

    def load(self, campaign: Campaign, record: Record) -> xr.Dataset:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        return transmissibility(campaign, record)

    def request(self, campaign: Campaign, dataset: Dataset, condition: Condition) -> Request:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        sensors = [campaign.sensor(name) for name in dataset.names("channel")]
        locations = tuple((str(sensor.body), float(sensor.x_m or 0.0)) for sensor in sensors)
        temperature = hammer.needed_temperature(campaign, condition)
        return shaker.request(campaign.model, temperature, locations, dataset.frequency_Hz)

    def predicted(
        self, campaign: Campaign, dataset: Dataset, condition: Condition, solved: tuple[Request, Complexes] | None
    ) -> xr.Dataset:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        request, values = of_solved(solved)
        shifted = shaker.transmissibility(campaign.model, request.temperature_C, request.frequency_Hz, values)
        chains = [campaign.sensor(name).chain.transfer(request.frequency_Hz) for name in dataset.names("channel")]
        return dataset.template(self.blank).copy(data={"transmissibility": shifted.T * np.stack(chains)})
