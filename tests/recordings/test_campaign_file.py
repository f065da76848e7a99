"""The campaign file: what it states, and that everything wrong in it ends in one sentence with its place."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from campaigns import small, tables, write
from permway.campaign.campaign import read_campaign
from permway.campaign.load import Dataset
from permway.campaign.paths import parse_path, written
from permway.errors import InputError

Table = dict[str, Any]


def test_reads_what_it_states(tmp_path: Path) -> None:
    campaign = small(tmp_path)
    assert [sensor.name for sensor in campaign.stated.sensors] == ["rail@12", "deck@6", "axle", "floor"]
    assert campaign.condition("fast").speed_m_per_s == pytest.approx(50.0)
    assert campaign.sensor("deck@6").to_SI == 1e-3
    assert campaign.sensor("axle").noise_density == 1e-6
    assert campaign.parameters.names == ["pad.k", "pad.eta", "deck.E", "wheelset", "level", "gain"]
    assert campaign.parameters.nominal()["pad.k"] == 6.0e7
    # The user speaks of half a wheelset, the model file of a whole one.
    assert campaign.parameters.nominal()["wheelset"] == 890.0


def _at(table: Table, *path: str | int) -> Any:
    for step in path:
        table = table[step]  # type: ignore[index]
    return table


def _set(*path: str | int, to: object) -> Callable[[Table], None]:
    def change(table: Table) -> None:
        _at(table, *path[:-1])[path[-1]] = to

    return change


def _drop(*path: str | int) -> Callable[[Table], None]:
    def change(table: Table) -> None:
        del _at(table, *path[:-1])[path[-1]]

    return change


FAULTS: list[tuple[Callable[[Table], None], str, str]] = [
    (_set("format", to=2), "format", "1"),
    (_set("colour", to="red"), "colour", "unknown key"),
    (_drop("model"), "model", "missing"),
    (_set("model", to=""), "model", "at least 1"),
    (_set("model", to="other.toml"), "model", "cannot be read"),
    (_set("model", to="../model.toml"), "model", "outside the campaign's folder"),
    (_set("model", to="/etc/model.toml"), "model", "outside the campaign's folder"),
    (_set("conditions", to=[]), "conditions", "at least 1"),
    (_set("records", to=[]), "records", "at least 1"),
    (_set("parameters", 0, "name", to=""), "parameters[0].name", "at least 1"),
    (_set("parameters", 1, "name", to="pad.k"), "parameters[1].name", "twice"),
    (_set("parameters", 0, "paths", to=[]), "parameters[0].paths", "at least 1"),
    (_set("parameters", 0, "paths", to=["line..laws"]), "parameters[0].paths[0]", "no path"),
    (_set("parameters", 0, "paths", to=["line.laws.pod.stiffness"]), "parameters[0].paths[0]", "no 'pod'"),
    (_set("parameters", 0, "paths", to=["line.laws.pad"]), "parameters[0].paths[0]", "no number"),
    (_set("parameters", 0, "paths", to=["line.joints[9].scale"]), "parameters[0].paths[0]", "has no 9"),
    (_set("parameters", 0, "paths", to=["campaign.sensors.none.chain.gain"]), "parameters[0].paths[0]", "none"),
    (_set("parameters", 0, "acts", to="doubles"), "parameters[0].acts", "scales"),
    (_set("parameters", 0, "acts", to="adds"), "parameters[0].tolerance_2sigma", "nominal of 0"),
    (_set("parameters", 0, "nominal", to="much"), "parameters[0].nominal", "number"),
    (_set("parameters", 0, "nominal", to=0.0), "parameters[0].acts", "cannot be scaled"),
    (_set("parameters", 4, "nominal", to=3.0), "parameters[4].nominal", "cannot be believed"),
    (_set("parameters", 0, "tolerance_2sigma", to=-0.1), "parameters[0].tolerance_2sigma", "greater than 0"),
    (_drop("parameters", 4, "tolerance_2sigma"), "parameters[4].absolute", "tolerance_2sigma"),
    (_set("parameters", 4, "prior", to="log_normal"), "parameters[4].prior", "normal prior"),
    (_set("parameters", 0, "bounds", to=[7e7, 8e7]), "parameters[0].bounds", "hold the nominal"),
    (_set("parameters", 0, "bounds", to=[8e7, 7e7]), "parameters[0].bounds", "below the upper"),
    (_set("sensors", 1, "name", to="rail@12"), "sensors[1].name", "twice"),
    (_set("sensors", 0, "body", to="rial"), "sensors[0].body", "no such body"),
    (_set("sensors", 1, "x_m", to=99.0), "sensors[1].x_m", "off the deck"),
    (_drop("sensors", 0, "x_m"), "sensors[0].x_m", "where on the body"),
    (_drop("sensors", 0, "body"), "sensors[0].body", "give body and x_m, or degree"),
    (_set("sensors", 2, "x_m", to=1.0), "sensors[2].x_m", "goes with body"),
    (_set("sensors", 2, "degree", to="car2.wheelset1"), "sensors[2].degree", "no such degree"),
    (_set("sensors", 0, "unit", to="mm"), "sensors[0].unit", "no unit of acceleration"),
    (_set("sensors", 0, "quantity", to="rotation"), "sensors[0].quantity", "displacement"),
    (_set("sensors", 0, "direction", to="north"), "sensors[0].direction", "down"),
    (_set("sensors", 0, "chain", to={"gain": 0.0}), "sensors[0].chain.gain", "greater than 0"),
    (_set("sensors", 0, "chain", to={"polarity": 2}), "sensors[0].chain.polarity", "1 or -1"),
    (_set("sensors", 0, "chain", to={"delay_s": 99.0}), "sensors[0].chain.delay_s", "10"),
    (
        _set("sensors", 0, "chain", to={"noise_floor": -1.0}),
        "sensors[0].chain.noise_floor",
        "greater than or equal",
    ),
    (_set("sensors", 0, "chain", to={"mount_Hz": "high"}), "sensors[0].chain.mount_Hz", "number"),
    (_set("forces", 0, "body", to="floor"), "forces[0].body", "no such body"),
    (_set("forces", 0, "unit", to="kgf"), "forces[0].unit", "'N'"),
    (_set("forces", 1, "name", to="hit"), "forces[1].name", "twice"),
    (_set("conditions", 0, "kind", to="feather"), "conditions[0].kind", "hammer"),
    (_set("conditions", 0, "temperature_C", to=285.0), "conditions[0].temperature_C", "150"),
    (_set("conditions", 0, "speed_m_per_s", to=50.0), "conditions[0].kind", "of a train"),
    (_drop("conditions", 1, "speed_km_per_h"), "conditions[1].speed_m_per_s", "a train needs"),
    (_set("conditions", 1, "speed_km_per_h", to="180"), "conditions[1].speed_km_per_h", "number"),
    (_set("conditions", 1, "speed_m_per_s", to=50.0), "conditions[1].speed_km_per_h", "twice"),
    (_set("conditions", 1, "wheels_m", to=[1.0, 2.0, 3.0, 4.0]), "conditions[1].wheels_m", "leading wheel first"),
    (_set("conditions", 1, "wheels_m", to=[4.0, 3.0]), "conditions[1].wheels_m", "4 wheelsets"),
    (_set("conditions", 1, "name", to="still"), "conditions[1].name", "twice"),
    (_set("irregularity", "knowledge", to="guessed"), "irregularity.knowledge", "known"),
    (_drop("irregularity", "within_dB"), "irregularity.within_dB", "needs it"),
    (_set("irregularity", "shape_dB", to=[[2.0, 0.5], [1.0, 0.0]]), "irregularity.shape_dB[1][0]", "longer than"),
    (_set("records", 0, "file", to="none.csv"), "records[0].file", "no such file"),
    (_set("records", 0, "file", to="../frf.csv"), "records[0].file", "outside the campaign's folder"),
    (_set("records", 0, "file", to="a\0b"), "records[0].file", "name of a file"),
    (_set("records", 0, "condition", to="wet"), "records[0].condition", "no condition"),
    (_set("records", 0, "condition", to="fast"), "records[0].condition", "cannot be of a condition of kind"),
    (_set("records", 0, "statistic", to="mean"), "records[0].statistic", "frf"),
    (_set("records", 0, "repeat", to=0), "records[0].repeat", "greater than or equal"),
    (_set("records", 0, "channels", to={"r": "rail@12"}), "records[0].channels", "responses and references"),
    (_drop("records", 0, "references"), "records[0].references", "missing"),
    (_set("records", 0, "references", to={"a": "hut"}), "records[0].references.a", "no force point"),
    (_set("records", 0, "responses", to={"r": "rail@13"}), "records[0].responses.r", "no sensor"),
    (_set("records", 0, "responses", to={"r": "axle"}), "records[0].responses.r", "on the vehicle"),
    (_set("records", 0, "responses", to={"r": "rail@12", "q": "rail@12"}), "records[0].responses", "twice"),
    (_set("records", 0, "band_Hz", to=[10.0, 5.0]), "records[0].band_Hz", "low to high"),
    (_set("records", 0, "averages", to=0), "records[0].averages", "greater than 0"),
    (_set("records", 0, "law", to="line.laws.pad"), "records[0].law", "material"),
    (_set("records", 0, "spacing_m", to=0.6), "records[0].spacing_m", "decay"),
    (_set("records", 0, "sampling_Hz", to=512.0), "records[0].sampling_Hz", "csd"),
    (_set("records", 1, "references", to={"a": "hit"}), "records[1].references", "of an FRF"),
    (_drop("records", 1, "channels"), "records[1].channels", "missing"),
    (_set("records", 1, "segment_s", to=0.0), "records[1].segment_s", "greater than 0"),
    (_set("records", 1, "averages", to=5.0), "records[1].averages", "holds spectra"),
    (_set("records", 1, "interpolated_Hz", to=[[1.0, 1.0]]), "records[1].interpolated_Hz[0]", "from 0 Hz"),
    (_set("records", 1, "interpolated_Hz", to=[[0.0, 0.0]]), "records[1].interpolated_Hz[0]", "above 0"),
    (_set("records", 1, "interpolated_Hz", to=[[0.0, 2.0], [3.0, 1.0]]), "records[1].interpolated_Hz[1]", "whole"),
    (_set("records", 1, "name", to="blows"), "records[1].name", "twice"),
    (_set("held_out", 0, "axis", to="weather"), "held_out[0].axis", "record"),
    (_drop("held_out", 0, "band_Hz"), "held_out[0].band_Hz", "missing"),
    (_set("held_out", 0, "members", to=["run"]), "held_out[0].members", "does not go with"),
    (_set("held_out", 1, "members", to=[60.0]), "held_out[1].members[0]", "no condition has this speed"),
    (_set("held_out", 1, "members", to=["fast"]), "held_out[1].members[0]", "number"),
    (_set("held_out", 3, "members", to=["roof"]), "held_out[3].members[0]", "no channel"),
    (_set("held_out", 3, "name", to="far"), "held_out[3].name", "twice"),
]


@pytest.mark.parametrize(("change", "where", "what"), FAULTS, ids=[f"{i}-{f[1]}" for i, f in enumerate(FAULTS)])
def test_every_fault_is_one_sentence_with_its_place(
    tmp_path: Path, change: Callable[[Table], None], where: str, what: str
) -> None:
    campaign, _ = tables()
    change(campaign)
    with pytest.raises(InputError) as caught:
        read_campaign(write(tmp_path, campaign))
    text = str(caught.value)
    assert text.startswith(f"{tmp_path / 'campaign.toml'}: {where}"), text
    assert what in text
    assert "\n" not in text


def test_records_that_are_all_at_fault_are_not_called_none(tmp_path: Path) -> None:
    campaign, _ = tables()
    for record in campaign["records"]:
        record["avrages"] = 8
    with pytest.raises(InputError) as caught:
        read_campaign(write(tmp_path, campaign))
    assert "at least 1 item" not in str(caught.value)
    assert caught.value.remedy == (
        "1 further fault in the same file: records[1].avrages: unknown key; did you mean 'averages'?"
    )
    campaign["records"] = []
    with pytest.raises(InputError, match="at least 1 item"):
        read_campaign(write(tmp_path, campaign))


MODEL_FAULTS: list[tuple[Callable[[Table], None], str, str]] = [
    (_set("line", "laws", "pad", "stiffness", to=-1.0), "model", "negative"),
    (_set("frequencies", to={}), "model", "give values_Hz"),
]


@pytest.mark.parametrize(("change", "where", "what"), MODEL_FAULTS)
def test_a_fault_of_the_model_is_the_models(
    tmp_path: Path, change: Callable[[Table], None], where: str, what: str
) -> None:
    _, model = tables()
    change(model)
    with pytest.raises(InputError, match=what) as caught:
        read_campaign(write(tmp_path, None, model))
    assert str(caught.value).startswith(f"{tmp_path / 'campaign.toml'}: {where}: {tmp_path / 'model.toml'}")


def test_a_model_without_a_train_has_no_channels_on_board(tmp_path: Path) -> None:
    _, model = tables()
    del model["train"], model["irregularity"]
    with pytest.raises(InputError, match=r"sensors\[2\].degree: the model has no train"):
        read_campaign(write(tmp_path, None, model))


def test_a_law_that_needs_a_temperature_gets_one(tmp_path: Path) -> None:
    campaign, model = tables()
    model["line"]["laws"]["pad"] = {"preset": "wj7b"}
    del campaign["parameters"][:2], model["temperature_C"]
    with pytest.raises(InputError, match="temperature"):
        read_campaign(write(tmp_path, campaign, model))


@pytest.mark.parametrize(
    ("content", "what"),
    [(b"a = [", "is not TOML"), (b"\xff\xfe", "UTF-8"), (b"", "missing"), (b"model = 1", "conditions|model")],
)
def test_files_that_are_no_campaign(tmp_path: Path, content: bytes, what: str) -> None:
    path = tmp_path / "campaign.toml"
    path.write_bytes(content)
    with pytest.raises(InputError, match=what):
        read_campaign(path)
    with pytest.raises(InputError, match="cannot be read"):
        read_campaign(tmp_path / "none.toml")


@pytest.fixture
def leading_out(tmp_path: Path) -> Path:
    """A campaign whose run lies beside its folder."""
    inner = tmp_path / "inner"
    inner.mkdir()
    campaign, _ = tables()
    path = write(inner, campaign)
    (inner / "run.csv").rename(tmp_path / "run.csv")
    return path


@pytest.mark.parametrize("stated", [False, True])
def test_a_path_leads_outside_only_where_the_reader_allows_it(
    leading_out: Path, tmp_path: Path, stated: bool
) -> None:
    """What the file itself allows counts for nothing: it may be another's."""
    campaign, _ = tables()
    for name in ("../run.csv", "../inner/../run.csv", str(tmp_path / "run.csv")):
        campaign["records"][1]["file"] = name
        write(leading_out.parent, {"allow_outside": stated, **campaign})
        (leading_out.parent / "run.csv").unlink()
        with pytest.raises(InputError, match=r"records\[1\].file: lies outside the campaign's folder.*allow"):
            read_campaign(leading_out)
        read = read_campaign(leading_out, allow_outside=True)
        assert read.path(read.stated.records[1]).samefile(tmp_path / "run.csv")


