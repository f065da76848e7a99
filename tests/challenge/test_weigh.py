"""How hard a campaign is: against its control, in which nothing is concealed."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from permway.challenge import write
from permway.challenge.effects.fasteners import FastenersLost
from permway.challenge.score import Scored
from permway.challenge.weigh import control_of, weigh, weights
from permway.errors import InputError
from permway.posterior.deviance import against_folder
from short_deck import small_case, small_site


@pytest.mark.injection
@pytest.mark.parametrize(("lost", "least", "most"), [(False, -1.0, 1.0), (True, 200.0, np.inf)])
def test_nothing_weighs_nothing_and_a_lost_fastener_much(
    tmp_path: Path, lost: bool, least: float, most: float
) -> None:
    twin = small_case()
    effect = FastenersLost.draw(np.random.default_rng(3), "strong", small_site())
    case = replace(twin, effects=(effect,)) if lost else twin
    write(case, tmp_path / "case")
    write(control_of(case), tmp_path / "twin")
    assert least <= against_folder(tmp_path / "twin")(tmp_path / "case") <= most


def test_what_is_weighed_is_kept_and_nulls_are_not(tmp_path: Path) -> None:
    (tmp_path / "truth").mkdir()
    for name, effects in (("null-1", []), ("single-2", [{"id": "pad_frequency"}])):
        (tmp_path / "truth" / f"{name}.json").write_text(json.dumps({"seed": 2, "tier": "x", "effects": effects}))
    (tmp_path / "weights").mkdir()
    (tmp_path / "weights" / "single-2.json").write_text('{"deviance": 73.5}')
    assert weigh(tmp_path, against_folder) == weights(tmp_path) == {"single-2": 73.5}
    with pytest.raises(InputError, match="holds no truth"):
        weigh(tmp_path / "weights", against_folder)


@pytest.mark.parametrize(
    ("deviance", "group"),
    [
        (None, "single"),
        (-3.0, "single, too small"),
        (15.0, "single, hard"),
        (50.0, "single, medium"),
        (1e4, "single, easy"),
    ],
)
def test_groups(deviance: float | None, group: str) -> None:
    scored = Scored("single-1", "single", "named", (), (), None, None, None, None, False, (), False, 1.0, deviance)
    assert scored.group == group
