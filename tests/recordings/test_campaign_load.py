"""Records of a campaign as labelled datasets: in SI, by the sensors' names, nothing made up."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from campaigns import tables, write
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.load import Dataset, load_record
from permway.campaign.predict import predict, why_not
from permway.campaign.welch import cross_spectra_of
from permway.errors import InputError
from permway.recordings.estimates.welch import cross_spectra
from permway.recordings.record import TimeRecord

RATE = 512.0
SAMPLES = np.random.default_rng(3).normal(size=(2, 5000))


def campaign_with(folder: Path, change: dict[str, Any] | None = None, **record: Any) -> Campaign:
    """The small campaign, its records written: FRFs as NPZ, a run as CSV."""
    campaign, model = tables()
    campaign["records"][0] |= {"file": "frf.npz"}
    campaign["records"][1] |= record
    campaign |= change or {}
    path = write(folder, campaign, model)
    frequency = np.array([0.0, 10.0, 20.0, 30.0])
    values = np.arange(16.0).reshape(4, 2, 2) * (1.0 + 1.0j)
    coherence = np.full((4, 2, 2), 0.9)
    names = {"sensor": np.array(["r", "d"]), "hammer": np.array(["a", "b"])}
    np.savez(folder / "frf.npz", f=frequency, frf=values, coh=coherence, **names)
    lines = ["axle,floor", *(f"{a!r},{b!r}" for a, b in SAMPLES.T.tolist())]
    (folder / "run.csv").write_text("\n".join(lines) + "\n")
    return read_campaign(path)


@pytest.fixture
def campaign(tmp_path: Path) -> Campaign:
    # The FRF's file must be there before the campaign is read.
    (tmp_path / "frf.npz").write_bytes(b"later")
    return campaign_with(tmp_path)


def test_frequency_responses_by_name_and_in_SI(campaign: Campaign) -> None:
    data = load_record(campaign, campaign.stated.records[0]).data
    assert data["frf"].dims == ("sensor", "force", "frequency")
    assert data["sensor"].values.tolist() == ["rail@12", "deck@6"]
    assert data["force"].values.tolist() == ["hit", "hit far"]
    # 0 Hz is left out; the deck's unit is mm/s.
    assert data["frequency"].values.tolist() == [10.0, 20.0, 30.0]
    assert data["frf"].sel(sensor="rail@12", force="hit far").values == pytest.approx(
        np.array([5, 9, 13]) * (1 + 1j)
    )
    assert data["frf"].sel(sensor="deck@6", force="hit").values == pytest.approx(
        np.array([6, 10, 14]) * (1 + 1j) * 1e-3
    )
    assert data["log_variance"].values == pytest.approx(0.1 / (2 * 8 * 0.9))
    assert data.attrs["averages"] == 8.0
    assert data.attrs["temperature_C"] == 12.0


def test_runs_are_welchs_estimates_in_SI(campaign: Campaign) -> None:
    data = load_record(campaign, campaign.stated.records[1]).data
    plain = cross_spectra(SAMPLES, sampling_Hz=RATE, segment_s=1.0)
    lines = plain["frequency"].values
    kept = (lines > 0.0) & plain["usable"].values
    assert data["frequency"].values == pytest.approx(lines[kept])
    assert data["psd"].values[0] == pytest.approx(plain["psd"].values[0][kept])
    # The floor reads in g.
    assert data["psd"].values[1] == pytest.approx(plain["psd"].values[1][kept] * 9.80665**2)
    assert data["csd"].values[0, 1] == pytest.approx(plain["csd"].values[0, 1][kept] * 9.80665)
    assert data.attrs["averages"] == plain.attrs["averages"]
    assert data.attrs["speed_m_per_s"] == pytest.approx(50.0)


@pytest.mark.parametrize("block", [100, 512, 777, 4999, 10000])
def test_blocks_make_the_same_spectra_as_the_whole(block: int) -> None:
    def blocks() -> Any:
        for first in range(0, SAMPLES.shape[1], block):
            yield TimeRecord(
                channels=("a", "b"), units=(None, None), values=SAMPLES[:, first : first + block], sampling_Hz=RATE
            )

    whole = cross_spectra(SAMPLES, sampling_Hz=RATE, segment_s=1.0, channels=["a", "b"], units=["m", "m"])
    names = ["a", "b"]
    found = cross_spectra_of(blocks(), segment_s=1.0, channels=names, units=["m", "m"])
    xr.testing.assert_allclose(found.drop_vars("level_averages"), whole, rtol=1e-12)
    at_once = cross_spectra_of(
        [TimeRecord(channels=("a", "b"), units=(None, None), values=SAMPLES, sampling_Hz=RATE)],
        segment_s=1.0,
        channels=names,
        units=["m", "m"],
    )
    xr.testing.assert_allclose(found["level_averages"], at_once["level_averages"], rtol=1e-12)


FAULTS: list[tuple[int, dict[str, Any], str]] = [
    (0, {"responses": {"x": "rail@12"}}, "has no such label"),
    (0, {"references": {"a": "hit", "c": "hit far"}}, "references.c"),
    (0, {"band_Hz": [100.0, 200.0]}, "holds no line"),
    (1, {"channels": {"axle": "axle", "roof": "floor"}}, "roof"),
    (1, {"band_Hz": [300.0, 400.0]}, "holds no line"),
    (1, {"segment_s": 100.0}, "segment"),
    (1, {"sampling_Hz": 1e9}, ""),
]


@pytest.mark.parametrize(("index", "change", "what"), FAULTS)
def test_a_record_at_fault_is_named(tmp_path: Path, index: int, change: dict[str, Any], what: str) -> None:
    (tmp_path / "frf.npz").write_bytes(b"later")
    plain, _ = tables()
    records = plain["records"]
    records[0]["file"] = "frf.npz"
    records[index] |= change
    campaign = campaign_with(tmp_path, {"records": records})
    with pytest.raises(InputError) as caught:
        campaign.load()
    assert str(caught.value).startswith(f"records.{records[index]['name']}: ")
    assert what in str(caught.value)


def test_a_run_without_a_rate_is_refused(tmp_path: Path) -> None:
    (tmp_path / "frf.npz").write_bytes(b"later")
    plain, _ = tables()
    records = plain["records"]
    records[0]["file"] = "frf.npz"
    del records[1]["sampling_Hz"]
    with pytest.raises(InputError, match=r"records\.run: sampling_Hz: missing"):
        campaign_with(tmp_path, {"records": records}).load()


def test_a_pair_that_was_not_measured_stays_empty(tmp_path: Path) -> None:
    import permway.campaign.kinds.responses as module
    from permway.recordings.record import FrfRecord

    (tmp_path / "frf.npz").write_bytes(b"later")
    campaign = campaign_with(tmp_path)
    three = FrfRecord(
        responses=("r", "r", "d"),
        references=("a", "b", "b"),
        frequency_Hz=np.array([10.0, 20.0]),
        values=np.ones((3, 2), dtype=complex),
        coherence=np.full((3, 2), 0.9),
        averages=8,
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "read_frf", lambda *_, **__: three)
        data = load_record(campaign, campaign.stated.records[0]).data
    assert np.isnan(data["frf"].sel(sensor="deck@6", force="hit").values).all()
    assert np.isfinite(data["frf"].sel(sensor="deck@6", force="hit far").values).all()
    assert np.isnan(data["log_variance"].sel(sensor="deck@6", force="hit").values).all()
    assert np.isfinite(data["log_variance"].sel(sensor="deck@6", force="hit far").values).all()


def test_responses_without_coherence_or_averages_are_refused_for_nothing_states_how_sure_they_are(
    tmp_path: Path,
) -> None:
    campaign = campaign_with(tmp_path)
    record = campaign.stated.records[0]
    with np.load(tmp_path / "frf.npz") as file:
        arrays = dict(file)
    bare = {name: array for name, array in arrays.items() if name != "coh"}
    np.savez(tmp_path / "frf.npz", **bare)
    with pytest.raises(InputError, match=r"records\..*: frf.npz: has no coherence.*named coherence"):
        load_record(campaign, record)
    np.savez(tmp_path / "frf.npz", **arrays)
    with pytest.raises(InputError, match=r"averages: missing.*averages = 8"):
        load_record(campaign, record.model_copy(update={"averages": None}))


TABLE = "test,rail,temp,100,125,160\n1,left,3.5,2.0,3.0,4.0\n2,left,3.5,5.0,6.0,7.0\n3,right,9.0,1.0,-1.0,x\n"


def table_campaign(folder: Path, statistic: str = "decay", **record: Any) -> Campaign:
    campaign, model = tables()
    more = {"spacing_m": 0.6} if statistic == "decay" else {}
    condition = "still" if statistic == "decay" else "tests"
    campaign["records"] = [
        {
            "name": "row",
            "file": "table.csv",
            "condition": condition,
            "statistic": statistic,
            "channels": {"a": "rail@12"},
            **more,
            **record,
        }
    ]
    campaign["held_out"] = []
    (folder / "table.csv").write_text(TABLE)
    return read_campaign(write(folder, campaign, model))


def test_one_row_of_a_table_in_bands(tmp_path: Path) -> None:
    (dataset,) = table_campaign(tmp_path, select={"test": 2, "rail": "left"}, band_Hz=[120.0, 200.0]).load()
    assert dataset.data["decay_rate"].values.tolist() == [6.0, 7.0]
    assert dataset.data["band"].values.tolist() == [125.0, 160.0]
    levels = table_campaign(tmp_path, "bands", select={"test": 1})
    (kept,) = levels.load()
    assert kept.data["mean_square"].values.tolist() == [[2.0, 3.0, 4.0]]
    assert "kept, and not predicted" in str(why_not(levels, kept))


@pytest.mark.parametrize(
    ("record", "what"),
    [
        ({"select": {"rail": "left"}}, "2 rows say this"),
        ({"select": {"test": 9}}, "no row states this"),
        ({"select": {"tester": 1}}, "select.tester: the table has no such column"),
        ({"select": {"test": 3}}, "not a number"),
        ({"select": {"test": 3}, "band_Hz": [90.0, 130.0]}, "above 0 dB/m"),
        ({"select": {"test": 1}, "band_Hz": [500.0, 600.0]}, "holds no band"),
    ],
)
def test_rows_that_cannot_be_used(tmp_path: Path, record: dict[str, Any], what: str) -> None:
    with pytest.raises(InputError, match=r"records\.row: ") as caught:
        table_campaign(tmp_path, **record).load()
    assert what in str(caught.value)


def test_sensors_beside_the_track_are_left_to_a_passby(tmp_path: Path) -> None:
    plain, _ = tables()
    records = plain["records"]
    records[0]["file"] = "frf.npz"
    records[1]["channels"] = {"axle": "rail@12", "floor": "deck@6"}
    (tmp_path / "frf.npz").write_bytes(b"later")
    campaign = campaign_with(tmp_path, {"records": records})
    blows, run = campaign.load()
    assert why_not(campaign, blows) is None
    assert "beside the track" in str(why_not(campaign, run))
    seen: list[Dataset] = []

    def passby(_: Campaign, dataset: Dataset) -> xr.Dataset:
        seen.append(dataset)
        return dataset.data

    frf, passed = predict(campaign, [blows, run], threads=1, passby=passby)
    assert seen == [run]
    assert passed is run.data
    assert "frf" in frf
