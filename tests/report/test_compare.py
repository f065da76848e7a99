"""`permway compare`: its numbers, its page and its pictures."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from permway.campaign.campaign import read_campaign
from permway.campaign.compare import curves, third_octaves
from permway.campaign.predict import predict
from permway.diagnosis.compare import CLEAN, RAW, RECALIBRATED, Comparison
from permway.diagnosis.residuals import lag_correlation
from permway.errors import InputError
from permway.posterior.compare import compare
from permway.report.compare import write_comparison
from permway.report.compare.maps import ordered
from permway.report.compare.tables import quantity, signed
from simulated import Simulated, simulate

PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Simulated:
    return simulate(tmp_path_factory.mktemp("compare") / "c", 1)


@pytest.fixture(scope="module")
def comparison(made: Simulated) -> Comparison:
    return compare(made.campaign, threads=1)


@pytest.fixture(scope="module")
def written(comparison: Comparison, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("written") / "out"
    write_comparison(comparison, folder, dpi=60)
    return folder


def test_a_model_that_is_low_by_three_dB_deviates_by_three_in_every_band(made: Simulated) -> None:
    (dataset,) = made.campaign.load()
    lower = dataset.data[["frf"]].copy(deep=True) * 10.0 ** (-3.0 / 20.0)
    scatter = np.full((6, dataset.data.sizes["frequency"]), 0.1)
    record = curves(made.campaign, dataset, {"lower": lower}, scatter)
    np.testing.assert_allclose(record["deviation_dB"], 3.0, rtol=1e-12)
    bands = third_octaves(record)
    np.testing.assert_allclose(bands["deviation_dB"], 3.0, rtol=1e-12)
    assert bands["band"].values.tolist()[:3] == [8.0, 10.0, 12.5]
    assert int(bands["lines"].sum()) == 6 * dataset.data.sizes["frequency"]
    # Noise of n lines of equal size falls by their root.
    few = bands["lines"].values[0] == 1
    np.testing.assert_allclose(bands["scatter_dB"].values[:, few], 0.1, rtol=1e-12)


def test_lines_that_are_lost_in_noise_do_not_count(made: Simulated) -> None:
    (dataset,) = made.campaign.load()
    scatter = np.full((6, dataset.data.sizes["frequency"]), 0.1)
    scatter[2] = 5.0
    bands = third_octaves(curves(made.campaign, dataset, {"same": dataset.data}, scatter))
    assert np.isnan(bands["deviation_dB"].values[0, 2]).all()
    assert (bands["lines"].values[2] == 0).all()
    np.testing.assert_allclose(np.delete(bands["deviation_dB"].values[0], 2, axis=0), 0.0, atol=1e-12)


def test_a_pair_that_was_not_measured_deviates_by_nothing_known(made: Simulated) -> None:
    (dataset,) = made.campaign.load()
    predicted = predict(made.campaign, [dataset], threads=1)[0]
    dataset.data["frf"].values[1, 2] = np.nan
    record = curves(made.campaign, dataset, {"raw": predicted}, np.full((6, 97), 0.1))
    assert np.isnan(record["deviation_dB"].values[0, 5]).all()
    assert np.isfinite(record["deviation_dB"].values[0, :5]).all()


def test_intervals_of_the_measurement_hold_the_truth(tmp_path: Path) -> None:
    made = simulate(tmp_path / "c", 5, smooth=0.0)
    (dataset,) = made.campaign.load()
    right = predict(made.campaign.with_values(made.truth), [dataset], threads=1)[0]
    record = curves(made.campaign, dataset, {"right": right}, np.full((6, 97), 0.1))
    modulus = np.abs(record["predicted"].values[0])
    held = (record["low"].values <= modulus) & (modulus <= record["high"].values)
    # 582 independent lines: four standard deviations of a share of 0.95 are 0.036.
    assert held.mean() == pytest.approx(0.95, abs=0.036)


def test_numbers_are_labelled(comparison: Comparison) -> None:
    (record,) = comparison.records
    assert record["predicted"].dims == ("model", "channel", "frequency")
    assert record["model"].values.tolist() == [RAW, RECALIBRATED]
    assert record["channel"].values[1] == "rail@6 < hit far"
    assert comparison.residuals[0]["model"].values.tolist() == [RAW, RECALIBRATED, CLEAN]
    for name, variable in record.data_vars.items():
        assert variable.attrs["long_name"], name


def test_records_leave_less_open_than_the_priors(comparison: Comparison) -> None:
    spread = comparison.records[0]["predicted_dB"]
    narrow = float(np.sqrt((spread.sel(model=RECALIBRATED) ** 2).mean()))
    assert narrow < 0.2 * float(np.sqrt((spread.sel(model=RAW) ** 2).mean()))


def test_the_spread_of_predictions_is_that_of_the_priors(made: Simulated, comparison: Comparison) -> None:
    """The root of the sum of squares of what a prior's standard deviation does, by central differences of 1 %."""
    datasets = made.campaign.load()
    square = np.zeros(datasets[0].data["frf"].shape)
    for known in made.campaign.parameters.known.values():
        levels = []
        for z in (0.01, -0.01):
            (one,) = predict(made.campaign.with_values({known.name: known.value(z)}), datasets, threads=1)
            levels.append(20.0 * np.log10(np.abs(one["frf"].values)))
        square += ((levels[0] - levels[1]) / 0.02) ** 2
    kept = comparison.records[0]["frequency"].values
    at = np.searchsorted(datasets[0].data["frequency"].values, kept)
    expected = np.sqrt(square.reshape(6, -1)[:, at])
    found = comparison.records[0]["predicted_dB"].sel(model=RAW).values
    # Forward differences of 0.001 are off by half of that times the curvature.
    np.testing.assert_allclose(found, expected, rtol=0.01, atol=0.01 * expected.max())


