"""Records beside the track while axles pass."""

from __future__ import annotations

import xarray as xr

from permway.arrays import Complexes
from permway.campaign.campaign import Campaign
from permway.campaign.dataset import SI_UNITS, Dataset
from permway.campaign.factors import campaign_under
from permway.campaign.kinds.kind import RecordKind, of_solved
from permway.campaign.parts import Condition, Record
from permway.campaign.passage import passage as recorded
from permway.campaign.predictions import hammer, passage
from permway.campaign.predictions.sweeps import Request, Result


class Passages(RecordKind):
    """Spectra of one passage of known axle loads."""

    name = "passage"
    statistics = ("passage",)
    title = "passages"
    variable = "spectrum"
    dimensions = ("channel", "frequency")

    def load(self, campaign: Campaign, record: Record) -> xr.Dataset:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        return recorded(campaign, record)

    def request(self, campaign: Campaign, dataset: Dataset, condition: Condition) -> Request:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        temperature = hammer.needed_temperature(campaign, condition)
        return passage.request(campaign, condition, dataset.names("channel"), temperature, dataset.data)

    def predicted(
        self, campaign: Campaign, dataset: Dataset, condition: Condition, solved: tuple[Request, Complexes] | None
    ) -> xr.Dataset:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        names = dataset.names("channel")
        passing = passage.Passing(campaign, condition, names, dataset.data, *of_solved(solved))
        spectrum, seam = passing.predicted()
        return dataset.template(self.blank).copy(data={"spectrum": spectrum}).assign_attrs(seam=seam)

    def check(self, dataset: Dataset, predicted: xr.Dataset) -> None:
        """Refuse a window in which the motion does not end."""
        passage.check_seam(dataset.record.name, dataset.data, predicted.attrs["seam"])

    def unit(self, campaign: Campaign, dataset: Dataset, channel: str) -> str:
        """Of the sensor, times s."""
        return f"({SI_UNITS[campaign.sensor(channel).quantity]}) s"


def by_unevenness(campaign: Campaign, dataset: Dataset, request: Request, answer: Result) -> passage.Scatter:
    """What the unevenness that axles meet makes of a record, from the receptances that it needs."""
    condition = campaign.condition(dataset.condition.name)
    under, names = campaign_under(campaign, condition), dataset.names("channel")
    return passage.Passing(under, condition, names, dataset.data, request, answer.of(request)).by_unevenness()
