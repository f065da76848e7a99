"""A rig whose masses were shaken at two levels: both are read, each under a condition of its own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from folders import make_rig, make_shaken
from permway.campaign.importers.rubber_rig import import_rubber_rig
from permway.campaign.predict import predict
from permway.errors import InputError

BOTH = ("01g_253g", "1g_253g", "1g_573g")


@pytest.mark.parametrize("law", ["constant", "fractional_zener"])
def test_both_levels_are_read(tmp_path: Path, law: str) -> None:
    (campaign,) = import_rubber_rig(make_rig(tmp_path / "rig", BOTH), tmp_path / "out", law=law)
    shaken = [d for d in campaign.load() if d.record.statistic == "transmissibility"]
    assert {d.record.name: d.condition.name for d in shaken} == {
        "01g_253g": "shaker_01g",
        "1g_253g": "shaker_1g",
        "1g_573g": "shaker_1g",
    }
    # One mass on one pair of rings, whatever it was shaken at.
    assert [sensor.name for sensor in campaign.stated.sensors] == ["mass_253g", "mass_573g"]
    assert [d.names("channel") for d in shaken] == [["mass_253g"], ["mass_253g"], ["mass_573g"]]
    groups = {group.name: group.members for group in campaign.stated.held_out}
    assert groups["level 01g"] == ("01g_253g",)
    assert groups["level 1g"] == ("1g_253g", "1g_573g")


def test_each_level_is_predicted_for_its_mass(tmp_path: Path) -> None:
    """By the law that the DMA table states, which is the one that the records were made of, and a softer one."""
    folder = make_rig(tmp_path / "rig", BOTH)
    for name in ("1g_253g", "1g_573g"):
        make_shaken(folder / "rubber" / "shaker" / f"{name}.csv", softer=0.8)
    (campaign,) = import_rubber_rig(folder, tmp_path / "out")
    shaken = [d for d in campaign.load() if d.record.statistic == "transmissibility"]
    misfit = {}
    for dataset, predicted in zip(shaken, predict(campaign, shaken, threads=1), strict=True):
        measured = dataset.data["transmissibility"].values
        ratio = np.abs(np.log(predicted["transmissibility"].values / measured))
        misfit[dataset.record.name] = float(np.sqrt((ratio**2).mean()))
    assert misfit["01g_253g"] < 0.02
    assert min(misfit["1g_253g"], misfit["1g_573g"]) > 0.1


@pytest.mark.parametrize(
    ("name", "what"), [("253g", "states not both a level and a mass"), ("1g_heavy", "states no mass")]
)
def test_a_record_that_does_not_state_level_and_mass_is_refused(tmp_path: Path, name: str, what: str) -> None:
    folder = make_rig(tmp_path / "rig", BOTH)
    (folder / "rubber" / "shaker" / "1g_253g.csv").rename(folder / "rubber" / "shaker" / f"{name}.csv")
    with pytest.raises(InputError, match=f"{name}.csv: {what}.*; name it by level and mass, as 1g_253g.csv"):
        import_rubber_rig(folder, tmp_path / "out")


def test_what_is_left_aside_is_named(tmp_path: Path) -> None:
    folder = make_rig(tmp_path / "rig", BOTH)
    (folder / "rubber" / "shaker" / "2g_253g.txt").write_text("another level\n")
    (folder / "rubber" / "dma" / "tf_1p.csv").write_text("another strain\n")
    (folder / "other" / "shaker").mkdir(parents=True)
    with pytest.warns(UserWarning, match="left aside") as caught:
        import_rubber_rig(folder, tmp_path / "out")
    named = " ".join(str(warning.message) for warning in caught)
    assert all(name in named for name in ("2g_253g.txt", "tf_1p.csv", "other"))
