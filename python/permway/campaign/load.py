"""From the files of a campaign to labelled datasets: what was measured, how surely, and of what it is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from permway.arrays import Complexes, Reals
from permway.campaign import spectra as campaign_spectra
from permway.campaign.parts import Condition, Record
from permway.campaign.welch import cross_spectra_of
from permway.errors import InputError
from permway.recordings.channel import Sensor
from permway.recordings.line_scatter import scatter_variance
from permway.recordings.readers import read_frf, time_blocks
from permway.recordings.record import FrfRecord
from permway.response.receptance import frequency_coordinate
from permway.units import check_same

if TYPE_CHECKING:
    from permway.campaign.campaign import Campaign

DIMENSIONS = ("sensor", "force", "frequency")

SI_UNITS = {
    "displacement": "m",
    "velocity": "m/s",
    "acceleration": "m/s2",
    "force": "N",
    "strain": "1",
    "bending_moment": "N m",
}

LEAST_COHERENCE = 1e-3
"""Coherence below this counts as this: its line states nothing, but its variance stays a number."""

MOST_COHERENCE = 1.0 - 1e-5
"""Coherence above this counts as this: files print so many digits, and no measurement is exact."""


@dataclass(frozen=True)
class Dataset:
    """One record of a campaign, ready to be held against a prediction.

    Attributes
    ----------
    record : Record
        As the campaign file has it.
    condition : Condition
    data : xarray.Dataset
        In SI, named by sensors and force points; by the record's statistic:

        - "frf": `frf` (sensor, force, frequency), complex; `coherence`; `log_variance`, of the log magnitude and
          of the phase in rad; attributes `noise` and `averages`. Of noise "scatter" the coherence is NaN, and
          there are no averages.
        - "csd", "psd": as :func:`permway.recordings.estimates.welch.cross_spectra` gives them: `csd` (channel,
          channel2, frequency), `psd` (channel, frequency), `degrees_of_freedom`, attribute `averages`.
        - "bands": `mean_square` (channel, band).
        - "decay": `decay_rate` (band,), dB/m.
        - "transmissibility": `transmissibility` (channel, frequency), complex.
        - "modes": `modes` and `relative_sd` (quantity, frequency), natural frequency in Hz and damping ratio;
          `shape` (sensor, frequency) if it is listed.
        - "passage": `spectrum`, complex, and `noise_sd` (channel, frequency).
        - "material": `modulus` (point,), complex, Pa or N/m, with `frequency` and `temperature_C` of every point.
    """

    record: Record
    condition: Condition
    data: xr.Dataset

    @cached_property
    def _names(self) -> dict[str, list[str]]:
        return {}

    def names(self, dimension: str) -> list[str]:
        """Of its sensors, forces or channels, in their order."""
        if dimension not in self._names:
            self._names[dimension] = [str(name) for name in self.data.variables[dimension].values]
        return self._names[dimension]

    @cached_property
    def template(self) -> xr.Dataset:
        """What is predicted of it, to be filled; of responses their chains, and noise by sensor, too."""
        statistic = self.record.statistic
        if statistic == "frf":
            found = self.data[["frf"]]
            found["noise_factor"] = xr.Variable("sensor", np.ones(found.sizes["sensor"]), {"units": "1"})
            named = {"long_name": "what is read over the receptance"}
            found["chain"] = xr.Variable(found["frf"].dims, found["frf"].values, named)
            return found
        if statistic == "passage":
            return self.data[["spectrum"]]
        return self.data[["csd", "psd"] if statistic in ("csd", "psd") else [statistic]]

    @cached_property
    def frequency_Hz(self) -> Reals:
        """Its lines, shape (F,)."""
        return np.asarray(self.data.variables["frequency"].values, dtype=np.float64)


def load(campaign: Campaign) -> list[Dataset]:
    """Read all records of a campaign.

    Raises
    ------
    InputError
        With the record and what is wrong in its file.
    """
    return [load_record(campaign, record) for record in campaign.stated.records]


def load_record(campaign: Campaign, record: Record) -> Dataset:
    """Read one record.

    Raises
    ------
    InputError
        With the record and what is wrong in its file.
    """
    from permway.campaign import tabular as tabular
    from permway.campaign.modes import modes
    from permway.campaign.passage import passage

    condition = campaign.condition(record.condition)
    makers: dict[str, Callable[[Campaign, Record], xr.Dataset]] = {
        "frf": _frf,
        "csd": _csd,
        "psd": _csd,
        "bands": tabular.bands,
        "decay": tabular.decay,
        "transmissibility": tabular.transmissibility,
        "material": tabular.material,
        "modes": modes,
        "passage": passage,
    }
    try:
        data = makers[record.statistic](campaign, record)
    except InputError as error:
        raise InputError(
            error.what, where=f"records.{record.name}: {error.where}", value=error.value, remedy=error.remedy
        ) from error
    data.attrs |= {
        "record": record.name,
        "condition": condition.name,
        "repeat": record.repeat,
        "source": str(campaign.path(record)),
    }
    if condition.temperature_C is not None:
        data.attrs["temperature_C"] = condition.temperature_C
    if condition.speed_m_per_s is not None:
        data.attrs["speed_m_per_s"] = condition.speed_m_per_s
    return Dataset(record, condition, data)


def in_band(frequency_Hz: Reals, record: Record) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Which frequencies a record uses: its band, and never 0 Hz.

    Raises
    ------
    InputError
        If none is left.
    """
    low, high = record.band_Hz or (0.0, np.inf)
    slack = 1e-9
    used = (frequency_Hz > 0.0) & (frequency_Hz >= low * (1.0 - slack)) & (frequency_Hz <= high * (1.0 + slack))
    if not used.any():
        reach = f"{frequency_Hz.min():g} to {frequency_Hz.max():g} Hz" if frequency_Hz.size else "nothing"
        raise InputError(
            "holds no line of the record", where="band_Hz", value=(low, high), remedy=f"it has {reach}"
        )
    return np.asarray(used)