def test_a_link_out_of_the_folder_is_refused(leading_out: Path, tmp_path: Path) -> None:
    (leading_out.parent / "run.csv").symlink_to(tmp_path / "run.csv")
    with pytest.raises(InputError, match="outside the campaign's folder"):
        read_campaign(leading_out)
    assert read_campaign(leading_out, allow_outside=True)


def test_a_folder_that_leads_out_is_refused(leading_out: Path, tmp_path: Path) -> None:
    campaign, _ = tables()
    (leading_out.parent / "deep").symlink_to(tmp_path)
    campaign["records"][1]["file"] = "deep/run.csv"
    write(leading_out.parent, campaign)
    with pytest.raises(InputError, match="outside the campaign's folder"):
        read_campaign(leading_out)


def test_a_model_outside_is_refused_too(tmp_path: Path) -> None:
    inner = tmp_path / "inner"
    inner.mkdir()
    campaign, _ = tables()
    path = write(inner, {**campaign, "model": "../model.toml"})
    (inner / "model.toml").rename(tmp_path / "model.toml")
    with pytest.raises(InputError, match="model: lies outside the campaign's folder"):
        read_campaign(path)
    assert read_campaign(path, allow_outside=True).model.line.bodies


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names here")
@pytest.mark.parametrize("key", ["model", "file"])
def test_a_pipe_in_the_folder_is_not_waited_for(tmp_path: Path, key: str) -> None:
    campaign, _ = tables()
    (campaign if key == "model" else campaign["records"][1])[key] = "pipe"
    path = write(tmp_path, campaign)
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError, match=f"{key}: is no plain file"):
        read_campaign(path)


