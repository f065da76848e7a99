"""How a record of a passage scatters by an unevenness: by marching in time, and where axles are slow."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import passages
import pytest
import uneven_passages as uneven
from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign
from permway.campaign.load import Dataset
from permway.campaign.predict import by_unevenness, predict, solved_of
from permway.campaign.predictions.passage import with_profile
from permway.campaign.predictions.suspended import Waves
from permway.model.irregularity import DensityTable
from permway.recordings.passing_axles import PassingAxles, Suspension

PLACE_M = 8.0
WAVES = DensityTable(wavenumber_rad_per_m=(0.01, 100.0), density_m2_per_rad_per_m=(0.4, 4e-13))


def columns_of(
    folder: Path, speed: float, direction: str, lags: tuple[float, ...]
) -> tuple[Campaign, Dataset, Complexes]:
    """A campaign, a record of displacement and acceleration, and what unevenness makes of it."""
    noise = np.random.default_rng(0).standard_normal((2, passages.time_s().size))
    axles = {"loads_N": [uneven.LOAD_N] * len(lags), "lags_m": list(lags), "direction": direction}
    axles["irregularity"] = WAVES.model_dump()
    campaign = uneven.campaign(folder, dict(zip("wa", noise, strict=True)), PLACE_M, speed=speed, **axles)
    (dataset,) = campaign.load()
    solved = solved_of(campaign, dataset)
    assert solved is not None
    return campaign, dataset, by_unevenness(campaign, dataset, *solved).spectra


@pytest.mark.parametrize(("speed", "direction"), [(8.0, "forward"), (30.0, "forward"), (30.0, "backward")])
def test_a_record_scatters_as_marched_in_time(speed: float, direction: str, tmp_path: Path) -> None:
    """The covariance of all lines together, and mean squares line by line, of 200 trains of two axles."""
    count, lags = 200, (0.0, 2.5)
    _, dataset, columns = columns_of(tmp_path, speed, direction, lags)
    entry = np.full(count, passages.ENTRY_S)
    trains = uneven.Trains(np.full(count, speed), entry, np.full((count, 2), uneven.LOAD_N), lags)
    place = PLACE_M if direction == "forward" else passages.LENGTH_M - PLACE_M
    histories = uneven.marched(trains, uneven.drawn(trains, WAVES.density, np.random.default_rng(11)), place)
    # Of acceleration the window leaks more into the lowest lines than there is.
    from_Hz = (0.0, 1.0)
    for history, column, least in zip(histories, columns, from_Hz, strict=True):
        used = dataset.data["frequency"].values >= least
        found, root = uneven.spectra(history, dataset)[:, used], column[used]
        parts = np.stack([root.real, root.imag], axis=1)
        each = parts @ np.swapaxes(parts, 1, 2)
        expected = np.trace(each, axis1=1, axis2=2)
        chance = np.sqrt(2.0 * np.trace(each @ each, axis1=1, axis2=2) / count)
        assert (np.abs(np.mean(np.abs(found) ** 2, axis=0) - expected) < 4.0 * chance).all()
        # By covariance and a little noise of their own, all rows are white.
        whole = np.concatenate([root.real, root.imag])
        little = 0.01 * np.sqrt(np.mean(whole**2) * whole.shape[1])
        rows = np.concatenate([found.real, found.imag], axis=1)
        rows += little * np.random.default_rng(12).standard_normal(rows.shape)
        white = np.linalg.solve(np.linalg.cholesky(whole @ whole.T + little**2 * np.eye(len(whole))), rows.T)
        assert np.mean(white**2) == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("direction", ["forward", "backward"])
def test_a_known_profile_is_met_as_marched_in_time(direction: str, tmp_path: Path) -> None:
    """With loads, over waves up to 8 Hz, to 0.2 % of what the profile does; it does a good part of the loads'."""
    speed, lags = 30.0, (0.0, 2.5)
    campaign, dataset, _ = columns_of(tmp_path, speed, direction, lags)
    trains = uneven.Trains(np.array([speed]), np.array([passages.ENTRY_S]), np.full((1, 2), uneven.LOAD_N), lags)
    waves = uneven.drawn(trains, WAVES.density, np.random.default_rng(13)) * (uneven.HERTZ < 8.0)
    place = PLACE_M if direction == "forward" else passages.LENGTH_M - PLACE_M
    history = uneven.marched(trains, waves, place, static=True)[0, 0]
    number, late = 2.0 * np.pi * uneven.HERTZ / speed, 0.0 if direction == "forward" else passages.LENGTH_M
    # Waves of a record lie along the way, from x = 0.
    amplitude = waves[0, :, None] * np.exp(1j * number * late)[:, None]
    known = replace(dataset, data=with_profile(dataset.data, Waves(number, amplitude), np.ones(1)))
    found, smooth = (one["spectrum"].values[0] for one in predict(campaign, [known, dataset], threads=1))
    marched = uneven.spectra(history, dataset)
    size = np.abs(found - smooth).max()
    assert size > 0.02 * np.abs(smooth).max()
    assert np.abs(found - marched).max() < 0.002 * np.abs(smooth).max()
    assert np.abs(found - marched).max() < 0.05 * size


def receptances(x_m: Reals, hertz: Reals) -> tuple[Complexes, Complexes]:
    """Of the beam at a place per force there, and at the sensor, (places, frequencies), m/N, by its modes."""
    n = np.arange(1, uneven.MODES + 1)
    omega = 2.0 * np.pi * hertz
    at = np.sin(np.pi * np.outer(x_m, n) / passages.LENGTH_M)
    stiffness, damping = uneven.modal()
    system = np.diag(stiffness) - omega[:, None, None] ** 2 * np.eye(n.size) + 1j * omega[:, None, None] * damping
    moved = np.linalg.solve(system, uneven.PER_FORCE * np.broadcast_to(at.T, (hertz.size, *at.T.shape)))
    sensor = np.sin(np.pi * n * PLACE_M / passages.LENGTH_M)
    return np.einsum("xn,fnx->xf", at, moved), np.einsum("n,fnx->xf", sensor, moved)


def test_slow_axles_push_by_receptances_where_they_are(tmp_path: Path) -> None:
    """Energy of the band: at 8 m/s to 5 %; at 30 m/s axles have moved on before the beam has answered."""
    off = []
    for speed in (8.0, 30.0):
        _, dataset, columns = columns_of(tmp_path / str(speed), speed, "forward", (0.0,))
        hertz = dataset.data["frequency"].values
        x = (np.arange(400) + 0.5) / 400 * passages.LENGTH_M
        under, across = receptances(x, hertz)
        answer = Suspension(**uneven.SUSPENSION).answer(np.array([uneven.LOAD_N]), 2.0 * np.pi * hertz)
        force = WAVES.density(hertz, speed) / np.abs(1.0 / answer - under) ** 2
        # The spectrum over a record of a one-sided density is half of it for each second.
        energy = 0.5 * np.mean(np.abs(across) ** 2 * force, axis=0) * passages.LENGTH_M / speed
        used = hertz > 2.0
        off.append(np.sum(np.abs(columns[0]) ** 2, axis=-1)[used].sum() / energy[used].sum() - 1.0)
    assert abs(off[0]) < 0.05, off
    assert abs(off[1]) > 0.1, off


def test_an_unevenness_needs_springs() -> None:
    with pytest.raises(ValueError, match="have a suspension"):
        PassingAxles(loads_N=(1e5,), lags_m=(0.0,), body="deck", irregularity=WAVES)
