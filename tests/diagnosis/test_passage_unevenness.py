"""What a fit says of axles that random unevenness has shaken, in records that are marched in time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import passages
import pytest
import uneven_passages as uneven
from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.campaign.load import Dataset
from permway.diagnosis.blocks_passage import PassageBlock
from permway.diagnosis.fit import free_parameters
from permway.diagnosis.gather import first_size, gather
from permway.model.irregularity import GermanHigh
from permway.posterior.estimate import least_objective
from permway.posterior.fit import Fit
from permway.posterior.hyper_slope import hyper_slope
from permway.posterior.recalibrated import recalibrated
from test_passage import NOISE

LAGS_M, PLACE_M, SPEED = (0.0, 2.5), 8.0, 30.0
TRUE = GermanHigh()


def campaign_of(folder: Path, irregularity: GermanHigh | None) -> Campaign:
    """One sensor of displacement, whose samples do not matter."""
    noise = {"w": np.random.default_rng(0).standard_normal(passages.time_s().size)}
    axles = {"loads_N": [uneven.LOAD_N] * 2, "lags_m": list(LAGS_M)}
    if irregularity is not None:
        axles["irregularity"] = irregularity.model_dump(exclude_none=True)
    return uneven.campaign(folder, noise, PLACE_M, speed=SPEED, **axles)


def density(hertz: Reals, speed: float) -> Reals:
    """Of the unevenness, m2/Hz; none beyond the waves that its source covers."""
    shortest, longest = TRUE.valid_wavelength_m
    covered = np.clip(hertz, speed / longest, speed / shortest)
    return np.where(covered == hertz, TRUE.density(covered, speed), 0.0)


def drawn(folder: Path, count: int, seed: int) -> Iterator[tuple[Reals, Dataset]]:
    """True parameters from their priors, and records with noise and with errors of chains from theirs."""
    campaign, random = campaign_of(folder, None), np.random.default_rng(seed)
    free = free_parameters(campaign)
    z = random.standard_normal((count, len(free)))
    values = [{f.name: f.value(float(v)) for f, v in zip(free, row, strict=True)} for row in z]
    conditions = [campaign.with_values(one).condition("train") for one in values]
    trains = uneven.Trains(
        np.array([c.speed_m_per_s for c in conditions]),
        np.array([c.axles.entry_s for c in conditions]),
        np.array([c.axles.loads for c in conditions]),
        LAGS_M,
    )
    histories = uneven.marched(trains, uneven.drawn(trains, density, random), PLACE_M, static=True)[0]
    (like,) = campaign.load()
    for row, history in zip(z, histories, strict=True):
        noise = NOISE * np.abs(history).max()
        spectrum = uneven.spectra(history + noise * random.standard_normal(history.size), like)[None]
        data = like.data.copy()
        of_part = noise * np.sqrt(0.5 * 0.95 * history.size) / passages.RATE_HZ
        data["noise_sd"] = (("channel", "frequency"), np.full(spectrum.shape, of_part))
        data["spectrum"] = (("channel", "frequency"), spectrum, like.data["spectrum"].attrs)
        block = PassageBlock(replace(like, data=data), reference=data[["spectrum"]], floor=0.0)
        errors, off = block.calibration, []
        for source in errors.sources:
            size = 0.0 if source.fixed else first_size(campaign, source.name)
            off.append(size * random.standard_normal(source.count))
        real, imaginary = errors.columns.times(np.concatenate(off)).reshape(2, -1)
        data["spectrum"] = (("channel", "frequency"), spectrum + (real + 1j * imaginary) * block.sigma)
        yield row, replace(like, data=data)


def fitted(campaign: Campaign, dataset: Dataset) -> Fit:
    """The nominal model, as a diagnosis begins with it."""
    return recalibrated(gather(campaign, [dataset], threads=1))


@pytest.mark.injection
def test_a_fit_lacks_nothing_and_is_surer_of_loads_and_speed(tmp_path: Path) -> None:
    """Without the unevenness a discrepancy takes it for something missing, and intervals are far wider.

    With a spectrum that is 9 times too high, 3 in amplitude, they are nearly the same: the level is estimated.
    """
    ((_, dataset),) = drawn(tmp_path / "d", 1, seed=21)
    stated = (TRUE, GermanHigh(scale=9.0), None)
    right, high, none = (fitted(campaign_of(tmp_path / str(i), one), dataset) for i, one in enumerate(stated))
    assert right.hyper.novel < 0.05 < 0.9 < none.hyper.novel
    assert right.log_evidence > none.log_evidence + 10.0
    sigma, rougher, wide = (np.sqrt(np.diag(fit.spread)) for fit in (right, high, none))
    assert (sigma < 0.6 * wide).all(), sigma / wide
    assert high.hyper["unevenness"] == pytest.approx(right.hyper["unevenness"] / 3.0, rel=0.3)
    assert (np.abs(np.log(rougher / sigma)) < 0.25).all(), rougher / sigma
    assert (np.abs(high.z - right.z) < 0.3 * sigma).all()


def test_the_slope_by_how_rough_it_is_is_the_difference(tmp_path: Path) -> None:
    ((_, dataset),) = drawn(tmp_path / "d", 1, seed=23)
    fit = fitted(campaign_of(tmp_path / "c", TRUE), dataset)
    log = fit.hyper.log + 0.3
    objective, at = least_objective(fit), fit.hyper.names.index("unevenness")
    step = 1e-3 * np.eye(log.size)[at]
    found = hyper_slope(fit, fit.frame.covariance(fit.hyper.moved(log)))[at]
    assert found == pytest.approx((objective(log + step) - objective(log - step)) / 2e-3, rel=1e-3)


@pytest.mark.injection
def test_intervals_hold_the_truth_of_sixty(tmp_path: Path) -> None:
    """Nine tenths of loads, speed and times of entry."""
    campaign, off = campaign_of(tmp_path / "c", TRUE), []
    for z, dataset in drawn(tmp_path / "d", 64, seed=24):
        fit = fitted(campaign, dataset)
        off.append((fit.z - z) / np.sqrt(np.diag(fit.spread)))
    held = np.mean(np.abs(off) < 1.645, axis=0)
    assert (held > 0.8).all(), held
    assert 0.85 < held.mean() < 0.97, held
