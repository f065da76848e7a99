"""A clipped channel on board, diagnosed as a user would: no physics is made up for it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from permway.challenge import write
from permway.challenge.effects.recorders import Clipping
from permway.diagnosis.diagnose import diagnose
from permway.recordings.importers.sheet import import_sheet
from short_deck import small_case


@pytest.mark.filterwarnings("ignore:axlebox3.*times the noise of the other channels:UserWarning")
@pytest.mark.parametrize("channel", ["carbody", "axlebox3"])
def test_clipping_is_said_and_nothing_else(tmp_path: Path, channel: str) -> None:
    case = replace(small_case(), effects=(Clipping(channel, 1.5),))
    write(case, tmp_path / "folder")
    found = diagnose(import_sheet(tmp_path / "folder", tmp_path / "imported"), threads=1)
    verdict = found.verdict
    assert verdict.status == "measurement"
    assert {(e.name, e.place.channels) for e in verdict.effects} == {("clipping", (channel,))}
    assert all(channel in name for name in found.comparison.left_out)
    assert len(found.comparison.left_out) == len(case.tests.speeds_kmh)
