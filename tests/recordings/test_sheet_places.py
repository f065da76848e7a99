"""Places of a sheet: wheelsets as given, spans that end on a fastener, several sensors at one place."""

from __future__ import annotations

import copy
import json
import shutil
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.campaign.importers.sheet import import_sheet
from permway.campaign.importers.sheet_form import Sheet
from permway.campaign.importers.sheet_model import model_table
from permway.campaign.importers.sheet_position import position
from permway.errors import InputError
from permway.formats.model_file import model_from_dict
from permway.model.place import Place
from permway.response.receptance import receptance
from scipy import io
from sheets import SHEET, make_folder

FOUR = "wheelsets 1..4 at x0+10, x0+7.5, x0-7.5, x0-10"
EXACT = (26.0, 23.5, 8.5, 6.0)
ROUNDED = (25.92, 23.52, 8.48, 6.08)


def sheet(stated: Any = "", **layout: Any) -> Sheet:
    """A deck of 32 m, and what its `position` states."""
    table = copy.deepcopy(SHEET)
    table["layout"] |= {"span_m": 32.0, "slab_length_m": 32.0, **layout}
    table["runs"]["position"] = stated
    table["hammer"] |= {"sensors": [["rail", 6.4]], "points": [["rail", 2.56]]}
    return Sheet.model_validate(table)


@pytest.mark.parametrize(
    ("stated", "wheels", "centre"),
    [
        ("", EXACT, 16.0),
        (f"{FOUR} with x0 = 16 m", EXACT, 16.0),
        (f"{FOUR} with x0 = 16 m.", EXACT, 16.0),
        (f"{FOUR} with x0 = 16 m, not rounded", EXACT, 16.0),
        (f"{FOUR} with x0 = 12.5 m", (22.5, 20.0, 5.0, 2.5), 12.5),
        ("wheelsets 1..4 at 26, 23.5, 8.5, 6 m", EXACT, 16.0),
        ("Wheelsets 1 to 4 at 26 m, 23.5 m, 8.5 m and 6 m", EXACT, 16.0),
        ("wheelsets 1-4 at x0 + 10,x0 + 7.5,x0 - 7.5,x0 - 10, with x0 = 16 m", EXACT, 16.0),
        ("wheelsets 1..4 at x0, x0-2.5, x0-17.5, x0-20 with x0 = 24 m", (24.0, 21.5, 6.5, 4.0), 24.0),
        ([26.0, 23.5, 8.5, 6.0], EXACT, 16.0),
        ([30, 27.5, 12.5, 10], (30.0, 27.5, 12.5, 10.0), 20.0),
        (
            f"{FOUR} with x0 = 16 m (moving-irregularity model), each rounded to the nearest 0.16 m",
            ROUNDED,
            16.0,
        ),
        (f"{FOUR} with x0 = 16 m, rounded to the nearest 0.16 m, halfway to the even multiple", ROUNDED, 16.0),
        (f"{FOUR} with x0 = 16 m, each rounded to the nearest 0.5 m", EXACT, 16.0),
    ],
)
def test_wheelsets_stand_where_the_sheet_has_them(stated: Any, wheels: tuple[float, ...], centre: float) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = position(sheet(stated))
    assert found.wheels_m == pytest.approx(wheels, abs=1e-9)
    assert found.centre_m == pytest.approx(centre)


