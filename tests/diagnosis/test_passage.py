"""Passages under comparison and diagnosis: what a fit says of loads, speed and time, and how surely."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import passages
import pytest
from permway.arrays import Reals
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.load import Dataset
from permway.campaign.predict import predict
from permway.diagnosis.blocks_passage import ABOUT, FLOOR, PassageBlock
from permway.diagnosis.fit import free_parameters
from permway.diagnosis.gather import first_size, gather
from permway.diagnosis.speeds import begin
from permway.diagnosis.tangent import Problem
from permway.posterior.compare import compare
from permway.posterior.covariance import Frame
from permway.posterior.estimate import estimated
from permway.posterior.fit import Fit, Model
from permway.posterior.fitter import Fitter
from permway.report.compare import write_comparison
from scipy.ndimage import uniform_filter1d

NOISE = 1e-3
"""Of a sample over the largest of its sensor."""


def measured(folder: Path, names: str, *, seed: int = 2, drift: float = 0.0, **keys) -> Campaign:
    """The closed form's histories with noise, and a drift over the record in shares of their largest value."""
    time, random = passages.time_s(), np.random.default_rng(seed)
    columns = {}
    for name in names:
        values = passages.history(name, time, 0.01)
        size = np.abs(values).max()
        values = values + NOISE * size * random.standard_normal(time.size)
        columns[name] = values + drift * size * (1.0 + time / time[-1])
    table = passages.campaign(names, high_Hz=10.0)
    table["conditions"][0] |= keys
    return read_campaign(passages.write(folder, columns, table=table, loss_factor=0.02))


def fitted(campaign: Campaign, datasets: list[Dataset]) -> Fit:
    """The nominal model alone, as the posterior's search begins."""
    free = free_parameters(campaign)
    frame = Frame.of(gather(campaign, datasets, threads=1))
    z = begin(frame.observations, Problem(frame.observations, campaign.with_values, free))
    fitter = Fitter(frame)
    fit = fitter.begin(Model(campaign.with_values, free), z, frame.first())
    for level in (1.0, 0.2, 0.04):
        fit = fitter.fit(replace(fit, hyper=fit.hyper.with_discrepancy(level)), steps=8)
    fit = fitter.fit(estimated(fit), steps=12)
    # Errors of chains act on what the fit predicts.
    again = Fitter(frame.about(fit.state.solved, fit.covariance, fit.state.residuals))
    fit = again.fit(estimated(again.begin(fit.model, fit.z, fit.hyper)), steps=12)
    return again.settled(estimated(fit))


def simulated(campaign: Campaign, dataset: Dataset, seed: int, *, chains: float = 1.0) -> tuple[Reals, Dataset]:
    """True parameters from their priors, and a record of the model with errors of chains and noise from theirs.

    Errors of chains that are smooth over frequency may be larger.
    """
    random = np.random.default_rng(seed)
    free = free_parameters(campaign)
    z = random.standard_normal(len(free))
    true = campaign.with_values({f.name: f.value(float(v)) for f, v in zip(free, z, strict=True)})
    (found,) = predict(true, [dataset], threads=1)
    spectrum = found["spectrum"].values
    noise = NOISE * np.abs(spectrum).max(axis=1, keepdims=True)
    noise = np.broadcast_to(noise, spectrum.shape)
    data = dataset.data.copy()
    data["noise_sd"] = (("channel", "frequency"), noise.copy())
    block = PassageBlock(replace(dataset, data=data), reference=found, floor=0.0)
    smooth = block.calibration
    size = {True: chains, False: 1.0}
    sizes = [
        np.full(o.count, 0.0 if o.fixed else size[o.chain] * first_size(campaign, o.name)) for o in smooth.sources
    ]
    errors = smooth.columns.times(np.concatenate(sizes) * random.standard_normal(sum(map(len, sizes))))
    off = (errors + random.standard_normal(errors.size)).reshape(2, -1)
    whole = spectrum + (off[0] + 1j * off[1]).reshape(spectrum.shape) * block.sigma
    data["spectrum"] = (("channel", "frequency"), whole, dataset.data["spectrum"].attrs)
    return z, replace(dataset, data=data)


def missed(folder: Path, seeds: range) -> Reals:
    """By how many of their standard deviations a fit misses the parameters of simulated records."""
    campaign = measured(folder, "we")
    (dataset,) = campaign.load()
    rows = []
    for seed in seeds:
        z, drawn = simulated(campaign, dataset, seed)
        fit = fitted(campaign, [drawn])
        rows.append((fit.z - z) / np.sqrt(np.diag(fit.spread)))
    return np.array(rows)


