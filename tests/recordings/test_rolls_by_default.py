"""Trains roll over the model's own supports unless a campaign states that they stand, or they cannot."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from campaigns import tables, write
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.excitation import Rolling
from permway.cli.check import checks
from permway.errors import InputError
from typer.testing import CliRunner

LEFT_OUT = object()


def campaign(folder: Path, rolling: Any = LEFT_OUT, **model_changes: Any) -> Campaign:
    stated, model = tables()
    del stated["irregularity"]["rolling"]
    if rolling is not LEFT_OUT:
        stated["irregularity"]["rolling"] = rolling
    for key, change in model_changes.items():
        change(model["line"][key])
    return read_campaign(write(folder, stated, model))


def uneven(joints: list[Any]) -> None:
    """One bay is 4 cm shorter than the others."""
    joints[0]["at"] = [0.6 * n - 0.04 * (n > 20) for n in range(41)]


def dense(joints: list[Any]) -> None:
    joints[0]["at"]["spacing_m"] = 0.2


def short(bodies: dict[str, Any]) -> None:
    bodies["rail"]["intervals_m"] = [[-12.0, 36.0]]


def test_over_supports_that_repeat(tmp_path: Path) -> None:
    read = campaign(tmp_path)
    known = read.stated.irregularity.rolls
    assert known is not None
    assert known.spacing_m == pytest.approx(0.6)
    assert known.about is not None
    assert read.summary()["trains"] == "roll over supports 0.6 m apart"


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"joints": uneven}, "supports under the train do not repeat at one spacing"),
        ({"joints": dense}, "supports under the train do not repeat at one spacing"),
        ({"bodies": short}, "rail is too short: what rolls is followed from -5.2 to 38.7 m"),
    ],
)
def test_not_where_they_cannot_and_then_it_is_reported_why(
    tmp_path: Path, changes: dict[str, Any], why: str
) -> None:
    read = campaign(tmp_path, **changes)
    assert read.stated.irregularity.rolls is None
    assert read.summary()["trains"] == f"stand: {why}"
    with pytest.raises(InputError, match=why) as reported:
        campaign(tmp_path, True, **changes)
    assert "irregularity.rolling" in str(reported.value)


def test_a_campaign_may_state_that_they_stand(tmp_path: Path) -> None:
    read = campaign(tmp_path, False)
    assert read.stated.irregularity.rolls is None
    assert read.summary()["trains"] == "stand, as the campaign file states"
    # Values of parameters change nothing of it.
    assert read.with_values({"pad.k": 5.5e7}).stated.irregularity.rolls is None


def test_a_campaign_may_state_what_they_roll_over(tmp_path: Path) -> None:
    known = campaign(tmp_path, {"spacing_m": 0.65}, joints=uneven).stated.irregularity.rolls
    assert known is not None
    assert known.model_copy(update={"about": None}) == Rolling(spacing_m=0.65)


@pytest.mark.parametrize("wrong", [1, "no", {"spacing": 0.6}, {"spacing_m": "0.6"}])
def test_another_word_is_refused(tmp_path: Path, wrong: Any) -> None:
    with pytest.raises(InputError, match=r"irregularity\.rolling"):
        campaign(tmp_path, wrong)


def test_without_a_run_there_is_nothing_to_roll(tmp_path: Path) -> None:
    stated, model = tables()
    del stated["irregularity"]["rolling"]
    stated["records"], stated["held_out"] = stated["records"][:1], []
    read = read_campaign(write(tmp_path, stated, model))
    assert read.stated.irregularity.rolls is None
    assert "trains" not in read.summary()
    stated["irregularity"]["rolling"] = True
    with pytest.raises(InputError, match="no run with sensors on board"):
        read_campaign(write(tmp_path, stated, model))


def test_a_check_states_so(tmp_path: Path) -> None:
    stated, model = tables()
    del stated["irregularity"]["rolling"]
    path = write(tmp_path, stated, model)
    done = CliRunner().invoke(checks, ["check", str(path), "--json", "--no-picture"])
    assert json.loads(done.stdout)["trains"] == "roll over supports 0.6 m apart"


def test_stations_written_to_a_centimetre_repeat(tmp_path: Path) -> None:
    def rounded(joints: list[Any]) -> None:
        joints[0]["at"] = [round(float(x), 2) for x in np.arange(38) * 0.6452]

    known = campaign(tmp_path, joints=rounded).stated.irregularity.rolls
    assert known is not None
    assert known.spacing_m == pytest.approx(0.6452, rel=1e-3)