@pytest.mark.parametrize(
    ("stated", "asked"),
    [
        (
            f"{FOUR} with x0 = 16 m, each rounded down to whole 0.16 m",
            "where do the wheelsets stand? not understood",
        ),
        (
            f"{FOUR} with x0 = 16 m, each rounded to the nearest 16 cm",
            "where do the wheelsets stand? not understood",
        ),
        (f"{FOUR} with x0 = 16 m (give or take 0.1 m)", "where do the wheelsets stand? not understood"),
        ("about the middle of the deck", "where do the wheelsets stand? not understood"),
        ("wheelsets 1..4 at 26,0, 23,5, 8,5, 6,0 m", "where do the wheelsets stand? not understood"),
        ("wheelsets 1..4 at 26000, 23500, 8500, 6000 mm", "where do the wheelsets stand? not understood"),
        (FOUR, "where do the wheelsets stand? x0 is not stated"),
        ("wheelsets 1..4 at 26, 23.5, 8.5, 6 m with x0 = 16 m", "what is counted from x0?"),
        ("wheelsets 1..4 at 26, 23.5, 8.5 m", "has 3 places of 4 wheelsets"),
        ([26.0, 23.5], "has 2 places of 4 wheelsets"),
        ("wheelsets 1..4 at 6, 8.5, 23.5, 26 m", "must descend: the leading wheelset first"),
        (f"{FOUR} with x0 = 16 m, each rounded to the nearest 16 m", "must descend"),
        (f"{FOUR} with x0 = 16 m, each rounded to the nearest 0 m", "rounded to what?"),
    ],
)
def test_what_is_not_understood_to_the_last_word_is_asked_about(stated: Any, asked: str) -> None:
    with pytest.raises(InputError) as caught:
        position(sheet(stated))
    text = str(caught.value)
    assert text.startswith("sheet.json: runs.position: ")
    assert asked in text
    assert "write 'wheelsets 1..4 at 26, 23.5, 8.5, 6 m' or" in text
    assert "\n" not in text


def test_places_that_are_not_the_vehicles_are_taken_and_warned_of() -> None:
    with pytest.warns(UserWarning, match=r"wheelsets 3 and 4 stand 2.4 m apart, and by .* 2.5 m") as caught:
        found = position(sheet("wheelsets 1..4 at 26, 23.5, 8.5, 6.1 m"))
    assert len(caught) == 1
    assert found.wheels_m == (26.0, 23.5, 8.5, 6.1)


def changed(folder: Path, to: Path, *path: str, value: Any) -> Path:
    """A copy of a measuring team's folder with one value of its sheet changed."""
    shutil.copytree(folder, to)
    table = copy.deepcopy(SHEET)
    at: Any = table
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    (to / "sheet.json").write_text(json.dumps(table))
    return to


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_folder(tmp_path_factory.mktemp("team") / "deck")


def test_the_campaign_has_them_unrounded(folder: Path, tmp_path: Path) -> None:
    stated = "wheelsets 1..4 at x0+10, x0+7.5, x0-7.5, x0-10 with x0 = 6.4 m"
    campaign = import_sheet(changed(folder, tmp_path / "team", "runs", "position", value=stated), tmp_path / "out")
    for run in ("run_180kmh", "run_252kmh"):
        assert campaign.condition(run).wheels_m == pytest.approx((16.4, 13.9, -1.1, -3.6), abs=1e-9)


def test_a_sheet_that_is_asked_about_leaves_nothing(folder: Path, tmp_path: Path) -> None:
    team = changed(folder, tmp_path / "team", "runs", "position", value="somewhere")
    with pytest.raises(InputError, match=r"runs\.position: where do the wheelsets stand"):
        import_sheet(team, tmp_path / "out")
    assert {path.name for path in tmp_path.iterdir()} == {"team"}


ON_FASTENERS = [(2, 12.8, 12.8), (3, 6.4, 6.4), (2, 12.8, 6.4), (1, 12.8, 3.2), (2, 12.8, 25.6)]
"""Spans, their length, and that of a slab, m: all end on fasteners, 0.64 m apart."""


def model(spans: int, span_m: float, slab_m: float) -> Any:
    stated = sheet(spans=spans, span_m=span_m, slab_length_m=slab_m)
    return model_from_dict(model_table(stated, "a deck"), folder=Path())


@pytest.mark.parametrize(("spans", "span_m", "slab_m"), ON_FASTENERS)
def test_spans_and_slabs_may_end_on_fasteners(spans: int, span_m: float, slab_m: float) -> None:
    """Each beam has its own length's part of a layer, and each fastener is one."""
    line = model(spans, span_m, slab_m).line
    table, names = line.joint_table(), [segment.name for segment in line.segments()]
    laws = list(line.laws)
    slabs = round(spans * span_m / slab_m)
    for law, row, count in (("mortar", "slab", slabs), ("sliding", "girder", spans)):
        mine = table.law == laws.index(law)
        assert table.scale[mine].sum() == pytest.approx(1.0)
        side = table.upper if row == "slab" else table.lower
        of = [names[i] for i in side[mine]]
        for name in {name for name in names if name.split("[")[0] == row}:
            carried = table.scale[mine][[one == name for one in of]].sum()
            assert carried == pytest.approx(1.0 / count), name
    pads = table.law == laws.index("pad")
    stations = np.round(table.x[pads] / 0.64).astype(int)
    bays = round(spans * span_m / 0.64)
    assert set(stations) == set(range(-10, bays + 11))
    each = np.bincount(stations + 10, weights=table.scale[pads])
    assert each == pytest.approx(1.0)


