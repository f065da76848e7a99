"""Frequency responses from force points to sensors, with their coherence."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign
from permway.campaign.dataset import SI_UNITS, Dataset, in_band
from permway.campaign.kinds.kind import Interval, RecordKind, of_solved
from permway.campaign.kinds.pairs import check_units, rows_of, unsure
from permway.campaign.parts import Condition, Record
from permway.campaign.predictions import hammer
from permway.campaign.predictions.sweeps import Request
from permway.errors import InputError
from permway.recordings.estimates.intervals import frf_interval
from permway.recordings.line_scatter import FREEDOM as SCATTER_FREEDOM
from permway.recordings.line_scatter import scatter_variance
from permway.recordings.readers import read_frf
from permway.recordings.record import FrfRecord
from permway.response.receptance import frequency_coordinate

DIMENSIONS = ("sensor", "force", "frequency")

LEAST_COHERENCE = 1e-3
"""Coherence below this counts as this: its line states nothing, but its variance stays a number."""

MOST_COHERENCE = 1.0 - 1e-5
"""Coherence above this counts as this: files print so many digits, and no measurement is exact."""


class Responses(RecordKind):
    """Of hammer and shaker tests."""

    name = "frf"
    statistics = ("frf",)
    title = "hammer responses"
    variable = "frf"
    dimensions = DIMENSIONS
    noise = "of each line by coherence and averages"

    def load(self, campaign: Campaign, record: Record) -> xr.Dataset:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        return _loaded(campaign, record)

    def request(self, campaign: Campaign, dataset: Dataset, condition: Condition) -> Request:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        sensors, points = dataset.names("sensor"), dataset.names("force")
        return hammer.request(campaign, condition, sensors, points, dataset.frequency_Hz)

    def predicted(
        self, campaign: Campaign, dataset: Dataset, condition: Condition, solved: tuple[Request, Complexes] | None
    ) -> xr.Dataset:
        """See :class:`permway.campaign.kinds.kind.RecordKind`."""
        _, values = of_solved(solved)
        sensors = [campaign.sensor(name) for name in dataset.names("sensor")]
        read = hammer.read(sensors, [campaign.point(n) for n in dataset.names("force")], dataset.frequency_Hz)
        frf = np.ascontiguousarray(np.moveaxis(values * read, 0, -1))
        noise = np.array([sensor.chain.noise_factor for sensor in sensors])
        chain = np.moveaxis(read, 0, -1)
        return dataset.template(self.blank).copy(data={"frf": frf, "noise_factor": noise, "chain": chain})

    def blank(self, data: xr.Dataset) -> xr.Dataset:
        """Responses, noise by sensor, and the chains of the pairs."""
        found = data[["frf"]]
        found["noise_factor"] = xr.Variable("sensor", np.ones(found.sizes["sensor"]), {"units": "1"})
        named = {"long_name": "what is read over the receptance"}
        found["chain"] = xr.Variable(found["frf"].dims, found["frf"].values, named)
        return found

    def unmeasured(self, dataset: Dataset) -> list[str]:
        """Pairs of the grid of sensors and points that the file does not have."""
        sensor, force = self.channels(dataset)
        empty = np.isnan(dataset.data["frf"].values).all(axis=-1).ravel()
        return [f"{s} < {f}" for s, f, none in zip(sensor, force, empty, strict=True) if none]

    def channels(self, dataset: Dataset) -> tuple[list[str], list[str]]:
        """Pairs of sensor and point."""
        sensors, forces = dataset.names("sensor"), dataset.names("force")
        return [s for s in sensors for _ in forces], [f for _ in sensors for f in forces]

    def unit(self, campaign: Campaign, dataset: Dataset, channel: str) -> str:
        """Of the sensor, over the force."""
        return f"({SI_UNITS[campaign.sensor(channel).quantity]})/N"

    def interval(self, dataset: Dataset, measured: Complexes | Reals, scatter_dB: Reals) -> Interval:
        """By coherence or scatter; NaN where neither is known."""
        data, shape = dataset.data, measured.shape
        low, high, half = (np.full(shape, np.nan) for _ in range(3))
        variance = data["log_variance"].values.reshape(shape)
        scattered = dataset.record.noise == "scatter"
        free = SCATTER_FREEDOM if scattered else 2.0 * (float(data.attrs.get("averages", np.nan)) - 1.0)
        known = np.isfinite(variance) & np.isfinite(measured) & (free > 0.0)
        if known.any():
            found = frf_interval(measured[known], variance[known], free)
            low[known], high[known] = found.magnitude
            half[known] = 0.5 * (found.phase_rad.high - found.phase_rad.low)
        return low, high, half


def _read(
    campaign: Campaign, record: Record, responses: list[str] | None, references: list[str] | None
) -> FrfRecord:
    """A record's file, with the pairs of these labels; all without."""
    return read_frf(
        campaign.path(record),
        responses=responses,
        references=references,
        format=record.format,
        part=record.part,
        hints=record.hints,
        keep_nonfinite=True,
    )