def test_the_page_needs_nothing_from_outside(written: Path) -> None:
    page = (written / "report.html").read_text(encoding="utf-8")
    bare = re.sub(r"data:image/png;base64,[A-Za-z0-9+/=]+", "", page)
    assert not re.search(r"https?://|<script[^>]+src|@import|url\(", bare)
    assert page.count("data:image/png;base64,") == len(list((written / "pictures").iterdir()))


def test_the_page_states_first_how_well_it_fits(written: Path, comparison: Comparison) -> None:
    page = (written / "report.html").read_text(encoding="utf-8")
    (fit,) = comparison.fits()
    first = page[page.index('<p class="first">') :][:400]
    assert f"{fit['raw_dB_rms']:.1f} dB rms" in first
    assert f"{fit['recalibrated_dB_rms']:.2f} dB and {100 * fit['recalibrated_within_2_sigma']:.1f} %" in first
    for name in comparison.parameters["parameter"].values:
        assert f"<th>{name}</th>" in page


def test_pictures_are_there(written: Path) -> None:
    names = sorted(path.stem for path in (written / "pictures").iterdir())
    assert names == [
        "curves-blows-deck-3",
        "curves-blows-rail-6",
        "left-blows",
        "level-blows",
        "parameters",
        "sigma-blows",
    ]
    assert all(path.read_bytes().startswith(PNG) for path in (written / "pictures").iterdir())


def test_the_file_of_numbers_is_read_back(written: Path, comparison: Comparison) -> None:
    path = written / "comparison.nc"
    with xr.open_dataset(path, group="records/blows/curves", engine="h5netcdf") as record:
        np.testing.assert_array_equal(record["measured"], comparison.records[0]["measured"])
    with xr.open_dataset(path, group="parameters", engine="h5netcdf") as table:
        np.testing.assert_array_equal(table["value"], comparison.parameters["value"])
    with xr.open_dataset(path, engine="h5netcdf") as top:
        assert json.loads(top.attrs["summary"]) == comparison.summary()


def test_points_go_along_the_line_within_each_sensor(comparison: Comparison) -> None:
    record = comparison.records[0]
    chosen = record["channel"].values[ordered(comparison.campaign, record)].tolist()
    assert chosen[:3] == ["rail@6 < deck hit", "rail@6 < hit", "rail@6 < hit far"]


def test_the_command_without_recalibration(made: Simulated) -> None:
    command = [sys.executable, "-m", "permway", "compare", str(made.path), "--raw-only", "--json"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    stated = json.loads(done.stdout)
    assert stated["fits"][0]["channels"] == 6
    assert "recalibrated_dB_rms" not in stated["fits"][0]
    # By default beside the campaign.
    assert Path(stated["report"]) == made.path.parent / "comparison" / "report.html"
    assert Path(stated["report"]).is_file()
    assert Path(stated["numbers"]).is_file()


def test_a_campaign_without_anything_to_predict_ends_in_one_error(made: Simulated, tmp_path: Path) -> None:
    lateral = made.path.read_text().replace('name = "rail@6"', 'name = "rail@6"\ndirection = "lateral"')
    lateral = lateral.replace('name = "deck@3"', 'name = "deck@3"\ndirection = "lateral"')
    for name in ("model.toml", "frf.npz"):
        (tmp_path / name).write_bytes((made.path.parent / name).read_bytes())
    (tmp_path / "campaign.toml").write_text(lateral)
    with pytest.raises(InputError, match="no record can be predicted"):
        compare(read_campaign(tmp_path / "campaign.toml"), raw_only=True)


def test_lag_correlation_of_noise_and_of_a_walk() -> None:
    random = np.random.default_rng(0)
    steps = random.standard_normal((2, 3, 4000))
    smooth = np.stack([steps[0], np.apply_along_axis(lambda v: np.convolve(v, [1.0, 0.5], "same"), -1, steps[1])])
    z = xr.DataArray(
        smooth,
        dims=("part", "row", "frequency"),
        coords={"part": ["level", "phase"], "sensor": ("row", ["a"] * 3)},
    )
    found = lag_correlation(z, lags=2)
    chance = 4.0 * float(found["chance"][0, 0, 0]) / 1.96
    np.testing.assert_allclose(found["correlation"].sel(part="level"), 0.0, atol=chance)
    # Of e + e'/2 neighbours are alike by 0.5 / 1.25.
    assert float(found["correlation"].sel(part="phase")[0, 0]) == pytest.approx(0.4, abs=chance)


def test_numbers_as_text() -> None:
    assert [signed(v) for v in (0.04, -0.04, 1.25, -3.0, np.nan)] == ["0.0", "0.0", "+1.2", "−3.0", ""]
    assert quantity(5.8e7) == "5.8e7"
    assert quantity(-1e-5) == "−1e−5"
