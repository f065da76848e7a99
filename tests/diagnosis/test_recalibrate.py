"""Recalibration: what comes out of campaigns whose truth is known, and whether what is left is noise."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.campaign.importers.sheet import import_sheet
from permway.campaign.load import Dataset
from permway.diagnosis.compare import CLEAN, RAW, RECALIBRATED, Comparison, assemble
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather
from permway.diagnosis.observations import Observations
from permway.diagnosis.residuals import channel_rms, lag_correlation
from permway.laws import FractionalKelvinVoigt
from scipy import stats
from searched import recalibrated_base
from simulated import Simulated, simulate

SHARED = Path(__file__).resolve().parents[3] / "shared"
CASES = 10

needs_shared = pytest.mark.skipif(
    not (SHARED / "campaigns").is_dir(), reason="the campaigns are not here (shared beside the repository)"
)


@pytest.fixture(scope="module")
def cases(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[Simulated, Observations, Fit]]:
    folder = tmp_path_factory.mktemp("simulated")
    found = []
    for seed in range(CASES):
        made = simulate(folder / str(seed), seed)
        observations = gather(made.campaign, threads=1)
        found.append((made, observations, recalibrated_base(observations)))
    return found


def test_intervals_hold_the_truth(cases: list[tuple[Simulated, Observations, Fit]]) -> None:
    """Truths are drawn from the priors, so 90 % intervals hold 90 % of them, parameters and cases alike."""
    held = []
    for made, _, fit in cases:
        for name, (low, high) in fit.intervals().items():
            held.append(low <= made.truth[name] <= high)
    # One run in a thousand of right intervals would fall below. Intervals of one case are not independent of each
    # other, so the count is taken as if each case were worth half of its parameters.
    fewest = stats.binom.ppf(0.001, len(held) // 2, 0.9) / (len(held) // 2)
    assert np.mean(held) >= fewest


def test_the_records_state_much_more_than_the_priors(cases: list[tuple[Simulated, Observations, Fit]]) -> None:
    for _, _, fit in cases:
        assert (np.sqrt(np.diag(fit.covariance)) < 0.25).all()


def test_nominal_values_deviate_and_recalibrated_ones_do_not(
    cases: list[tuple[Simulated, Observations, Fit]],
) -> None:
    for _, observations, fit in cases:
        (row,) = assemble(observations, fit).fits()
        assert row["raw_dB_rms"] > 2.0 * row["recalibrated_dB_rms"]
        assert row["raw_within_2_sigma"] < 0.6
        # Gains of 0.02 neper, of sensor and of point, are 0.25 dB.
        assert row["recalibrated_dB_rms"] < np.hypot(0.25, row["noise_dB_rms"]) * 1.5


def test_what_is_left_is_as_large_as_the_noise(cases: list[tuple[Simulated, Observations, Fit]]) -> None:
    for made, _, fit in cases:
        (block,) = fit.observations.blocks
        rows = block.rows
        modulus = np.abs(block.measured)
        sigma = rows.scale_dB[: modulus.size].reshape(modulus.shape) / 8.686 * modulus
        # The sigmas hold a floor beside the noise, which the simulation does not have.
        expected = (made.noise[:, :, None] ** 2 / sigma**2).mean(axis=(1, 2))
        z = assemble_one(fit)["z"].sel(model=CLEAN)
        found = (z.values**2).reshape(2, 2, 3, -1).mean(axis=(0, 2, 3))
        count = 2 * 3 * z.sizes["frequency"]
        # Calibration errors of sensors, points and pairs take out up to a part in seven of the degrees of freedom.
        assert (found < expected * (1.0 + 4.0 * np.sqrt(2.0 / count))).all()
        assert (found > expected * (6.0 / 7.0 - 4.0 * np.sqrt(2.0 / count))).all()


def assemble_one(fit: Fit) -> Any:
    (residuals,) = assemble(fit.observations, fit).residuals
    return residuals


def test_what_is_left_knows_nothing_of_its_neighbours(cases: list[tuple[Simulated, Observations, Fit]]) -> None:
    for _, observations, fit in cases:
        z = assemble(observations, fit).residuals[0]["z"]
        left = lag_correlation(z.sel(model=CLEAN), lags=4)
        # Of 160 correlations one in ten thousand would be beyond 4 standard deviations; splines that are taken out
        # (a part in seven) leave neighbours alike in the opposite sense by as much.
        chance = left["chance"].values / 1.96
        assert (left["correlation"].values < 4.0 * chance).all()
        assert (left["correlation"].values > -4.0 * chance - 1.0 / 7.0).all()
        # The nominal values leave what no noise would, in gain or in phase of every sensor.
        raw = lag_correlation(z.sel(model=RAW), lags=4)["correlation"].values[..., 0]
        assert (raw > 3.0 * chance[..., 0]).any(axis=0).all()


def test_nothing_is_learnt_of_what_no_record_sees(tmp_path: Path) -> None:
    """With noise far above every resonance the priors stay as they were, and are reported as not informed."""
    made = simulate(tmp_path / "loud", 3, noise=5000.0)
    observations = gather(made.campaign, threads=1)
    found = assemble(observations, recalibrated_base(observations))
    assert (found.parameters["sigma_over_prior"].values <= 1.0 + 1e-9).all()
    assert found.parameters["not_informed"].values.all()
    assert not found.parameters["left"].values.any()


def thinned(datasets: list[Dataset]) -> list[Dataset]:
    """A cut-down campaign: a sensor on each body, every fourth point, one run up to 150 Hz."""
    blows, run = datasets[0], datasets[-1]
    sensors = [list(blows.data["sensor"].values).index(name) for name in ("rail@16", "slab@16", "girder@8")]
    few = blows.data.isel(sensor=sensors, force=slice(1, None, 4))
    line = run.data["frequency"].values <= 150.0
    return [replace(blows, data=few), replace(run, data=run.data.isel(frequency=line))]


def practice(name: str, folder: Path) -> tuple[Campaign, list[Dataset], dict[str, Any]]:
    campaign = import_sheet(SHARED / "campaigns" / name, folder / name)
    truth = json.loads((SHARED / "campaigns" / name / "truth.json").read_text())
    return campaign, thinned(campaign.load()), truth


def amended(campaign: Campaign, truth: dict[str, Any]) -> Campaign:
    """The true amendment of practice-1: a spring with a springpot beside it, k (r0 + r1 (i w/w0)^alpha).

    The parameter `pad.k` goes on to scale the spring, and the nominal value is put there; the springpot is the
    amendment's own, and true.
    """
    line, effect = campaign.model.line, truth["fx"][0]
    name = f"{effect['layer']}.k"
    law = FractionalKelvinVoigt(
        stiffness=campaign.parameters.known[name].nominal * effect["r0"],
        coefficient=truth["parameters"][effect["layer"]]["k"] * effect["r1"] * effect["w0"] ** -effect["alpha"],
        order=effect["alpha"],
    )
    changed = line.model_copy(update={"laws": {**line.laws, effect["layer"]: law}})
    return campaign.with_model(campaign.model.model_copy(update={"line": changed}))


def check_practice(found: Comparison) -> None:
    for data in found.residuals:
        rms = channel_rms(data).sel(model=CLEAN)
        left = lag_correlation(data["z"].sel(model=CLEAN), lags=1)
        for sensor in rms["sensor"].values:
            z = data["z"].sel(model=CLEAN).values[:, data["sensor"].values.astype(str) == sensor]
            count = int(np.isfinite(z).sum())
            # Eight blows: coherence is estimated from the same, and averaged over five lines, so where noise rules
            # the mean square is K/(K - 1) times that of an F of 70 degrees, 70/68. Logarithms of powers of K
            # averages: psi'(K) K = 1 + 1/(2 K). Both at most 1.18; then chance, four standard deviations.
            assert float(rms.sel(sensor=sensor)) ** 2 < 1.18 * (1.0 + 4.0 * np.sqrt(2.0 / count)), sensor
            both = left.sel(sensor=sensor)
            known = np.isfinite(both["correlation"].values)
            # Beside chance a quarter: Hann's window leaves power on every second line alike by 1/36, the mesh of
            # the records' finite elements is smooth and not noise.
            slack = 4.0 * both["chance"].values[known] / 1.96 + 0.25
            assert (np.abs(both["correlation"].values[known]) < slack).all(), sensor
    for row in found.fits():
        assert row["recalibrated_dB_rms"] < 1.5 * row["noise_dB_rms"] + 0.1
        assert row[f"{RECALIBRATED}_within_2_sigma"] > 0.85


@needs_shared
def test_practice_2_after_recalibration(tmp_path: Path) -> None:
    campaign, datasets, _ = practice("practice-2", tmp_path)
    observations = gather(campaign, datasets, threads=1)
    found = assemble(observations, recalibrated_base(observations))
    check_practice(found)
    assert not found.parameters["left"].values.any()


@needs_shared
def test_practice_1_with_its_true_amendment(tmp_path: Path) -> None:
    campaign, datasets, truth = practice("practice-1", tmp_path)
    amended_campaign = amended(campaign, truth)
    observations = gather(amended_campaign, datasets, threads=1)
    check_practice(assemble(observations, recalibrated_base(observations)))
