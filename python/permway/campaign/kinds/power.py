"""Power and cross spectra of runs on board of a train."""

from __future__ import annotations

import numpy as np
import xarray as xr

from permway.arrays import Complexes, Reals
from permway.campaign import spectra
from permway.campaign.campaign import Campaign
from permway.campaign.dataset import SI_UNITS, Dataset, in_band, level_averages
from permway.campaign.factors import campaign_under
from permway.campaign.kinds.kind import Interval, RecordKind, of_solved
from permway.campaign.parts import Condition, Record
from permway.campaign.predictions import hammer, run
from permway.campaign.predictions.grid import grid_of, halved
from permway.campaign.predictions.rolling import rolling_of
from permway.campaign.predictions.sliding import worked
from permway.campaign.predictions.sweeps import Request, Result
from permway.campaign.welch import cross_spectra_of
from permway.errors import InputError
from permway.recordings.channel import Sensor
from permway.recordings.estimates.intervals import power_interval


class PowerSpectra(RecordKind):
    """Of samples over time, or of a file of spectra."""

    name = "spectra"
    statistics = ("csd", "psd")
    title = "spectra of runs"
    variable = "psd"
    dimensions = ("channel", "frequency")
    power = True
    noise = "by the effective number of averages"

    def load(self, campaign: Campaign, record: Record) -> xr.Dataset:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        return _loaded(campaign, record)

    def request(self, campaign: Campaign, dataset: Dataset, condition: Condition) -> Request:
        """The receptances between all wheels."""
        record, train = dataset.record, campaign.model.train
        _check_on_board(campaign, record.name, dataset.names("channel"))
        lines = run.solved_lines(dataset.frequency_Hz, record.segment_s, record.interpolated_Hz)
        assert train is not None
        locations = tuple((train.body, float(x)) for x in run.wheels_of(campaign.model, condition))
        return Request(hammer.needed_temperature(campaign, condition), lines, locations, locations)

    def predicted(
        self, campaign: Campaign, dataset: Dataset, condition: Condition, solved: tuple[Request, Complexes] | None
    ) -> xr.Dataset:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        request, values = of_solved(solved)
        matrix = _csd(campaign, dataset, condition, request.frequency_Hz, values)
        own = np.arange(len(matrix))
        return dataset.template(self.blank).copy(data={"csd": matrix, "psd": matrix[own, own].real})

    def blank(self, data: xr.Dataset) -> xr.Dataset:
        """Cross and power spectra."""
        return data[["csd", "psd"]]

    def unit(self, campaign: Campaign, dataset: Dataset, channel: str) -> str:
        """Of the sensor, squared, over Hz."""
        return f"({SI_UNITS[campaign.sensor(channel).quantity]})2/Hz"

    def interval(self, dataset: Dataset, measured: Complexes | Reals, scatter_dB: Reals) -> Interval:
        """By the degrees of freedom, fewer of a channel whose level varies."""
        data = dataset.data
        freedom = data["degrees_of_freedom"].broadcast_like(data["psd"]).transpose(*data["psd"].dims)
        varied = level_averages(data) / float(data.attrs["averages"])
        low, high = power_interval(np.abs(measured), freedom.values * varied[:, None])
        return low, high, np.full(measured.shape, np.nan)


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
    return _csd(campaign_under(campaign, condition), dataset, condition, request.frequency_Hz, values, away=True)


def added_to(campaign: Campaign, dataset: Dataset) -> Reals:
    """Expected cross spectra of the noise and hum of the channels of a run, (channels, channels, F)."""
    frequency, record = dataset.frequency_Hz, dataset.record
    sensors = tuple(campaign.sensor(name) for name in dataset.names("channel"))
    lines = run.solved_lines(frequency, record.segment_s, record.interpolated_Hz)
    return run.added_csd(sensors, lines, frequency, record.segment_s)


def _csd(
    campaign: Campaign,
    dataset: Dataset,
    condition: Condition,
    lines_Hz: Reals,
    values: Complexes,
    *,
    away: bool = False,
) -> Complexes:
    """Of a run, (channels, channels, F); of the campaign under its condition."""
    record, known = dataset.record, campaign.stated.irregularity
    sensors = [campaign.sensor(name) for name in dataset.names("channel")]
    if record.interpolated_Hz is None:
        lines_Hz, values = halved(lines_Hz, values, record.segment_s)
    grid = grid_of(lines_Hz, dataset.frequency_Hz, record.segment_s)
    work = worked(campaign.model, known, condition, grid, lines_Hz, values)
    temperature = hammer.needed_temperature(campaign, condition)
    rolls = rolling_of(work.model, known.rolls, condition, lines_Hz, values, temperature)
    matrix = run.expected_csd(
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
    return np.moveaxis(matrix, 0, -1)


def _check_on_board(campaign: Campaign, record: str, names: list[str]) -> None:
    for name in names:
        if campaign.sensor(name).degree is None:
            raise InputError(
                "stands beside the track, and the train passes it",
                where=f"records.{record}: sensors.{name}",
                remedy="give it a record of its own and hand predict a pass-by, or leave it out",
            )


def _loaded(campaign: Campaign, record: Record) -> xr.Dataset:
    """Cross spectra as `permway.recordings.estimates.welch` gives them, in SI, of the band's usable lines."""
    sensors = [campaign.sensor(name) for name in record.channels.values()]
    if record.averages is not None:
        return _in_SI(spectra.from_file(campaign, record), record, sensors)
    data = cross_spectra_of(
        campaign.samples(record),
        segment_s=record.segment_s,
        channels=[sensor.name for sensor in sensors],
        units=[SI_UNITS[sensor.quantity] for sensor in sensors],
        band_Hz=record.band_Hz or (0.0, np.inf),
    )
    return _in_SI(data, record, sensors)


def _in_SI(data: xr.Dataset, record: Record, sensors: list[Sensor]) -> xr.Dataset:
    """Spectra of the band's usable lines, in SI."""
    frequency = data["frequency"].values
    used = in_band(frequency, record) & data["usable"].values
    if not used.any():
        raise InputError("holds no usable line of the record", where="band_Hz", value=record.band_Hz)
    data = data.isel(frequency=np.flatnonzero(used))
    if not np.isfinite(data["csd"].values).all():
        at = np.argwhere(~np.isfinite(data["csd"].values))[0]
        where = f"{record.file}: channel '{data['channel'].values[at[0]]}', {data['frequency'].values[at[2]]:g} Hz"
        raise InputError("not a finite number", where=where, remedy="leave the line out of the record's band_Hz")
    si = np.array([sensor.to_SI for sensor in sensors])
    data["csd"] = data["csd"].copy(data=data["csd"].values * (si[:, None] * si)[:, :, None])
    data["psd"] = data["psd"].copy(data=data["psd"].values * (si**2)[:, None])
    return data.assign_attrs(segment_s=record.segment_s)