def test_intervals_hold_the_truth(tmp_path: Path) -> None:
    """Nine tenths of the seven parameters of some records, within what chance makes of it; none is far off."""
    off = missed(tmp_path, range(5))
    assert np.mean(np.abs(off) < 1.645) > 0.8
    assert np.abs(off).max() < 4.0


def test_how_large_errors_of_chains_are_is_estimated(tmp_path: Path) -> None:
    """Of 8 % where 2 % is usual: parameters do not move for them by more than their intervals say."""
    campaign = measured(tmp_path, "we")
    (dataset,) = campaign.load()
    off, found = [], []
    for seed in range(2):
        z, drawn = simulated(campaign, dataset, seed, chains=4.0)
        fit = fitted(campaign, [drawn])
        off.append((fit.z - z) / np.sqrt(np.diag(fit.spread)))
        found.append(fit.hyper["channel"])
    assert min(found) > 0.04
    assert np.abs(off).max() < 3.0
    assert np.mean(np.abs(off) < 1.645) > 0.8


@pytest.mark.parametrize("off", [-2.5, 2.5])
def test_a_stiffness_far_off_is_found(tmp_path: Path, off: float) -> None:
    """The bridge rings on; slopes at the stated stiffness lead to another time of entry instead."""
    campaign = measured(tmp_path, "we")
    (dataset,) = campaign.load()
    known = campaign.parameters.known
    true = {"E": off, "t0": -0.5 * off}
    moved = campaign.with_values({name: known[name].value(z) for name, z in true.items()})
    (found,) = predict(moved, [dataset], threads=1)
    data = dataset.data.copy()
    data["spectrum"] = (("channel", "frequency"), found["spectrum"].values, dataset.data["spectrum"].attrs)
    fit = fitted(campaign, [replace(dataset, data=data)])
    for free, z in zip(fit.model.free, fit.z, strict=True):
        assert z == pytest.approx(true.get(free.name, 0.0), abs=0.2), free.name


@pytest.mark.injection
def test_intervals_hold_the_truth_of_fifty(tmp_path: Path) -> None:
    off = missed(tmp_path, range(50))
    held = np.mean(np.abs(off) < 1.645, axis=0)
    assert (held > 0.8).all(), held
    assert 0.85 < held.mean() < 0.98, held


def test_loads_and_speed_of_moving_forces(tmp_path: Path) -> None:
    """The record is the closed form's; all nominal values are off."""
    axles = {"loads_N": [1.3e5] * 4, "lags_m": list(passages.LAGS_M), "body": "deck", "entry_s": 0.76}
    campaign = measured(tmp_path, "wae", speed_m_per_s=29.6, axles=axles)
    values = fitted(campaign, campaign.load()).values()
    assert values["V"] == pytest.approx(passages.SPEED, rel=3e-3)
    for index, load in enumerate(passages.LOADS_N):
        assert values[f"P{index}"] == pytest.approx(load, rel=0.03)
    assert 0.76 + values["t0"] == pytest.approx(passages.ENTRY_S, abs=2e-3)


def test_a_drift_is_no_physics(tmp_path: Path) -> None:
    plain, moved = (measured(tmp_path / str(d), "we", drift=d) for d in (0.0, 0.5))
    first, second = fitted(plain, plain.load()), fitted(moved, moved.load())
    sigma = np.sqrt(np.diag(first.spread))
    assert (np.abs(second.z - first.z) < 0.3 * sigma).all()


def test_residuals_are_over_noise_and_a_floor(tmp_path: Path) -> None:
    campaign = measured(tmp_path, "we")
    (block,) = gather(campaign, threads=1).blocks
    data = block.dataset.data
    (found,) = predict(campaign, [block.dataset], threads=1)
    size = np.sqrt(uniform_filter1d(np.abs(data["spectrum"].values) ** 2, ABOUT, axis=-1, mode="nearest"))
    sigma = np.sqrt(data["noise_sd"].values ** 2 + (FLOOR * size) ** 2)
    off = (data["spectrum"].values - found["spectrum"].values) / sigma
    assert block.residuals(found) == pytest.approx(np.concatenate([off.real.ravel(), off.imag.ravel()]))
    levels = block.levels_dB(found)
    assert np.isnan(levels[levels.size // 2 :]).all()
    assert np.isfinite(levels[: levels.size // 2]).any()


def test_a_comparison_of_a_passage(tmp_path: Path) -> None:
    campaign = measured(tmp_path / "c", "we")
    written = write_comparison(compare(campaign, raw_only=True, threads=1), tmp_path / "page")
    (row,) = written["fits"]
    assert row["kind"] == "passages"
    assert row["channels"] == 2
    assert "passages" in Path(written["report"]).read_text(encoding="utf-8")
