"""One mass on a spring, or masses all along a body: both explain what few sensors show, and one does better."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from permway.campaign.campaign import Campaign
from permway.diagnosis.bases import bases
from permway.diagnosis.catalogue import girder_local_modes
from permway.diagnosis.catalogue._change import hung_mass, with_joints
from permway.diagnosis.clock import Clock
from permway.diagnosis.describe import Description
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.locate import scanned
from permway.diagnosis.search import Finalist, Round, search
from permway.model.joints import GROUND, Joints
from simulated import simulate


def named_and_instead(folder: Path, amend: Callable[[Campaign], Campaign]) -> tuple[Finalist, Round | None]:
    """What names the deck's local modes, and what hangs there instead, whatever the name leaves."""
    clock = Clock(None)
    base, searched = bases(gather(simulate(folder / "c", 8, amend=amend).campaign, threads=1), clock)
    found = scanned(searched)
    named = search(
        searched,
        girder_local_modes.hypotheses(Situation(searched, found)),
        learnt_base=base,
        prefix="1.",
        threshold=lambda _ring, _screened: 10.0,
        progress=lambda *_: None,
    )
    first = named.finalists[0]
    return first, Description(searched, base, found, clock)._hung([first], named.threshold)


def test_one_mass_on_a_deck_is_described_where_it_hangs(tmp_path: Path) -> None:
    def one(campaign: Campaign) -> Campaign:
        hung = Joints(between=("deck", GROUND), law="hung", at=(8.0,))
        return with_joints(campaign, hung, laws={"hung": hung_mass(900.0, 30.0, 0.06)})

    named, instead = named_and_instead(tmp_path, one)
    assert instead is not None
    best = instead.finalists[0]
    assert best.fit.objective < named.fit.objective
    assert best.hypothesis.family == "resonator on the body"
    assert best.values["x_m"] == pytest.approx(8.0, abs=0.3)
    assert best.values["mass_kg"] == pytest.approx(900.0, rel=0.1)


def test_masses_all_along_a_deck_keep_their_name(tmp_path: Path) -> None:
    all_along = {"mass_share": 0.02, "frequency_Hz": 30.0, "loss_factor": 0.06}

    def spread(campaign: Campaign) -> Campaign:
        return girder_local_modes._of("deck").amend(campaign, all_along)

    named, instead = named_and_instead(tmp_path, spread)
    assert named.values == pytest.approx(all_along, rel=0.1)
    assert instead is None
