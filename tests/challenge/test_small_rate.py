"""Small campaigns of fixed seeds, diagnosed: a bar on the rate of right answers, never on one campaign."""

from __future__ import annotations

from itertools import count
from pathlib import Path

import pytest
from permway.challenge.small.diagnose import diagnose_all
from permway.challenge.small.draws import generator
from permway.challenge.small.judge import Judged, judged
from permway.challenge.small.layouts import draw_layout
from permway.challenge.small.make import make_small
from permway.diagnosis.catalogue import entries

SHORT = ("beam", "rig")
"""Layouts whose campaigns take a second or two."""


def diagnosed(folder: Path, seed: int, cases: int, layouts: tuple[str, ...]) -> list[Judged]:
    """The first campaigns of a seed on some layouts, whatever came of them."""
    names: list[str] = []
    for index in count():
        random = generator(seed, index, "layout")
        # The maker is drawn before the layout.
        random.random()
        if draw_layout(random).name in layouts:
            names.append(make_small(seed, index, folder))
        if len(names) == cases:
            break
    diagnose_all([(folder / name / "campaign.toml", folder / "verdicts" / name) for name in names])
    return judged(folder, names, {name: entry.FAMILY for name, entry in entries().items()})


def rates(found: list[Judged]) -> tuple[float, float]:
    """Of what is easy to see, the share that is found; of all, the share with a false name or a false alarm."""
    easy = [bool(j.found) for j in found if j.deviance is not None and j.deviance > 50.0]
    wrong = [j.false_name or (j.kind == "null" and j.called) for j in found]
    return sum(easy) / len(easy), sum(wrong) / len(wrong)


@pytest.mark.injection
def test_a_dozen_short_ones(tmp_path: Path) -> None:
    found, wrong = rates(diagnosed(tmp_path, 1, 12, SHORT))
    assert found >= 0.3
    assert wrong <= 0.1


@pytest.mark.injection
def test_some_dozens_of_all_layouts(tmp_path: Path) -> None:
    found, wrong = rates(diagnosed(tmp_path, 5, 48, ("deck", "ballast", "slab", "beam", "rig")))
    assert found >= 0.3
    assert wrong <= 0.1
