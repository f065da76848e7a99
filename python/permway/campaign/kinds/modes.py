"""Tables of natural frequencies, damping ratios and shapes."""

from __future__ import annotations

import xarray as xr

from permway.arrays import Complexes
from permway.campaign.campaign import Campaign
from permway.campaign.dataset import Dataset
from permway.campaign.kinds.kind import RecordKind, of_solved
from permway.campaign.modes import modes as table_of_modes
from permway.campaign.parts import Condition, Record
from permway.campaign.predictions import hammer, modes
from permway.campaign.predictions.sweeps import Request


class Modes(RecordKind):
    """Of an earlier analysis."""

    name = "modes"
    statistics = ("modes",)
    title = "modes"
    variable = "modes"
    dimensions = ("quantity", "frequency")
    tabular = True
    noise = "as the table states it"

    def load(self, campaign: Campaign, record: Record) -> xr.Dataset:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        return table_of_modes(campaign, record)

    def request(self, campaign: Campaign, dataset: Dataset, condition: Condition) -> Request:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        temperature = hammer.needed_temperature(campaign, condition)
        return modes.request(campaign, dataset.names("sensor"), temperature, dataset.data)

    def predicted(
        self, campaign: Campaign, dataset: Dataset, condition: Condition, solved: tuple[Request, Complexes] | None
    ) -> xr.Dataset:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        sensors = [campaign.sensor(name) for name in dataset.names("sensor")]
        found = modes.predicted(dataset.data, sensors, *of_solved(solved))
        return dataset.template(self.blank).copy(data={"modes": found})

    def channels(self, dataset: Dataset) -> tuple[list[str], list[str]]:
        """Frequency and damping."""
        quantities = [str(n) for n in dataset.data["quantity"].values]
        return quantities, [""] * len(quantities)

    def unit(self, campaign: Campaign, dataset: Dataset, channel: str) -> str:
        """Of frequency or damping."""
        return "Hz" if channel == "natural frequency" else "1"
