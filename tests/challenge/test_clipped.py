"""A clipped channel on board, diagnosed as a user would: no physics is made up for it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from permway.campaign.bad_channels import BadChannel
from permway.campaign.importers.sheet import import_sheet
from permway.challenge import write
from permway.challenge.case import write_truth
from permway.challenge.effects.recorders import Clipping
from permway.challenge.score import score
from permway.diagnosis.verdict import Verdict
from permway.diagnosis.verdict_records import with_bad_channels
from permway.posterior.diagnose import diagnose
from short_deck import small_case


@pytest.mark.injection
@pytest.mark.xfail(
    strict=True,
    raises=AssertionError,
    reason="a corrugation of 1.2 dB about 0.28 m is suspected beside the fault, though the profile has none",
)
@pytest.mark.filterwarnings("ignore:axlebox3.*times the noise of the other channels:UserWarning")
@pytest.mark.parametrize("channel", ["carbody", "axlebox3"])
def test_clipping_is_reported_and_nothing_else(tmp_path: Path, channel: str) -> None:
    case = replace(small_case(), effects=(Clipping(channel, 1.5),))
    write(case, tmp_path / "folder")
    found = diagnose(import_sheet(tmp_path / "folder", tmp_path / "imported"), threads=1)
    verdict = found.verdict
    assert verdict.status == "measurement"
    assert {(e.name, e.place.channels) for e in verdict.effects} == {("clipping", (channel,))}
    assert all(channel in name for name in found.comparison.left_out)
    assert len(found.comparison.left_out) == len(case.tests.speeds_kmh)


def test_what_screening_names_is_scored_as_named(tmp_path: Path) -> None:
    case = replace(small_case(), effects=(Clipping("carbody", 1.5),))
    name = "nonlinear-7"
    (tmp_path / "truth").mkdir()
    write_truth(case, tmp_path / "truth" / f"{name}.json")
    verdict = with_bad_channels(
        Verdict(status="recalibrated"), [BadChannel("run", "carbody", "clipping", "4 samples flat at 3")]
    )
    (tmp_path / "verdicts" / name).mkdir(parents=True)
    verdict.write(tmp_path / "verdicts" / name / "verdict.json")
    (one,) = score(tmp_path, {"fastener_loss": "local loss of support"})
    assert (one.found, one.placed, one.family, one.in_class, one.false_name) == (True, True, True, True, False)
