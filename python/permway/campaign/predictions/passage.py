"""What fixed sensors read while axles pass: loads that move over the line, statically and dynamically.

The equation is that of :mod:`permway.response.passby.carry`. Speed, loads and times act on receptances that are
solved once. Axles with a suspension push harder or less hard where the line moves under them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.fft import irfft

from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign
from permway.campaign.parts import Condition
from permway.campaign.passage import offset_m, path_under, points_of, spectrum_of
from permway.campaign.predictions.suspended import AxlesOnSprings, Waves
from permway.campaign.predictions.sweeps import Location, Request
from permway.errors import InputError
from permway.model.bodies import Beam
from permway.problem.model import Model
from permway.recordings.channel import Sensor
from permway.response.passby.carry import arrivals, carried, harmonic_moments
from permway.response.passby.path import Path
from permway.response.passby.transfer import STATIC_SHARE
from permway.response.passby.window import FLAT

SEAM, LATE = 0.01, (0.8, 0.9)
"""Largest motion late in the rest after the train, over the largest of all, and where in the rest that is."""

PROFILE = "profile"
"""Variable of a record's data: amplitudes of waves of the unevenness, m, over rad/m."""

RIGID = 5.0
"""Growth of the response from the first frequency down to its share, above which nothing holds the line."""


def request(
    campaign: Campaign, condition: Condition, names: list[str], temperature_C: float | None, data: xr.Dataset
) -> Request:
    """The receptances from every place of the path to every point that is read."""
    sensors = [campaign.sensor(name) for name in names]
    for sensor in sensors:
        if sensor.bends:
            _beam(campaign.model, sensor)
    path = path_under(campaign.model, condition, sensors, _highest(data))
    rows = dict.fromkeys((str(s.body), x) for s in sensors for x in points_of(campaign.model, s))
    columns = tuple((path.body, float(x)) for x in path.nodes.ravel())
    if condition.axles is not None and condition.axles.suspension is not None:
        rows |= dict.fromkeys(columns)
    frequency = _lines(data)
    frequency[0] = STATIC_SHARE * frequency[1]
    return Request(temperature_C, frequency, tuple(rows), columns)


class Scatter(NamedTuple):
    """What an unevenness makes of a record.

    Attributes
    ----------
    waves : Waves
        Profiles whose sum by independent normal coefficients it is.
    spectra : ndarray of complex128, shape (channel, frequency, profiles)
        By each of them. Their products are the covariance of the record's lines: as it leaves the same chains,
        filter and window, lines that share an axle's way correlate.
    known : ndarray of complex128, shape (channel, frequency)
        By the profile that predictions of the record have.
    """

    waves: Waves
    spectra: Complexes
    known: Complexes


def profile_of(data: xr.Dataset) -> Waves:
    """The profile that predictions of a record have: none before a fit has estimated it."""
    if PROFILE not in data:
        return Waves.none()
    return Waves(data["wavenumber"].values, data[PROFILE].values[:, None])


def with_profile(data: xr.Dataset, waves: Waves, coefficients: Reals) -> xr.Dataset:
    """A record's data, predictions of which have the sum of some profiles by these coefficients."""
    other = data.drop_dims("wavenumber", errors="ignore").assign_coords(wavenumber=waves.wavenumber)
    return other.assign({PROFILE: ("wavenumber", waves.amplitude @ coefficients)})


