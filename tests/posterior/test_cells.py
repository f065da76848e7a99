"""What is offered beside a set of amendments is of the nominal line, whatever the set has changed in it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.campaign.campaign import read_campaign
from permway.challenge.small.make import make_small
from permway.diagnosis.gather import gather
from permway.errors import InputError
from permway.posterior.cells import Cell, cells
from permway.posterior.fit import Fit, Fitter, grown
from permway.posterior.recalibrated import recalibrated

OF_THE_LINE = ("slab_joints", "girder_crack", "fastener_loss", "bearing_stiffness", "deck_attachment")


def of_path(fit: Fit) -> list[Cell]:
    return [cell for cell in cells(fit) if cell.hypothesis.domain == "path"]


@pytest.mark.parametrize("index", [0, 3, 6, 9])
def test_hypotheses_beside_a_set_hold_nothing_of_it(tmp_path: Path, index: int) -> None:
    name = make_small(5150002, index, tmp_path)
    campaign = read_campaign(tmp_path / name / "campaign.toml")
    base = recalibrated(gather(campaign, threads=1))
    alone = of_path(base)
    firsts = {cell.hypothesis.entry: cell for cell in alone if cell.hypothesis.entry in OF_THE_LINE}
    assert firsts
    for first in firsts.values():
        model = grown(base, first.hypothesis, "1.")
        amended = Fitter(base.frame).begin(model, np.concatenate([base.z, first.z]), base.hyper)
        beside = of_path(amended)
        assert [one.hypothesis.form for one in beside] == [one.hypothesis.form for one in alone]
        for one, other in zip(beside, alone, strict=True):
            try:
                expected = other.hypothesis.amend(campaign, other.values).model
            except InputError:
                continue
            assert one.hypothesis.amend(campaign, one.values).model == expected


@pytest.mark.parametrize("index", range(12))
def test_any_amendment_on_any_other_changes_the_line_or_is_refused(tmp_path: Path, index: int) -> None:
    """A set may have changed the law, or cut the beam, that another amendment is about."""
    name = make_small(5150003, index, tmp_path)
    campaign = read_campaign(tmp_path / name / "campaign.toml")
    forms = {cell.hypothesis.form: cell for cell in cells(recalibrated(gather(campaign, threads=1)))}
    assert len(forms) > 10
    refused = 0
    for first in forms.values():
        if first.hypothesis.moves:
            continue
        amended = first.hypothesis.amend(campaign, first.values)
        for second in forms.values():
            if not second.hypothesis.moves:
                try:
                    second.hypothesis.amend(amended, second.values)
                except InputError:
                    refused += 1
    assert refused < 0.3 * len(forms) ** 2