@pytest.mark.parametrize(("spans", "span_m", "slab_m"), ON_FASTENERS)
def test_a_deck_of_equal_spans_is_its_own_mirror_image(spans: int, span_m: float, slab_m: float) -> None:
    line, length = model(spans, span_m, slab_m).line, spans * span_m
    left = [Place(body=body, x_m=x) for body, x in (("rail", 1.92), ("girder", 3.3), ("base", 2.56))]
    right = [Place(body=place.body, x_m=length - place.x_m) for place in left]
    frequency = np.array([5.0, 20.0, 60.0, 150.0])
    one, other = (
        receptance(line, frequency, forces=side, sensors=side, threads=1)["receptance"].values
        for side in (left, right)
    )
    assert other == pytest.approx(one, rel=1e-6)


def test_two_spans_are_imported_with_their_records(tmp_path: Path, folder: Path) -> None:
    """The records are of one span of twice the length: only their places count here."""
    team = changed(folder, tmp_path / "team", "layout", "spans", value=2)
    table = json.loads((team / "sheet.json").read_text())
    table["layout"] |= {"span_m": 6.4, "slab_length_m": 6.4}
    (team / "sheet.json").write_text(json.dumps(table))
    with pytest.raises(
        InputError, match=r"hammer\.sensors\[1\]: two of the slabs meet there.*\[\"slab\[1\]\", 6\.4\]"
    ):
        import_sheet(team, tmp_path / "out")
    table["hammer"]["sensors"][1] = ["slab[1]", 6.4]
    table["hammer"]["points"][2] = ["girder[2]", 6.4]
    (team / "sheet.json").write_text(json.dumps(table))
    campaign = import_sheet(team, tmp_path / "out")
    assert [s.name for s in campaign.stated.sensors[:3]] == ["rail@6.4", "slab[1]@6.4", "girder@0"]
    assert campaign.load()[0].names("force") == ["rail@6.4", "rail@2.56", "girder[2]@6.4"]


def relabelled(team: Path, sensors: list[str]) -> None:
    """The hammer file with other labels of its sensors."""
    path = team / "hammer_+12C.mat"
    content = {key: value for key, value in io.loadmat(path).items() if not key.startswith("__")}
    content["f"] = content["f"].ravel()
    io.savemat(path, {**content, "sensor": np.array(sensors)})


def test_two_sensors_at_one_place_have_each_its_row(tmp_path: Path, folder: Path) -> None:
    where = [["rail", 6.4], ["rail", 6.4], ["girder", 0.0]]
    team = changed(folder, tmp_path / "team", "hammer", "sensors", value=where)
    relabelled(team, ["rail@6.4 left", "rail@6.40 right", "girder@0"])
    campaign = import_sheet(team, tmp_path / "out")
    assert [s.name for s in campaign.stated.sensors[:3]] == ["rail@6.4", "rail@6.4 (2)", "girder@0"]
    assert campaign.stated.records[0].responses == {
        "rail@6.4 left": "rail@6.4",
        "rail@6.40 right": "rail@6.4 (2)",
        "girder@0": "girder@0",
    }
    assert campaign.load()[0].names("sensor") == ["rail@6.4", "rail@6.4 (2)", "girder@0"]


def test_of_two_in_the_file_and_one_in_the_sheet_none_is_chosen(tmp_path: Path, folder: Path) -> None:
    where = [["rail", 6.4], ["girder", 0.0]]
    team = changed(folder, tmp_path / "team", "hammer", "sensors", value=where)
    relabelled(team, ["rail@6.4 left", "rail@6.4 right", "girder@0"])
    with pytest.raises(InputError, match=r"which of \['rail@6\.4 left', 'rail@6\.4 right'\] is it\?"):
        import_sheet(team, tmp_path / "out")