def test_the_command_asks_before_it_reads_outside(leading_out: Path, tmp_path: Path) -> None:
    campaign, _ = tables()
    campaign["records"][1]["file"] = "../run.csv"
    write(leading_out.parent, campaign)
    (leading_out.parent / "run.csv").unlink()
    command = [sys.executable, "-m", "permway", "separability", str(leading_out), "--threads", "1"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert "--allow-outside" in done.stderr
    done = subprocess.run([*command, "--allow-outside"], capture_output=True, text=True, timeout=120, check=False)
    assert "lies outside" not in done.stderr


def test_models_with_other_values(tmp_path: Path) -> None:
    campaign = small(tmp_path)
    model = campaign.model_with({"pad.k": 9.0e7, "pad.eta": 0.3, "deck.E": 3.0e10, "wheelset": 1000.0})
    assert model.line.laws["pad"].complex(10.0) == pytest.approx(9.0e7 * (1 + 0.3j))
    assert model.line.bodies["deck"].youngs_modulus_Pa == 3.0e10  # type: ignore[union-attr]
    assert model.train is not None
    assert campaign.model.train is not None
    # 890 kg stood for the file's 1780.
    assert model.train.vehicle.wheelset_mass_kg == pytest.approx(1780.0 * 1000.0 / 890.0)
    # What was not named, and the nominal model, stay as they are.
    assert model.line.laws["bearing"] is campaign.model.line.laws["bearing"]
    assert campaign.model.line.laws["pad"].complex(10.0) == pytest.approx(6.0e7 * (1 + 0.15j))
    changed = campaign.with_values({"gain": 1.1, "level": -3.0})
    assert changed.sensor("rail@12").chain.gain == pytest.approx(1.1)
    assert changed.stated.irregularity.level_dB == -3.0
    assert changed.sensor("deck@6").chain.gain == 1.0


@pytest.mark.parametrize(
    ("values", "where"),
    [
        ({"pad.K": 1.0}, "values: no such parameter"),
        ({"pad.k": -1.0}, "pad.k: must lie between"),
        ({"pad.k": math.nan}, "pad.k: must lie between"),
        ({"gain": 3.0}, "gain: must lie between 0.5 and 2"),
        ({"deck.E": 1e3}, "line.bodies.deck.youngs_modulus_Pa"),
    ],
)
def test_values_that_cannot_be(tmp_path: Path, values: dict[str, float], where: str) -> None:
    with pytest.raises(InputError) as caught:
        small(tmp_path).model_with(values)
    assert str(caught.value).startswith(where), str(caught.value)


def test_what_a_preset_is_made_of_can_be_a_parameter(tmp_path: Path) -> None:
    campaign, model = tables()
    model["line"] = {
        "preset": "slab_track_viaduct_32m",
        "options": {"pad": {"preset": "wj7b_constant", "temperature_C": 20}, "fastener_spacing_m": 0.625},
    }
    for item in (*campaign["sensors"][:2], *campaign["forces"]):
        item["body"] = "rail"
    campaign["parameters"] = [
        {
            "name": "spacing",
            "unit": "m",
            "paths": ["line.options.fastener_spacing_m"],
            "acts": "sets",
            "tolerance_2sigma": 0.1,
        },
        {
            "name": "speed",
            "unit": "km/h",
            "paths": ["train.speed_m_per_s"],
            "acts": "sets",
            "tolerance_2sigma": 0.01,
        },
    ]
    read = read_campaign(write(tmp_path, campaign, model))
    changed = read.model_with({"spacing": 0.6, "speed": 55.0})
    stations = changed.line.joint_table().x
    assert changed.train is not None
    assert changed.train.speed_m_per_s == 55.0
    assert np.diff(stations[:3]) == pytest.approx(0.6)


def test_a_summary_names_the_file_that_was_read(tmp_path: Path) -> None:
    path = write(tmp_path).rename(tmp_path / "line 7, may.toml")
    campaign = read_campaign(path)
    changed = campaign.with_values({"pad.k": 5.0e7, "gain": 1.1})
    others = changed.with_model(campaign.model), changed.with_records(campaign.stated.records[:1])
    for one in (campaign, changed, *others):
        assert one.summary()["campaign"] == str(path)


def test_priors() -> None:
    from permway.campaign.parameters import Known, Parameter

    plain = Parameter(name="k", paths="a.b", tolerance_2sigma=0.5)
    known = Known(plain, 2.0, True, 0.5 * math.atanh(0.5))
    # The interval of two deviations is as wide as ln 1.5 - ln 0.5.
    assert math.log(known.value(2.0) / known.value(-2.0)) == pytest.approx(math.log(1.5 / 0.5))
    assert known.z(known.value(0.7)) == pytest.approx(0.7)
    with pytest.raises(InputError):
        known.z(-1.0)
    flat = Known(plain, -3.0, False, 0.5)
    assert flat.value(2.0) == -2.0
    assert flat.z(-2.0) == 2.0


def test_paths_read_back() -> None:
    for path in ("line.laws.pad.stiffness", "line.joints[2].scale", 'campaign.sensors["rail@16 m"].chain.gain'):
        assert written(parse_path(path, "here")) == path
    for path in ("", ".", "a..b", "[1]", "a[", "a[x]", "a.b c", 'a["b]', "a.1b"):
        with pytest.raises(InputError, match="here: is no path"):
            parse_path(path, "here")


def test_an_amended_model_keeps_the_parameters_it_can(tmp_path: Path) -> None:
    from permway.laws import Springpot

    campaign = small(tmp_path)
    line = campaign.model.line
    laws = {**line.laws, "pad": Springpot(coefficient=3e7, order=0.2)}
    amended = campaign.with_model(
        campaign.model.model_copy(update={"line": line.model_copy(update={"laws": laws})})
    )
    changed = amended.model_with({"pad.k": 9e7, "deck.E": 3e10})
    assert changed.line.laws["pad"] == laws["pad"]
    assert changed.line.bodies["deck"].youngs_modulus_Pa == 3e10  # type: ignore[union-attr]
    assert amended.parameters.nominal() == campaign.parameters.nominal()


def held(campaign: Any, name: str, dataset: Dataset) -> Any:
    from permway.campaign.groups import held_out

    return held_out(campaign, next(g for g in campaign.stated.held_out if g.name == name), dataset)


def test_held_out_groups_mark_what_they_hold(tmp_path: Path) -> None:
    import xarray as xr

    campaign = small(tmp_path)
    blows, run = campaign.stated.records
    frequency = np.arange(50.0, 201.0, 50.0)
    frf = Dataset(
        blows,
        campaign.condition("still"),
        xr.Dataset(coords={"sensor": ["rail@12", "deck@6"], "force": ["hit", "hit far"], "frequency": frequency}),
    )
    csd = Dataset(
        run, campaign.condition("fast"), xr.Dataset(coords={"channel": ["axle", "floor"], "frequency": frequency})
    )
    assert held(campaign, "top", frf).sum() == 2 * 2 * 2
    assert held(campaign, "speed", csd).all()
    assert not held(campaign, "speed", frf).any()
    assert held(campaign, "far", frf).sel(force="hit far").all()
    assert not held(campaign, "far", frf).sel(force="hit").any()
    assert held(campaign, "floor", csd).values.tolist() == [[False] * 4, [True] * 4]