class Passing:
    """A line under the axles of a condition, and what sensors make of their forces.

    Parameters
    ----------
    campaign : Campaign
    condition : Condition
    names : list of str
        Of the sensors.
    data : Dataset of xarray
        The record's.
    request : Request
        See :func:`request`.
    receptance : ndarray of complex128, shape (F, rows, columns)
        Of the request.

    Raises
    ------
    InputError
        For a line that nothing holds, a sensor whose beam does not bend as Euler's does.
    """

    def __init__(
        self,
        campaign: Campaign,
        condition: Condition,
        names: list[str],
        data: xr.Dataset,
        request: Request,
        receptance: Complexes,
    ) -> None:
        sensors = [campaign.sensor(name) for name in names]
        self._condition, self._data, self._request = condition, data, request
        self._path = path_under(campaign.model, condition, sensors, _highest(data))
        if np.abs(receptance[0]).max() > RIGID * np.abs(receptance[1]).max():
            remedy = "hold it, or give from_m and to_m"
            raise InputError("nothing holds the line at rest", where="line", remedy=remedy)
        self._held = receptance.copy()
        self._held[0] = self._held[0].real
        self._frequency_Hz = _lines(data)
        read = _read(campaign.model, sensors, request.rows)
        self._coefficients = self._path.coefficients(np.einsum("sr,frp->fsp", read, self._held))
        share = np.arange(self._frequency_Hz.size) / max(self._frequency_Hz.size - 1, 1)
        self._low_pass = 0.5 * (1.0 + np.cos(np.pi * np.clip((share - FLAT) / (1.0 - FLAT), 0.0, 1.0)))
        self._transfer = np.stack([s.transfer(self._frequency_Hz) for s in sensors])

    def predicted(self) -> tuple[Complexes, float]:
        """Spectra as :func:`permway.campaign.passage.passage` gives them, (channel, frequency).

        Beside them the largest motion where the periodic window begins anew, over the largest of all: see
        :func:`check_seam`.
        """
        moments, axles = self._loaded(), self._axles()
        return self._record(moments if axles is None else axles.carrying(moments, profile_of(self._data)))

    def by_unevenness(self) -> Scatter:
        """What the unevenness that axles meet makes of the record."""
        axles, blank = self._axles(), np.zeros((*self._data["spectrum"].shape, 1), dtype=np.complex128)

        def spectra(waves: Waves) -> Complexes:
            found = [] if axles is None else [self._record(one)[0] for one in axles.on(waves)]
            return np.concatenate([blank[..., :0], *(one[..., None] for one in found)], axis=-1)

        waves = Waves.none() if axles is None else axles.waves()
        return Scatter(waves, spectra(waves), spectra(profile_of(self._data)).sum(axis=-1))

    def _loaded(self) -> Complexes:
        """Moments of all loads on the clock of the records, (F, panels, order)."""
        axles, speed = self._condition.axles, self._condition.speed_m_per_s
        assert axles is not None
        assert speed is not None
        omega = 2.0 * np.pi * self._frequency_Hz
        sign = 1.0 if axles.direction == "forward" else -1.0
        # Along -x the same integral over x, whose element is then negative.
        moments = sign * harmonic_moments(self._path, omega, sign * speed)
        loads = arrivals(omega, axles.loads, axles.arrivals_s(speed, self._path.start, self._path.stop))
        return np.asarray(moments * loads[:, None, None])

    def _axles(self) -> AxlesOnSprings | None:
        """Those on springs; None where forces are the loads."""
        axles, speed, path = self._condition.axles, self._condition.speed_m_per_s, self._path
        assert axles is not None
        assert speed is not None
        if axles.suspension is None:
            return None
        nodes = [self._request.rows.index((path.body, float(x))) for x in path.nodes.ravel()]
        return AxlesOnSprings(axles, speed, path, self._frequency_Hz, path.coefficients(self._held[:, nodes]))

    def _record(self, moments: Complexes) -> tuple[Complexes, float]:
        """Spectra of the record by forces of these moments, and the motion at the seam."""
        spectrum, _ = carried(self._coefficients, moments)
        turned = spectrum.T * self._low_pass * self._transfer
        return _recorded(turned, self._frequency_Hz, self._condition, self._path, self._data)


def _highest(data: xr.Dataset) -> float:
    return float(data["frequency"].values[-1])


def _lines(data: xr.Dataset) -> Reals:
    """Of the periodic window from 0 Hz, kept whole up to the record's last line."""
    step = data.attrs["sampling_Hz"] / data.attrs["window_samples"]
    count = int(np.ceil(_highest(data) / FLAT / step)) + 1
    return np.asarray(np.arange(count) * step, dtype=np.float64)