def _loaded(campaign: Campaign, record: Record) -> xr.Dataset:
    """What a file of frequency responses holds of a record's pairs and band, in SI."""
    sensors, points = list(record.responses), list(record.references)
    file = _read(campaign, record, sensors, points)
    frequency = np.asarray(file.frequency_Hz, dtype=np.float64)
    used = in_band(frequency, record)
    at = rows_of(record, file, lambda: _read(campaign, record, None, None))
    file.of(sensors, points).check_finite(used)
    check_units(campaign, record, file, at)
    there = (at >= 0)[:, :, None]

    def spread(values: np.ndarray) -> np.ndarray:
        # A pair that was not measured stays empty, and is not made up.
        return np.where(there, np.asarray(values)[at][:, :, used], np.nan)

    names = [record.responses[label] for label in sensors]
    forces = [record.references[label] for label in points]
    scale = np.array([campaign.sensor(name).to_SI for name in names])[:, None] / np.array(
        [campaign.point(name).to_SI for name in forces]
    )
    frf = spread(file.values) * scale[:, :, None]
    coherence, variance, averages = _noise(record, file, frequency[used], frf, spread, at)
    data = xr.Dataset(
        {
            "frf": (DIMENSIONS, frf),
            "coherence": (DIMENSIONS, coherence),
            "log_variance": (DIMENSIONS, variance),
        },
        coords={"frequency": frequency_coordinate(frequency[used]), "sensor": names, "force": forces},
    )
    data["frf"].attrs = {"long_name": "frequency response, read over read", "units": "SI/N"}
    data["coherence"].attrs = {"long_name": "coherence", "units": "1"}
    data["log_variance"].attrs = {"long_name": "variance of log magnitude and of phase", "units": "1"}
    data.attrs |= {"noise": record.noise} | ({} if averages is None else {"averages": averages})
    return data


def _noise(
    record: Record,
    file: FrfRecord,
    frequency_Hz: Reals,
    frf: Complexes,
    spread: Callable[[Reals], Reals],
    at: np.ndarray,
) -> tuple[Reals, Reals, float | None]:
    """Coherence, variance of log magnitude and of phase, and averages, as the record states what states them.

    Raises
    ------
    InputError
        Without averages or coherence where those should state it, if of one pair only; with a coherence that would
        be left aside.
    """
    without = unsure(record, file, at)
    if record.noise == "scatter":
        # Of a record some of whose pairs have none, the scatter states the noise of all.
        if file.coherence is not None and not without:
            remedy = 'leave noise = "scatter" out'
            raise InputError("has a coherence, which states more than scatter", where=record.file, remedy=remedy)
        return np.full(frf.shape, np.nan), scatter_variance(frequency_Hz, frf, where="band_Hz"), None
    averages = record.averages or file.averages
    if averages is None:
        remedy = "give the number of blows of each point, as in averages = 8"
        raise InputError("missing, and the file does not say", where="averages", remedy=remedy)
    if file.coherence is None:
        remedy = (
            "export it beside the responses, as an array or column named coherence, 0 to 1; without one, "
            'noise = "scatter" takes the scatter of neighbouring lines for it'
        )
        raise InputError("has no coherence, which states how sure each line is", where=record.file, remedy=remedy)
    if without:
        label, struck = without[0]
        more = f" (nor have {len(without) - 1} more pairs of it)" if len(without) > 1 else ""
        remedy = (
            "give its coherence column; or leave it out of responses or references; or "
            'noise = "scatter" takes the scatter of neighbouring lines for it, in the whole record'
        )
        what = f"has no coherence, which states how sure each line is, though other pairs have one{more}"
        raise InputError(what, where=f"{record.file}: {label} / {struck}", remedy=remedy)
    coherence = spread(file.coherence)
    return coherence, log_variance(coherence, averages), float(averages)


def log_variance(coherence: Reals, averages: float) -> Reals:
    """Variance of the log magnitude (nepers) and of the phase (rad) of an H1 estimate, shape of the coherence.

    (1 - g2) / (2 K g2), Bendat and Piersol, Random Data (2010), section 9.2. The coherence is itself an estimate,
    biased up by about (1 - g2)^2 / K.
    """
    squared = np.clip(coherence, LEAST_COHERENCE, MOST_COHERENCE)
    return np.asarray((1.0 - squared) / (2.0 * averages * squared))