def _frf(campaign: Campaign, record: Record) -> xr.Dataset:
    sensors, points = list(record.responses), list(record.references)
    file = read_frf(
        campaign.path(record),
        responses=sensors,
        references=points,
        format=record.format,
        part=record.part,
        hints=record.hints,
        keep_nonfinite=True,
    )
    frequency = np.asarray(file.frequency_Hz, dtype=np.float64)
    used = in_band(frequency, record)
    pairs = {pair: i for i, pair in enumerate(zip(file.responses, file.references, strict=True))}
    at = np.full((len(sensors), len(points)), -1, dtype=np.int64)
    for i, sensor in enumerate(sensors):
        for j, point in enumerate(points):
            at[i, j] = pairs.get((sensor, point), -1)
    for names, key, missing in (
        (sensors, "responses", (at < 0).all(axis=1)),
        (points, "references", (at < 0).all(axis=0)),
    ):
        if missing.any():
            label = names[int(np.flatnonzero(missing)[0])]
            known = sorted(set(getattr(file, key)))
            near = get_close_matches(label, known, 1)
            remedy = f"it has {known[:12]}{', ...' if len(known) > 12 else ''}"
            if near:
                remedy = f"did you mean {near[0]!r}? {remedy}"
            raise InputError("the file has no such label", where=f"{key}.{label}", remedy=remedy)
    file.of(sensors, points).check_finite(used)
    _check_units(campaign, record, file, at)
    there = (at >= 0)[:, :, None]

    def spread(values: np.ndarray) -> np.ndarray:
        # A pair that was not measured stays empty, and is not made up.
        return np.where(there, np.asarray(values)[at][:, :, used], np.nan)

    names = [record.responses[label] for label in sensors]
    forces = [record.references[label] for label in points]
    scale = np.array([campaign.sensor(name).to_SI for name in names])[:, None] / np.array(
        [1e3 if campaign.point(name).unit == "kN" else 1.0 for name in forces]
    )
    frf = spread(file.values) * scale[:, :, None]
    coherence, variance, averages = _noise(record, file, frequency[used], frf, spread)
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
    record: Record, file: FrfRecord, frequency_Hz: Reals, frf: Complexes, spread: Callable[[Reals], Reals]
) -> tuple[Reals, Reals, float | None]:
    """Coherence, variance of log magnitude and of phase, and averages, as the record states what states them.

    Raises
    ------
    InputError
        Without averages or coherence where those should state it; with a coherence that would be left aside.
    """
    if record.noise == "scatter":
        if file.coherence is not None:
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
    coherence = spread(file.coherence)
    return coherence, log_variance(coherence, averages), float(averages)


def _check_units(campaign: Campaign, record: Record, file: FrfRecord, at: np.ndarray) -> None:
    """Refuse a file whose unit is not that of the sensor over that of the force point.

    Raises
    ------
    InputError
        With the pair, both units, and the key that would settle it.
    """
    for i, (label, name) in enumerate(record.responses.items()):
        for j, (struck, point) in enumerate(record.references.items()):
            found = None if at[i, j] < 0 else file.unit_of(int(at[i, j]))
            if found is None:
                continue
            stated = f"({campaign.sensor(name).unit})/{campaign.point(point).unit}"
            where = f"{record.file}: {label} / {struck}"
            try:
                check_same(found, stated, where=where)
            except InputError as error:
                what = f"{error.what}: the sensor and the force point make it {stated!r}"
                what = (
                    what
                    if record.unit is None
                    else f"the record states {found!r}, sensor and force point {stated!r}"
                )
                remedy = f'correct the unit of the sensor or of the point; if the file is wrong, unit = "{stated}"'
                raise InputError(what, where=where, value=found, remedy=remedy) from error


def log_variance(coherence: Reals, averages: float) -> Reals:
    """Variance of the log magnitude (nepers) and of the phase (rad) of an H1 estimate, shape of the coherence.

    (1 - g2) / (2 K g2), Bendat and Piersol, Random Data (2010), section 9.2. The coherence is itself an estimate,
    biased up by about (1 - g2)^2 / K.
    """
    squared = np.clip(coherence, LEAST_COHERENCE, MOST_COHERENCE)
    return np.asarray((1.0 - squared) / (2.0 * averages * squared))


def _csd(campaign: Campaign, record: Record) -> xr.Dataset:
    """Cross spectra as `permway.recordings.estimates.welch` gives them, in SI, of the band's usable lines."""
    sensors = [campaign.sensor(name) for name in record.channels.values()]
    if record.averages is not None:
        return _in_SI(campaign_spectra.from_file(campaign, record), record, sensors)
    blocks = time_blocks(
        campaign.path(record),
        channels=list(record.channels),
        units={label: sensor.unit for label, sensor in zip(record.channels, sensors, strict=True)},
        sampling_Hz=record.sampling_Hz,
        format=record.format,
        part=record.part,
        hints=record.hints,
    )
    data = cross_spectra_of(
        blocks,
        segment_s=record.segment_s,
        channels=[sensor.name for sensor in sensors],
        units=[SI_UNITS[sensor.quantity] for sensor in sensors],
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
