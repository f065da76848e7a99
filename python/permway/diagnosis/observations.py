"""All records of a campaign together: residuals, what calibration errors explain of them, and what is left."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
import xarray as xr

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.campaign.load import Dataset
from permway.campaign.predict import (
    Key,
    Request,
    Result,
    plan,
    predict_one,
    request_of,
    solve,
)
from permway.diagnosis.blocks import Block, Prediction, Rows
from permway.diagnosis.frf_lines import thinned
from permway.diagnosis.gaussian_process import FIRST_LENGTH
from permway.diagnosis.side_by_side import threads_of_solver
from permway.diagnosis.whitener import AllColumns, Whitener


@dataclass(frozen=True)
class Solved:
    """Predictions, and what they were made from."""

    campaign: Campaign
    needs: tuple[Request | None, ...]
    answers: Mapping[Key, Result]
    datasets: list[xr.Dataset]

    def of(self, index: int) -> Prediction:
        """Of one block."""
        need = self.needs[index]
        solved = None if need is None else (need, self.answers[need.key])
        return Prediction(self.campaign, self.datasets[index], solved)


def _answered(needs: Sequence[Request | None], campaign: Campaign, near: Solved | None) -> dict[Key, Result]:
    """What a campaign of the same line had solved, of all states in which nothing else is needed."""
    if near is None or campaign.model.line != near.campaign.model.line:
        return {}
    others = {
        need.key
        for need, old in zip(needs, near.needs, strict=True)
        if need is not None and (old is None or not need.is_like(old))
    }
    return {state: answer for state, answer in near.answers.items() if state not in others}


def _kept(
    datasets: Sequence[Dataset],
    needs: Sequence[Request | None],
    answers: Mapping[Key, Result],
    campaign: Campaign,
    near: Solved,
) -> list[bool]:
    """Which predictions are those of a campaign near by: of the same answer, shaken and read as there."""
    same = partial(_read_alike, campaign, near.campaign)
    alike = {"frf": True, "csd": _shaken_alike(campaign, near.campaign)}
    return [
        need is not None
        and answers[need.key] is near.answers.get(need.key)
        and alike.get(dataset.record.statistic, False)
        and same(dataset)
        for dataset, need in zip(datasets, needs, strict=True)
    ]


def _shaken_alike(one: Campaign, other: Campaign) -> bool:
    """Whether the same train meets the same profile."""
    return (
        one.model.train == other.model.train
        and one.model.irregularity == other.model.irregularity
        and one.model.conversion == other.model.conversion
        and one.stated.irregularity == other.stated.irregularity
    )


def _read_alike(one: Campaign, other: Campaign, dataset: Dataset) -> bool:
    """Whether a dataset's sensors and points are the same, and its condition is."""
    if one.stated is other.stated:
        return True
    if one.condition(dataset.condition.name) != other.condition(dataset.condition.name):
        return False
    for dimension, known in (("sensor", Campaign.sensor), ("channel", Campaign.sensor), ("force", Campaign.point)):
        if dimension in dataset.data.dims:
            names = dataset.names(dimension)
            if [known(one, name) for name in names] != [known(other, name) for name in names]:
                return False
    return True


