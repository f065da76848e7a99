"""Folders turned into campaigns: what they say comes out as model and sensors, and predicts the records."""

from __future__ import annotations

import json
import shutil
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from folders import make_pads
from permway.campaign.campaign import Campaign
from permway.campaign.importers.pad_materials import import_pad_materials
from permway.campaign.importers.rubber_rig import import_rubber_rig
from permway.campaign.importers.sheet import import_sheet
from permway.campaign.importers.sheet_form import read_sheet
from permway.campaign.importers.track_decay import import_track_decay
from permway.campaign.predict import predict
from permway.errors import InputError
from sheets import NOISE, RATE_HZ, SHEET, make_folder


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_folder(tmp_path_factory.mktemp("team") / "deck")


@pytest.fixture(scope="module")
def campaign(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    return import_sheet(folder, tmp_path_factory.mktemp("imported") / "deck")


def test_the_campaigns_folder_is_complete_in_itself(campaign: Campaign) -> None:
    assert sorted(path.name for path in campaign.folder.iterdir()) == [
        "campaign.toml",
        "hammer_+12C.mat",
        "model.toml",
        "run_180kmh.npz",
        "run_252kmh.npz",
    ]
    assert "/" not in "".join(record.file for record in campaign.stated.records)


def test_what_the_sheet_states_is_in_the_campaign(campaign: Campaign) -> None:
    nominal = campaign.parameters.nominal()
    assert nominal["pad.k"] == 5.8e7
    assert nominal["vehicle.kp"] == 1.176e6
    assert campaign.model.train is not None
    assert campaign.model.train.vehicle.primary_stiffness_N_per_m == 2.0 * 1.176e6
    assert campaign.parameters.known["pad.eta"].sigma == pytest.approx(0.5 * np.arctanh(0.5))
    assert campaign.condition("run_180kmh").speed_m_per_s == pytest.approx(50.0)
    # Each at the nearest whole multiple of 0.16 m; 16.4 and -3.6 m lie halfway between two.
    assert campaign.condition("run_180kmh").wheels_m == pytest.approx((16.32, 13.92, -1.12, -3.52))
    # Half shares at the ends.
    table = campaign.model.line.joint_table()
    mortar = table.scale[table.layer == 2]
    assert mortar.sum() == pytest.approx(1.0)
    assert mortar[0] == pytest.approx(0.5 * mortar[1])
    floor = campaign.sensor("carbody").chain.noise_floor
    assert floor == pytest.approx(2.0 * NOISE**2 / RATE_HZ, rel=0.2)
    assert all(record.interpolated_Hz is None for record in campaign.stated.records)
    # The sheet has the irregularity move.
    assert campaign.stated.irregularity.rolling is False


def test_records_are_predicted_within_their_noise(campaign: Campaign) -> None:
    blows, *runs = campaign.load()
    predicted, *spectra = predict(campaign, [blows, *runs], threads=1)
    deviation = np.log(blows.data["frf"].values / predicted["frf"].values)
    z = np.abs(deviation) ** 2 / (2.0 * blows.data["log_variance"].values)
    # A mean of 2n squared normal deviates over 2n.
    assert z.mean() == pytest.approx(1.0, abs=4.0 / np.sqrt(z.size))
    for run, spectrum in zip(runs, spectra, strict=True):
        used = run.data["frequency"].values <= 290.0
        ratio = run.data["psd"].values[:, used] / spectrum["psd"].values[:, used]
        averages = run.data.attrs["averages"]
        # Neighbouring lines under Hann's window hang together: about 0.6 of them are independent.
        error = 1.0 / np.sqrt(averages * 0.6 * ratio.shape[1])
        assert ratio.mean(axis=1) == pytest.approx(1.0, abs=4.0 * error)
        assert ratio.std(axis=1) * np.sqrt(averages) == pytest.approx(1.0, abs=0.25)
        matrix, expected = run.data["csd"].values[..., used], spectrum["csd"].values[..., used]
        sure = np.abs(expected[0, 1]) ** 2 > 0.9 * (expected[0, 0] * expected[1, 1]).real
        assert sure.sum() > 50
        assert np.abs(np.angle(matrix[0, 1] / expected[0, 1])[sure]).max() < 0.3


def test_runs_that_were_interpolated_are_recognised(tmp_path: Path) -> None:
    campaign = import_sheet(make_folder(tmp_path / "team", interpolated=True), tmp_path / "out")
    runs = campaign.stated.records[1:]
    assert [record.interpolated_Hz for record in runs] == [((0.0, 0.5), (30.0, 1.0))] * 2
    datasets = campaign.load()[1:]
    for run, spectrum in zip(datasets, predict(campaign, datasets, threads=1), strict=True):
        used = run.data["frequency"].values <= 290.0
        ratio = (run.data["psd"] / spectrum["psd"]).values[:, used]
        error = 1.0 / np.sqrt(run.data.attrs["averages"] * 0.6 * ratio.shape[1])
        assert ratio.mean(axis=1) == pytest.approx(1.0, abs=4.0 * error)


def test_records_can_stay_where_they_are(folder: Path, tmp_path: Path) -> None:
    campaign = import_sheet(folder, tmp_path / "out", copy=False)
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["campaign.toml", "model.toml"]
    assert campaign.stated.allow_outside
    assert campaign.path(campaign.stated.records[0]) == folder / "hammer_+12C.mat"


def test_a_second_import_states_the_same(folder: Path, campaign: Campaign, tmp_path: Path) -> None:
    again = import_sheet(folder, tmp_path / "out")
    for name in ("campaign.toml", "model.toml"):
        assert (again.folder / name).read_text() == (campaign.folder / name).read_text()


def _set(*path: str | int, to: object) -> Callable[[Any], None]:
    def change(table: Any) -> None:
        for step in path[:-1]:
            table = table[step]
        table[path[-1]] = to

    return change


SHEET_FAULTS: list[tuple[Callable[[Any], None], str, str]] = [
    (lambda t: t.pop("layout"), "layout", "missing"),
    (_set("layout", "spans", to=0), "layout.spans", "greater than or equal"),
    (_set("layout", "span_m", to="12.8"), "layout.span_m", ""),
    (_set("layout", "span_m", to=13.0), "layout.span_m", "whole number"),
    (_set("layout", "approach_m", to=6.5), "layout.approach_m", "whole number"),
    (_set("layout", "slab_length_m", to=5.0), "layout.slab_length_m", "whole number"),
    (_set("values", "rail", "E", to=-1.0), "values.rail.E", "greater than 0"),
    (_set("values", "pad", to=[]), "values.pad", "table"),
    (_set("values", "vehicle", "half", to=2.0), "values.vehicle.half", "less than or equal"),
    (_set("tolerance_2sigma_relative", "pod", to={"k": 0.1}), "tolerance_2sigma_relative.pod", "no values"),
    (_set("tolerance_2sigma_relative", "pad", "z", to=0.1), "tolerance_2sigma_relative.pad.z", "no value"),
    (_set("tolerance_2sigma_relative", "pad", "k", to=25.0), "tolerance_2sigma_relative.pad.k", "percent"),
    (_set("temperature_C", to=[]), "temperature_C", "at least 1"),
    (_set("temperature_C", to=[20.0]), "", "no file hammer_+20C"),
    (_set("hammer", "quantity", to="mobility"), "hammer.quantity", "accelerance"),
    (_set("hammer", "points", 0, to=["rail"]), "hammer.points[0]", "[body, x in m]"),
    (_set("hammer", "points", 0, to=["rail", 1.92]), "hammer.points[0]", "no such place"),
    (_set("runs", "unit", to="furlong"), "runs.unit", "no unit"),
    (_set("runs", "channels", 0, to="cab"), "runs.channels[0]", "no channel"),
    (_set("runs", "channels", to=["bogie2"]), "", "bogie2"),
    (_set("runs", "speeds_kmh", to=[300.0]), "", "no file run_300kmh"),
    (_set("runs", "sampling_Hz", to=512), "sampling_Hz", "1024"),
    (_set("runs", "position", to=16.0), "runs.position", "must be words, or a list"),
    (_set("runs", "position", to=["16"]), "runs.position", "must be words, or a list"),
    (_set("runs", "position", to="in the middle"), "runs.position", "where do the wheelsets stand?"),
]


@pytest.mark.parametrize(
    ("change", "where", "what"), SHEET_FAULTS, ids=[f"{i}-{f[1]}" for i, f in enumerate(SHEET_FAULTS)]
)
def test_a_sheet_at_fault_is_reported_with_its_place(
    folder: Path, tmp_path: Path, change: Callable[[Any], None], where: str, what: str
) -> None:
    broken = tmp_path / "team"
    broken.mkdir()
    for path in folder.iterdir():
        shutil.copyfile(path, broken / path.name)
    (broken / "sheet.json").unlink()
    sheet = json.loads(json.dumps(SHEET))
    change(sheet)
    (broken / "sheet.json").write_text(json.dumps(sheet))
    with pytest.raises(InputError) as caught:
        import_sheet(broken, tmp_path / "out").load()
    text = str(caught.value)
    assert where in text
    assert what in text
    assert "\n" not in text


@pytest.mark.parametrize(("content", "what"), [(b"{", "is not JSON"), (b"[]", "table"), (b"\xff", "UTF-8")])
def test_a_file_that_is_no_sheet(tmp_path: Path, content: bytes, what: str) -> None:
    (tmp_path / "sheet.json").write_bytes(content)
    with pytest.raises(InputError, match=what):
        read_sheet(tmp_path)


def test_folders_that_hold_nothing(tmp_path: Path) -> None:
    for run in (import_sheet, import_rubber_rig, import_pad_materials, import_track_decay):
        with pytest.raises(InputError):
            run(tmp_path, tmp_path / "out")
    with pytest.raises(InputError, match="discrete"):
        import_track_decay(tmp_path, tmp_path / "out", support="soft")


@pytest.mark.parametrize("missing", ["storage_modulus_MPa.tsv", "loss_factor.tsv"])
def test_a_material_of_one_file_is_not_passed_over(tmp_path: Path, missing: str) -> None:
    folder = make_pads(tmp_path / "pads")
    (folder / "pu" / missing).unlink()
    with pytest.raises(InputError, match=f"pu/{missing}"):
        import_pad_materials(folder, tmp_path / "out")


def test_two_files_of_one_name_are_not_chosen_between(folder: Path, tmp_path: Path) -> None:
    broken = tmp_path / "team"
    broken.mkdir()
    for path in folder.iterdir():
        shutil.copyfile(path, broken / path.name)
    (broken / "run_180kmh.csv").write_text("axlebox1\n1.0\n")
    with pytest.raises(InputError, match="there are two of that name"):
        import_sheet(broken, tmp_path / "out")


def test_the_model_file_is_one_that_can_be_solved(campaign: Campaign) -> None:
    from permway.formats.model_file import read_model

    text = (campaign.folder / "model.toml").read_text()
    assert tomllib.loads(text)["irregularity"] == {"type": "german_sato", "continuous": True, "exponent": 3.06}
    assert read_model(campaign.folder / "model.toml") == campaign.model


def test_the_floor_of_a_channel_much_noisier_than_its_like_is_that_of_the_others(
    folder: Path, tmp_path: Path
) -> None:
    """Else the model would hold for right what the user would call a fault."""
    noisy = Path(shutil.copytree(folder, tmp_path / "deck"))
    random = np.random.default_rng(3)
    for path in noisy.glob("run_*.npz"):
        content = dict(np.load(path))
        acceleration = content["acceleration"]
        acceleration[:, 5] += 9.0 * NOISE * random.standard_normal(len(acceleration))
        np.savez(path, **content)
    with pytest.warns(UserWarning, match=r"carbody: [78]\d.* times the noise of the other channels"):
        campaign = import_sheet(noisy, tmp_path / "out")
    floors = [campaign.sensor(name).chain.noise_floor for name in ("axlebox1", "bogie1", "carbody")]
    assert floors == pytest.approx([2.0 * NOISE**2 / RATE_HZ] * 3, rel=0.2)
