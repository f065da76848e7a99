"""What a kind of record is: how it is read, what it needs of the line, and what it should have read."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np
import xarray as xr

from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign
from permway.campaign.dataset import Dataset
from permway.campaign.parts import Condition, Record
from permway.campaign.predictions.sweeps import Request
from permway.errors import InputError

NEPER_DB, POWER_DB = 20.0 / np.log(10.0), 10.0 / np.log(10.0)
"""Decibels of a natural logarithm: of an amplitude, and of a power."""

Interval = tuple[Reals, Reals, Reals]
"""Bounds of a modulus, and half the interval of a phase."""


class RecordKind(ABC):
    """All that the package knows of records of some statistics.

    A further kind is a class in a file beside this one, its instance in :data:`permway.campaign.kinds.KINDS`, and
    its word in :data:`permway.campaign.parts.Statistic`. Its likelihood is a
    :class:`permway.diagnosis.blocks.Block`, named in :data:`permway.diagnosis.block_of.BLOCKS`.

    Attributes
    ----------
    name : str
        Of all its statistics.
    statistics : tuple of str
        As a campaign file has them.
    title : str
        In words, of several.
    variable : str
        What is compared of its datasets.
    dimensions : tuple of str
        Of what is held out.
    power : bool
        Whether decibels of the variable are 10 lg.
    tabular : bool
        Whether a record is a short table, which is drawn together with others of its kind.
    noise : str
        How its noise is known, in words.
    """

    name: ClassVar[str]
    statistics: ClassVar[tuple[str, ...]]
    title: ClassVar[str]
    variable: ClassVar[str]
    dimensions: ClassVar[tuple[str, ...]]
    power: ClassVar[bool] = False
    tabular: ClassVar[bool] = False
    noise: ClassVar[str] = "an assumed scatter"

    @abstractmethod
    def load(self, campaign: Campaign, record: Record) -> xr.Dataset:
        """Read a record; InputError with what is wrong in its file."""

    @abstractmethod
    def request(self, campaign: Campaign, dataset: Dataset, condition: Condition) -> Request | None:
        """The receptances behind a dataset, None without any; InputError for what cannot be predicted.

        Parameters
        ----------
        campaign : Campaign
            As it is under the condition.
        dataset : Dataset
        condition : Condition
        """

    @abstractmethod
    def predicted(
        self, campaign: Campaign, dataset: Dataset, condition: Condition, solved: tuple[Request, Complexes] | None
    ) -> xr.Dataset:
        """What should have been read.

        Parameters
        ----------
        campaign, dataset, condition
            As of :meth:`request`.
        solved : (Request, ndarray), optional
            What was asked for, and its receptances, shape (F, rows, columns).

        Returns
        -------
        xarray.Dataset
            The variables of :meth:`blank`, with the dimensions and coordinates of the dataset.
        """

    def blank(self, data: xr.Dataset) -> xr.Dataset:
        """What is predicted of a dataset, to be filled."""
        return data[[self.variable]]

    def check(self, dataset: Dataset, predicted: xr.Dataset) -> None:  # noqa: B027 - most have nothing to refuse
        """Refuse a prediction that its record shows to be worthless; InputError."""

    def channels(self, dataset: Dataset) -> tuple[list[str], list[str]]:
        """Sensor and force point of each curve; the point is empty where there is none."""
        data = dataset.data
        names = [str(n) for n in data["channel"].values] if "channel" in data.dims else [dataset.record.name]
        return names, [""] * len(names)

    def unmeasured(self, dataset: Dataset) -> list[str]:
        """Curves that a record asks for and its file does not have, as "sensor < force"; without pairs none."""
        return []

    def unit(self, campaign: Campaign, dataset: Dataset, channel: str) -> str:
        """Of a curve."""
        return str(dataset.data[self.variable].attrs.get("units", "1"))

    def interval(self, dataset: Dataset, measured: Complexes | Reals, scatter_dB: Reals) -> Interval:
        """Bounds of the modulus, 95 %, and half the interval of the phase, each (channel, frequency).

        Parameters
        ----------
        dataset : Dataset
        measured : ndarray, shape (channel, frequency)
        scatter_dB : ndarray, the same shape
            One standard deviation of each line.
        """
        modulus = np.abs(measured)
        reach = 1.96 * scatter_dB / (POWER_DB if self.power else NEPER_DB)
        half = np.full(modulus.shape, np.nan) if self.power else reach
        return modulus * np.exp(-reach), modulus * np.exp(reach), half


def of_solved(solved: tuple[Request, Complexes] | None) -> tuple[Request, Complexes]:
    """What was solved, of a kind that always needs it."""
    assert solved is not None
    return solved


def not_predicted(record: Record) -> InputError:
    """That records of a kind are kept only."""
    what = f'a record of "{record.statistic}" is kept, and not predicted'
    return InputError(what, where=f"records.{record.name}.statistic")
