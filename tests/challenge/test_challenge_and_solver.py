"""The challenge's finite elements against the solver: the same idealisation, by other means."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from permway.campaign.campaign import Campaign
from permway.campaign.importers.sheet import import_sheet
from permway.campaign.predict import predict
from permway.campaign.predictions.run import influence
from permway.challenge import write
from permway.challenge.irregularity import density
from short_deck import LAYOUT, TWO_SPANS, small_case


@pytest.fixture(scope="module", params=[LAYOUT, TWO_SPANS], ids=["one span", "two spans"])
def both(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Campaign, list[tuple[xr.Dataset, xr.Dataset]]]:
    """A campaign without noise or errors, and what the solver predicts of it with the true values."""
    case = small_case(clean=True, layout=request.param)
    folder = tmp_path_factory.mktemp("clean")
    write(case, folder / "folder")
    campaign = import_sheet(folder / "folder", folder / "imported")
    values = {
        f"{group}.{name}": v for group, table in case.truth["parameters"].items() for name, v in table.items()
    }
    campaign = campaign.with_values(values)
    datasets = campaign.load()
    return campaign, [(d.data, p) for d, p in zip(datasets, predict(campaign, datasets, threads=1), strict=True)]


def test_frequency_responses_agree(both: tuple[Campaign, list[tuple[xr.Dataset, xr.Dataset]]]) -> None:
    (measured, predicted), *_ = both[1]
    ratio = np.log((measured["frf"] / predicted["frf"]).values)
    decibels = 8.686 * np.abs(ratio.real)
    # Far from a source and at antiresonances small numbers are differences of large ones.
    level = np.abs(predicted["frf"]).mean("frequency")
    apart = np.abs((measured["frf"] - predicted["frf"]) / level)
    low = (measured["frequency"] < 150.0).values
    axis = measured["frf"].get_axis_num("frequency")
    assert np.median(decibels) < 0.001
    assert np.compress(low, decibels, axis=axis).max() < 0.01
    assert np.quantile(decibels, 0.99) < 0.03
    assert float(apart.max()) < 0.01


def test_vehicle_on_the_same_track_is_the_same(both: tuple[Campaign, list[tuple[xr.Dataset, xr.Dataset]]]) -> None:
    campaign, _ = both
    plan = small_case(clean=True).plan()
    frequency = np.array([0.5, 2.0, 9.0, 60.0, 240.0, 400.0])
    random = np.random.default_rng(2)
    track = 1e-8 * (random.standard_normal((6, 4, 4)) - 1j * random.random((6, 4, 4)) + 3.0 * np.eye(4))
    solved = influence(campaign.model, frequency, track)
    degrees = campaign.model.train.vehicle.degrees  # type: ignore[union-attr]
    names = [f"car1.wheelset{i}" for i in range(1, 5)] + ["car1.bogie1.bounce", "car1.body.bounce"]
    expected = solved[:, [degrees.index(name) for name in names]]
    assert np.allclose(plan.vehicle.influence(frequency, track), expected, rtol=1e-9, atol=1e-12)


def test_profile_has_the_spectrum_that_the_importer_reads_out_of_the_sheet(
    both: tuple[Campaign, list[tuple[xr.Dataset, xr.Dataset]]],
) -> None:
    spectrum = both[0].model.irregularity
    assert spectrum is not None
    wavenumber = np.geomspace(0.07, 50.0, 40)
    assert np.allclose(density(wavenumber), spectrum.wavenumber_density(wavenumber), rtol=1e-6)


def test_runs_agree_but_for_the_profile(both: tuple[Campaign, list[tuple[xr.Dataset, xr.Dataset]]]) -> None:
    for measured, predicted in both[1][1:]:
        off = 10.0 * np.log10((measured["psd"] / predicted["psd"]).transpose("channel", "frequency").values)
        # One profile under all channels: what it has too much, all have too much.
        apart = off - off[:4].mean(axis=0)
        band = (measured["frequency"].values > 8.0) & (measured["frequency"].values < 380.0)
        assert np.abs(apart[:5, band].mean(axis=1)).max() < 0.3
        assert np.abs(off[:5, band].mean()) < 2.5