@dataclass(frozen=True)
class Observations:
    """The records of a campaign as one vector of standardised residuals.

    Attributes
    ----------
    campaign : Campaign
        With its nominal values, which are varied.
    blocks : tuple of Block
    sizes : mapping of origin to float
        Standard deviation of each origin's calibration errors, neper or rad.
    length : float
        Octaves over which the errors of chains correlate.
    threads : int, optional
        Of the solver.
    """

    campaign: Campaign
    blocks: tuple[Block, ...]
    sizes: Mapping[str, float]
    length: float = FIRST_LENGTH
    threads: int | None = None

    @property
    def datasets(self) -> list[Dataset]:
        """The datasets, block by block."""
        return [block.dataset for block in self.blocks]

    @property
    def rows(self) -> Rows:
        """Labels of all rows."""
        parts = [block.rows for block in self.blocks]
        names = ("channel", "sensor", "force", "frequency_Hz", "scale_dB")
        return Rows(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))

    @property
    def block_of(self) -> np.ndarray:
        """Index of each row's block."""
        return np.repeat(np.arange(len(self.blocks)), [block.rows.channel.size for block in self.blocks])

    def predicted(self, campaign: Campaign, near: Solved | None = None) -> Solved:
        """What a model of the same records predicts.

        Parameters
        ----------
        near : Solved, optional
            Of a campaign that may have the same line: it is then not solved again.
        """
        needs = [request_of(campaign, dataset) for dataset in self.datasets]
        answers = _answered(needs, campaign, near)
        sweeps = plan(need for need in needs if need is not None and need.key not in answers)
        for sweep in sweeps:
            answers[sweep.key] = solve(sweep, campaign.model, threads=threads_of_solver(self.threads))
        kept = [] if near is None else _kept(self.datasets, needs, answers, campaign, near)
        datasets: list[xr.Dataset] = []
        made: dict[int, xr.Dataset] = {}
        for index, (dataset, need) in enumerate(zip(self.datasets, needs, strict=True)):
            if near is not None and kept[index]:
                made[id(dataset)] = near.datasets[index]
            elif id(dataset) not in made:
                answer = None if need is None else answers[need.key]
                made[id(dataset)] = predict_one(campaign, dataset, need, answer)
            # Two blocks may be of one dataset.
            datasets.append(made[id(dataset)])
        return Solved(campaign, tuple(needs), answers, datasets)

    def residuals(self, predicted: Sequence[xr.Dataset]) -> Reals:
        """Standardised residuals of all rows."""
        return np.concatenate([b.residuals(p) for b, p in zip(self.blocks, predicted, strict=True)])

    def levels_dB(self, predicted: Sequence[xr.Dataset]) -> Reals:
        """Measured over predicted of all rows, no error taken out; NaN where a row is no level."""
        return np.concatenate([b.levels_dB(p) for b, p in zip(self.blocks, predicted, strict=True)])

    @cached_property
    def columns(self) -> AllColumns:
        """What calibration errors of unit size do to the residuals."""
        return AllColumns.of(
            [block.calibration for block in self.blocks], [b.rows.channel.size for b in self.blocks]
        )

    @cached_property
    def whitener(self) -> Whitener:
        """What takes out the calibration errors."""
        return Whitener.of(self.columns, self.sizes, self.length)

    @property
    def log_determinant(self) -> float:
        """Of the covariance by which the blocks' own calibration errors are taken out."""
        return sum(block.log_determinant for block in self.blocks)

    def with_sizes(self, sizes: Mapping[str, float], length: float | None = None) -> Observations:
        """The same with other sizes of calibration errors, and another length."""
        other = replace(self, sizes=dict(sizes), length=self.length if length is None else length)
        if "columns" in self.__dict__:
            other.__dict__["columns"] = self.columns
        return other

    def with_blocks(self, blocks: tuple[Block, ...]) -> Observations:
        """The same records as other blocks."""
        return replace(self, blocks=blocks)

    def of(self, campaign: Campaign, datasets: Sequence[Dataset]) -> Observations:
        """Other records of the same channels and lines, with the same errors.

        Parameters
        ----------
        campaign : Campaign
        datasets : sequence of Dataset
            One for each record, in their order.
        """
        known = {id(self.datasets[i]): thinned(d) for i, d in zip(self.records, datasets, strict=True)}
        blocks = tuple(b.of(known[id(b.dataset)]) for b in self.blocks)
        return replace(self, campaign=campaign, blocks=blocks)

    @property
    def records(self) -> list[int]:
        """Indices of the blocks that are records themselves, and no noise of one."""
        return [index for index, block in enumerate(self.blocks) if block.is_record]

    def selected(self, keep: Sequence[int]) -> Observations:
        """Of some blocks only."""
        return replace(self, blocks=tuple(self.blocks[i] for i in keep))