def _read(model: Model, sensors: list[Sensor], rows: tuple[Location, ...]) -> Complexes:
    """What sensors read of the displacements at the points, (sensors, points), but for derivatives in time."""
    found = np.zeros((len(sensors), len(rows)), dtype=np.complex128)
    for index, sensor in enumerate(sensors):
        places = [rows.index((str(sensor.body), x)) for x in points_of(model, sensor)]
        if not sensor.bends:
            found[index, places[0]] = 1.0
            continue
        bent = np.array([1.0, -2.0, 1.0]) / offset_m(model, sensor) ** 2
        size = -sensor.height_m if sensor.height_m is not None else -_bending(model, sensor)
        found[index, places] = size * bent
    return found


def _bending(model: Model, sensor: Sensor) -> complex:
    """Bending stiffness where a sensor is, N m2."""
    x = float(sensor.x_m or 0.0)
    beam = _beam(model, sensor)
    if beam.stiffness_damping_s > 0.0:
        raise InputError(
            "the moment of a beam with stiffness_damping_s goes with its speed, too",
            where=f"sensors.{sensor.name}.quantity",
            remedy="read a strain, with height_m, or give the beam a damping_ratio",
        )
    factors = [c.bending_factor for c in beam.changes if c.from_m <= x <= c.to_m]
    return beam.bending_Nm2 * (factors[0] if factors else 1.0)


def _beam(model: Model, sensor: Sensor) -> Beam:
    where = f"sensors.{sensor.name}.body"
    segment = model.line.segments()[model.line.locate(str(sensor.body), float(sensor.x_m or 0.0), where=where)]
    beam = model.line.bodies[segment.body]
    if not isinstance(beam, Beam):
        raise InputError("only beams bend", where=where, value=sensor.body)
    if beam.theory != "euler":
        what = "strain and bending moment are read of Euler beams: of others shear bends the axis, too"
        raise InputError(what, where=where, value=sensor.body, remedy='take theory = "euler"')
    return beam


def check_seam(record: str, data: xr.Dataset, seam: float) -> None:
    """Refuse a prediction whose window does not hold what the line does after the train.

    Raises
    ------
    InputError
        With the length that may hold it.
    """
    window = data.attrs["window_samples"] / data.attrs["sampling_Hz"]
    if seam > SEAM:
        raise InputError(
            f"the line still moves where the window of {window:.3g} s ends, by {seam:.2g} of its largest value",
            where=f"records.{record}.window_s",
            remedy=f"give it {2.0 * window:.3g}, so that the line comes to rest after the train",
        )


def _recorded(
    spectrum: Complexes, frequency_Hz: Reals, condition: Condition, path: Path, data: xr.Dataset
) -> tuple[Complexes, float]:
    """From spectra over the periodic window to those of the record, faded as it is; and the motion at the seam."""
    axles, speed = condition.axles, condition.speed_m_per_s
    assert axles is not None
    assert speed is not None
    rate, window = float(data.attrs["sampling_Hz"]), int(data.attrs["window_samples"])
    start, samples = float(data.attrs["start_s"]), int(data.attrs["samples"])
    whole = np.zeros((spectrum.shape[0], window // 2 + 1), dtype=np.complex128)
    whole[:, : frequency_Hz.size] = spectrum * np.exp(2j * np.pi * frequency_Hz * start)
    history = np.asarray(irfft(whole, n=window, axis=-1) * rate)
    crossing = (path.stop - path.start + axles.lags_m[-1]) / speed
    last = max(start + samples / rate, axles.entry_s + crossing)
    rest = window / rate - (last - min(start, axles.entry_s))
    # Late in the rest, and not at its end: laws of constant loss answer a little before they are asked.
    late = (last - start + rest * np.array(LATE)) * rate
    left = np.abs(history[:, np.arange(*late.astype(np.int64)) % window]).max(axis=1, initial=0.0)
    level = float((left / np.maximum(np.abs(history).max(axis=1), 1e-300)).max())
    lines = spectrum_of(history[:, :samples], rate)
    number = np.round(data["frequency"].values * samples / rate).astype(np.int64)
    return np.asarray(lines[:, number]), level
