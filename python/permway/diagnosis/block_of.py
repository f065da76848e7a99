"""Which likelihood a kind of record has."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import xarray as xr

from permway.campaign.campaign import Campaign
from permway.campaign.dataset import Dataset
from permway.campaign.kinds import kind_of
from permway.campaign.predict import added_to, by_unevenness, solved_of
from permway.campaign.predictions.passage import Scatter
from permway.diagnosis.blocks import Block
from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.blocks_modes import ModesBlock
from permway.diagnosis.blocks_passage import PassageBlock
from permway.diagnosis.blocks_spectra import SpectraBlock
from permway.diagnosis.blocks_tabular import TableBlock

Span = tuple[float, float]

BLOCKS: dict[str, Callable[[Campaign, Dataset, xr.Dataset, Span], Block]] = {
    "frf": lambda _, dataset, predicted, span: FrfBlock(dataset, reference=predicted, span=span),
    "spectra": lambda campaign, dataset, predicted, span: SpectraBlock(
        dataset, predicted, added=added_to(campaign, dataset), span=span
    ),
    "passage": lambda campaign, dataset, predicted, span: PassageBlock(
        dataset, reference=predicted, scatter=_scatter(campaign, dataset), span=span
    ),
    "modes": lambda _, dataset, predicted, span: ModesBlock(dataset, predicted),
}
"""By the name of a kind, from campaign, dataset, prediction and the band of all records of the kind."""


def _scatter(campaign: Campaign, dataset: Dataset) -> Scatter | None:
    """By an unevenness that axles meet; None without one, for which nothing is solved."""
    axles = campaign.condition(dataset.condition.name).axles
    solved = None if axles is None or axles.irregularity is None else solved_of(campaign, dataset)
    return None if solved is None else by_unevenness(campaign, dataset, *solved)


def block_of(campaign: Campaign, dataset: Dataset, predicted: xr.Dataset, spans: Mapping[str, Span]) -> Block:
    """The likelihood of a record; of kinds that are not in :data:`BLOCKS`, that of a table.

    Parameters
    ----------
    campaign : Campaign
    dataset : Dataset
    predicted : xarray.Dataset
        Of it.
    spans : mapping of kind to (float, float)
        Lowest and highest frequency of all records of a kind, Hz.
    """
    kind = kind_of(dataset.record).name
    if kind in BLOCKS:
        return BLOCKS[kind](campaign, dataset, predicted, spans[kind])
    return TableBlock(dataset, span=spans.get(kind))
