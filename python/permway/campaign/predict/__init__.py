"""Predictions of exactly what each sensor of a campaign saw, in the shape of its datasets."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign
from permway.campaign.factors import campaign_under, factors_of
from permway.campaign.load import Dataset
from permway.campaign.parts import Condition
from permway.campaign.predict import decay, hammer, material, modes, passage, run, shaker
from permway.campaign.predict.grid import grid_of, halved
from permway.campaign.predict.rolling import rolling_of
from permway.campaign.predict.sliding import worked
from permway.campaign.predict.sweeps import Key, Request, Result, Sweep, plan, solve
from permway.errors import InputError

__all__ = [
    "Key",
    "PassBy",
    "Request",
    "Result",
    "Sweep",
    "added_to",
    "away_from_lines",
    "need_of",
    "plan",
    "predict",
    "predict_one",
    "solve",
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
            if dataset.record.statistic == "passage":
                passage.check_seam(dataset.record.name, dataset.data, found[-1].attrs["seam"])
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
    request = _request(campaign_under(campaign, condition), dataset, condition)
    factors = tuple((path, factor) for path, factor in factors_of(condition) if path.startswith("line"))
    return replace(request, factors=factors) if request is not None and factors else request


def _request(campaign: Campaign, dataset: Dataset, condition: Condition) -> Request | None:
    record, data = dataset.record, dataset.data
    temperature = hammer.temperature(campaign, condition)
    _check_directions(campaign, record.name, [*record.channels.values(), *record.responses.values()])
    match record.statistic:
        case "frf":
            return hammer.request(
                campaign, condition, dataset.names("sensor"), dataset.names("force"), dataset.frequency_Hz
            )
        case "csd" | "psd":
            _check_on_board(campaign, record.name, dataset.names("channel"))
            lines = run.solved_lines(dataset.frequency_Hz, record.segment_s, record.interpolated_Hz)
            assert campaign.model.train is not None
            locations = tuple(
                (campaign.model.train.body, float(x)) for x in run.wheels_of(campaign.model, condition)
            )
            return Request(temperature, lines, locations, locations)
        case "transmissibility":
            sensors = [campaign.sensor(name) for name in dataset.names("channel")]
            locations = tuple((str(sensor.body), float(sensor.x_m or 0.0)) for sensor in sensors)
            return shaker.request(campaign.model, temperature, locations, dataset.frequency_Hz)
        case "decay":
            return decay.request(campaign, record, temperature, data)
        case "modes":
            return modes.request(campaign, dataset.names("sensor"), temperature, data)
        case "passage":
            return passage.request(campaign, condition, dataset.names("channel"), temperature, data)
        case "material":
            return None
    raise InputError(
        f'a record of "{record.statistic}" is kept, and not predicted', where=f"records.{record.name}.statistic"
    )


def predict_one(
    campaign: Campaign, dataset: Dataset, request: Request | None, answer: Result | None
) -> xr.Dataset:
    """Predict one dataset from receptances that were solved for it; see :func:`predict`."""
    record, data = dataset.record, dataset.data
    condition = campaign.condition(dataset.condition.name)
    campaign = campaign_under(campaign, condition)
    if request is None or answer is None:
        return material.predicted(campaign, record, data)
    values = answer.of(request)
    match record.statistic:
        case "frf":
            sensors = [campaign.sensor(name) for name in dataset.names("sensor")]
            read = hammer.read(sensors, [campaign.point(n) for n in dataset.names("force")], dataset.frequency_Hz)
            frf = np.ascontiguousarray(np.moveaxis(values * read, 0, -1))
            noise = np.array([sensor.chain.noise_factor for sensor in sensors])
            chain = np.moveaxis(read, 0, -1)
            return dataset.template.copy(data={"frf": frf, "noise_factor": noise, "chain": chain})
        case "csd" | "psd":
            matrix = _csd(campaign, dataset, condition, request.frequency_Hz, values)
            power = np.einsum("fcc->cf", matrix).real
            return dataset.template.copy(data={"csd": np.moveaxis(matrix, 0, -1), "psd": power})
        case "transmissibility":
            shifted = shaker.transmissibility(campaign.model, request.temperature_C, request.frequency_Hz, values)
            chains = [
                campaign.sensor(name).chain.transfer(request.frequency_Hz) for name in dataset.names("channel")
            ]
            return dataset.template.copy(data={"transmissibility": shifted.T * np.stack(chains)})
        case "passage":
            spectrum, seam = passage.predicted(
                campaign, condition, dataset.names("channel"), data, request, values
            )
            return dataset.template.copy(data={"spectrum": spectrum}).assign_attrs(seam=seam)
        case "modes":
            sensors = [campaign.sensor(name) for name in dataset.names("sensor")]
            return dataset.template.copy(data={"modes": modes.predicted(data, sensors, request, values)})
        case _:
            return decay.predicted(record, data, values)


def away_from_lines(campaign: Campaign, dataset: Dataset, request: Request, answer: Result) -> Complexes:
    """Expected cross spectra of a run but noise and hum, every part times its distance from its line, in lines.

    Hann's window takes in two lines on either side. An error of a chain that grows by so much from line to line
    acts on this.

    Returns
    -------
    ndarray of complex128, shape (channels, channels, F)
    """
    condition = campaign.condition(dataset.condition.name)
    values = answer.of(request)
    matrix = _csd(campaign_under(campaign, condition), dataset, condition, request.frequency_Hz, values, away=True)
    return np.moveaxis(matrix, 0, -1)


def _csd(
    campaign: Campaign,
    dataset: Dataset,
    condition: Condition,
    lines_Hz: Reals,
    values: Complexes,
    *,
    away: bool = False,
) -> Complexes:
    """Of a run, (F, channels, channels); of the campaign under its condition."""
    record, known = dataset.record, campaign.stated.irregularity
    sensors = [campaign.sensor(name) for name in dataset.names("channel")]
    if record.interpolated_Hz is None:
        lines_Hz, values = halved(lines_Hz, values, record.segment_s)
    grid = grid_of(lines_Hz, dataset.frequency_Hz, record.segment_s)
    work = worked(campaign.model, known, condition, grid, lines_Hz, values)
    temperature = hammer.temperature(campaign, condition)
    rolls = rolling_of(work.model, known.rolls, condition, lines_Hz, values, temperature)
    return run.expected_csd(
        work.model,
        known,
        condition,
        sensors,
        lines_Hz,
        run.influence(work.model, lines_Hz, values),
        dataset.frequency_Hz,
        segment_s=record.segment_s,
        interpolated=record.interpolated_Hz is not None,
        duration_s=dataset.data.attrs.get("duration_s"),
        left=work.left,
        rolls=rolls,
        away=away,
    )


def added_to(campaign: Campaign, dataset: Dataset) -> Reals:
    """Expected cross spectra of the noise and hum of the channels of a run, (channels, channels, F)."""
    frequency, record = dataset.frequency_Hz, dataset.record
    sensors = [campaign.sensor(name) for name in dataset.names("channel")]
    lines = run.solved_lines(frequency, record.segment_s, record.interpolated_Hz)
    return np.moveaxis(run.added_csd(sensors, lines, frequency, record.segment_s), 0, -1)


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


def _check_on_board(campaign: Campaign, record: str, names: list[str]) -> None:
    for name in names:
        if campaign.sensor(name).degree is None:
            raise InputError(
                "stands beside the track, and the train passes it",
                where=f"records.{record}: sensors.{name}",
                remedy="give it a record of its own and hand predict a pass-by, or leave it out",
            )
