"""Predictions of exactly what each sensor of a campaign saw, in the shape of its datasets."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import xarray as xr

from permway.campaign.campaign import Campaign
from permway.campaign.dataset import Dataset
from permway.campaign.factors import campaign_under, factors_of
from permway.campaign.kinds import kind_of
from permway.campaign.kinds.passage import by_unevenness
from permway.campaign.kinds.power import added_to, away_from_lines
from permway.campaign.predictions.sweeps import Key, Request, Result, Sweep, plan, solve
from permway.errors import InputError

__all__ = [
    "Key",
    "PassBy",
    "Request",
    "Result",
    "Sweep",
    "added_to",
    "away_from_lines",
    "by_unevenness",
    "plan",
    "predict",
    "predict_one",
    "request_of",
    "solve",
    "solved_of",
    "why_not",
]

PassBy = Callable[[Campaign, Dataset], xr.Dataset]
"""What predicts sensors beside the track under a passing train."""


def predict(
    campaign: Campaign, datasets: Sequence[Dataset], *, threads: int | None = None, passby: PassBy | None = None
) -> list[xr.Dataset]:
    """Predict all datasets: one solve of the line for each temperature, set of factors and set of lines.

    Parameters
    ----------
    campaign : Campaign
        With the values to predict for: see :meth:`Campaign.with_values`.
    datasets : sequence of Dataset
        What :meth:`Campaign.load` gives; only their coordinates are read. Their conditions are the campaign's
        of the same name.
    threads : int, optional
    passby : callable, optional
        Predicts records whose sensors all stand beside the track while a train passes.

    Returns
    -------
    list of xarray.Dataset
        For each dataset the variable of its statistic, with the same dimensions and coordinates. Of frequency
        responses `chain`, what is read over the receptance, and `noise_factor` by sensor, too.

    Raises
    ------
    InputError
        For what cannot be predicted; see :func:`why_not`.
    SolveError
        If the line cannot be solved.
    """
    beside = [passby is not None and _is_beside(campaign, dataset) for dataset in datasets]
    requests = [None if apart else request_of(campaign, d) for d, apart in zip(datasets, beside, strict=True)]
    answers = [
        solve(sweep, campaign.model, threads=threads)
        for sweep in plan(request for request in requests if request is not None)
    ]
    by_key = {answer.sweep.key: answer for answer in answers}
    found = []
    for dataset, request, apart in zip(datasets, requests, beside, strict=True):
        if apart and passby is not None:
            condition = campaign.condition(dataset.condition.name)
            found.append(passby(campaign_under(campaign, condition), replace(dataset, condition=condition)))
        else:
            answer = None if request is None else by_key[request.key]
            found.append(predict_one(campaign, dataset, request, answer))
            kind_of(dataset.record).check(dataset, found[-1])
    return found


def why_not(campaign: Campaign, dataset: Dataset) -> InputError | None:
    """Why a dataset cannot be predicted without a pass-by; None if it can."""
    try:
        request_of(campaign, dataset)
    except InputError as error:
        return error
    return None


def request_of(campaign: Campaign, dataset: Dataset) -> Request | None:
    """The receptances behind a dataset; None for a material's table, which needs none.

    Raises
    ------
    InputError
        For a statistic or a sensor that cannot be predicted.
    """
    condition = campaign.condition(dataset.condition.name)
    under, record = campaign_under(campaign, condition), dataset.record
    _check_directions(under, record.name, [*record.channels.values(), *record.responses.values()])
    request = kind_of(record).request(under, dataset, condition)
    factors = tuple((path, factor) for path, factor in factors_of(condition) if path.startswith("line"))
    return replace(request, factors=factors) if request is not None and factors else request


def solved_of(campaign: Campaign, dataset: Dataset) -> tuple[Request, Result] | None:
    """What one dataset needs, and its receptances."""
    request = request_of(campaign, dataset)
    return None if request is None else (request, solve(plan([request])[0], campaign.model))


def predict_one(
    campaign: Campaign, dataset: Dataset, request: Request | None, answer: Result | None
) -> xr.Dataset:
    """Predict one dataset from receptances that were solved for it; see :func:`predict`."""
    condition = campaign.condition(dataset.condition.name)
    solved = None if request is None or answer is None else (request, answer.of(request))
    return kind_of(dataset.record).predicted(campaign_under(campaign, condition), dataset, condition, solved)


def _check_directions(campaign: Campaign, record: str, names: list[str]) -> None:
    for name in names:
        sensor = campaign.sensor(name)
        if not sensor.predicted:
            raise InputError(
                f"reads {sensor.direction}, and the model moves up and down",
                where=f"records.{record}: sensors.{name}.direction",
                remedy="leave the record out of what is predicted",
            )


def _is_beside(campaign: Campaign, dataset: Dataset) -> bool:
    """Whether all sensors of a train's record stand on the line."""
    names = dataset.record.channels.values()
    return dataset.condition.kind == "train" and all(campaign.sensor(name).body is not None for name in names)
