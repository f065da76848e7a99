"""Tables of modes: how they are read, what is refused, what a model predicts of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import tables_of_modes as tables
from permway.campaign.campaign import read_campaign
from permway.campaign.groups import held_out
from permway.campaign.parts import HeldOut
from permway.campaign.predict import predict
from permway.errors import InputError


def loaded(path: Path):
    campaign = read_campaign(path)
    return campaign, campaign.load()


def test_a_model_predicts_its_own_table(tmp_path: Path) -> None:
    campaign, (dataset,) = loaded(tables.write(tmp_path, tables.rows_of(tables.MODEL)))
    (found,) = predict(campaign, [dataset])
    assert dataset.data.sizes["frequency"] >= 5
    assert found["modes"].values == pytest.approx(dataset.data["modes"].values, rel=1e-7)
    assert dataset.data["relative_sd"].values[0] == pytest.approx(tables.SD, rel=1e-6)
    assert dataset.data["relative_sd"].values[1] == pytest.approx(tables.SD_DAMPING, rel=1e-6)
    assert dataset.data["shape"].dims == ("sensor", "frequency")


def test_percent_no_shapes_an_empty_cell_and_the_order(tmp_path: Path) -> None:
    rows = ["mode,damping_percent,damping_sd_percent,frequency_sd_Hz,frequency_Hz,note"]
    rows += ["2,,,0.04,19.4,hardly seen", "1,2.5,0.25,0.01,5.5,"]
    _, (dataset,) = loaded(tables.write(tmp_path, rows))
    assert dataset.data["modes"].values == pytest.approx(np.array([[5.5, 19.4], [0.025, np.nan]]), nan_ok=True)
    assert dataset.data["relative_sd"].values[:, 0] == pytest.approx([0.01 / 5.5, 0.1])
    assert "shape" not in dataset.data


def test_one_file_of_two_temperatures_and_a_band(tmp_path: Path) -> None:
    rows = ["temperature_C,frequency_Hz,frequency_sd_Hz", "30,5.4,0.01", "-5,5.6,0.01", "-5,20.1,0.1"]
    _, (dataset,) = loaded(tables.write(tmp_path / "a", rows, select={"temperature_C": -5}))
    assert dataset.data["frequency"].values.tolist() == [5.6, 20.1]
    _, (dataset,) = loaded(tables.write(tmp_path / "b", rows, select={"temperature_C": -5}, band_Hz=(10.0, 30.0)))
    assert dataset.data["frequency"].values.tolist() == [20.1]


@pytest.mark.parametrize(
    ("rows", "words", "where"),
    [
        (["frequency_Hz", "5.0"], "no such column", "line 1"),
        (["frequency_Hz,frequency_sd_Hz,damping", "5.0,0.1,0.02"], "no such column", "line 1"),
        (["frequency_Hz,frequency_sd_Hz,dampng", "5.0,0.1,0.02"], "not understood", "line 1"),
        (["frequency_Hz,frequency_sd_Hz,a", "5.0,0.1,1"], "at all of them or at none", "channels.b"),
        (["frequency_Hz,frequency_sd_Hz,frequency_Hz", "5.0,0.1,5"], "stands twice", "line 1"),
        (["frequency_Hz,frequency_sd_Hz", "5.0,0"], "above 0", "line 2, column 'frequency_sd_Hz'"),
        (["frequency_Hz,frequency_sd_Hz", "-5.0,0.1"], "above 0", "line 2, column 'frequency_Hz'"),
        (["frequency_Hz,frequency_sd_Hz", "5.0"], "1 cells where", "line 2"),
        (["frequency_Hz,frequency_sd_Hz", "5 Hz,0.1"], "not a number", "line 2"),
        (["frequency_Hz,frequency_sd_Hz"], "no row", "line 1"),
        (["frequency_Hz,frequency_sd_Hz,damping,damping_sd", "5,0.1,2.5,0.1"], "is of no vibration", "line 2"),
        (["frequency_Hz,frequency_sd_Hz,damping,damping_sd", "5,0.1,0.02,"], "is empty", "line 2"),
        (["frequency_Hz,frequency_sd_Hz,a,b,c,d", "5,0.1,0,0,0,0"], "zero at all", "line 2"),
    ],
)
def test_what_is_refused_in_the_file(tmp_path: Path, rows: list[str], words: str, where: str) -> None:
    campaign = read_campaign(tables.write(tmp_path, rows))
    with pytest.raises(InputError, match=words) as error:
        campaign.load()
    assert where in error.value.where
    assert "records.table" in error.value.where


def test_what_is_refused_in_the_campaign(tmp_path: Path) -> None:
    rows = tables.rows_of(tables.MODEL)
    with pytest.raises(InputError, match="missing: say which"):
        read_campaign(tables.write(tmp_path, rows, channels={}))
    with pytest.raises(InputError, match="no sensor of that name"):
        read_campaign(tables.write(tmp_path, rows, channels={"a": "elsewhere"}))


def test_a_mode_that_the_model_lacks_is_missed_and_no_other_takes_its_place(tmp_path: Path) -> None:
    rows = tables.rows_of(tables.MODEL)
    extra = rows[1].split(",")
    extra[:2] = ["6.6", "0.01"]
    campaign, (dataset,) = loaded(tables.write(tmp_path, [*rows, ",".join(extra)]))
    (found,) = predict(campaign, [dataset])
    at = dataset.data["frequency"].values == 6.6
    assert np.isnan(found["modes"].values[:, at]).all()
    assert found["modes"].values[:, ~at] == pytest.approx(dataset.data["modes"].values[:, ~at], rel=1e-7)


def two_decks() -> dict:
    """A second, softer deck, tied to the first one: pairs of modes whose order turns with its stiffness."""

    def amend(model: dict) -> None:
        line = model["line"]
        line["bodies"]["other"] = {**line["bodies"]["deck"], "youngs_modulus_Pa": 3.3e10}
        line["laws"]["tie"] = {"type": "hysteretic", "stiffness": 2.0e6, "loss_factor": 0.1}
        line["joints"] += [
            {"between": ["other", "ground"], "law": "bearing", "at": {"of": "other"}},
            {"between": ["deck", "other"], "law": "tie", "at": [6.0, 18.0]},
        ]

    return tables.changed(amend)


@pytest.mark.parametrize("shapes", [True, False])
def test_shapes_distinguish_modes_that_changed_places(tmp_path: Path, shapes: bool) -> None:
    """The listed first mode is that of the deck; a softer deck has it below that of the other one."""
    model = two_decks()
    channels = {"deck": "a", "other": "z"}
    header = "frequency_Hz,frequency_sd_Hz" + (",deck,other" if shapes else "")
    # Decks apart: the one with the sensors' larger motion is at 5.55, the other at 5.45.
    rows = [header, "5.45,0.01" + (",0.1,1" if shapes else ""), "5.55,0.01" + (",1,-0.1" if shapes else "")]
    path = tables.write(tmp_path, rows, model=model, channels=channels)
    text = path.read_text(encoding="utf-8")
    path.write_text(text + '\n[[sensors]]\nname = "z"\nbody = "other"\nx_m = 4.0\nunit = "m/s2"\n')
    campaign, (dataset,) = loaded(path)
    softer = campaign.with_values({"E": 3.1e10})
    order = []
    for one in (campaign, softer):
        (found,) = predict(one, [dataset])
        frequency = found["modes"].values[0]
        order.append(bool(frequency[0] < frequency[1]))
    assert order == ([True, False] if shapes else [True, True])


def test_a_temperature_moves_what_is_predicted(tmp_path: Path) -> None:
    path = tables.write(tmp_path, tables.rows_of(tables.MODEL))
    text = path.read_text(encoding="utf-8")
    stiffer = 'kind = "table"\nfactors = { "line.laws.bearing.stiffness" = 1.5 }'
    campaign, (dataset,) = loaded(path)
    path.write_text(text.replace('kind = "table"', stiffer), encoding="utf-8")
    warmer, (again,) = loaded(path)
    (before,), (after,) = predict(campaign, [dataset]), predict(warmer, [again])
    assert (after["modes"].values[0] > before["modes"].values[0]).all()


def test_groups_hold_modes_by_band_and_record(tmp_path: Path) -> None:
    campaign, (dataset,) = loaded(tables.write(tmp_path, tables.rows_of(tables.MODEL)))
    band = held_out(campaign, HeldOut(name="top", axis="band", band_Hz=(30.0, 200.0)), dataset)
    assert band.values.shape == dataset.data["modes"].shape
    assert (band.values == (dataset.data["frequency"].values >= 30.0)).all()
    assert held_out(campaign, HeldOut(name="all", axis="record", members=("table",)), dataset).all()
