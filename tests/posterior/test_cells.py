"""What is offered beside a set of amendments is of the nominal line, whatever the set has changed in it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.campaign.campaign import read_campaign
from permway.challenge.small.layouts import draw_layout
from permway.challenge.small.make import generator, make_small
from permway.diagnosis.gather import gather
from permway.diagnosis.location import step_m, stretches
from permway.errors import InputError
from permway.model.bodies import Beam
from permway.model.line import Line
from permway.posterior.cells import Cell, cells
from permway.posterior.fit import Fit, grown
from permway.posterior.fitter import Fitter
from permway.posterior.recalibrated import recalibrated
from permway.problem.model import Model

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


@pytest.mark.parametrize("index", [0, 3, 6, 9])
def test_no_hypothesis_is_offered_twice_and_pays_for_it(tmp_path: Path, index: int) -> None:
    """Two of one form, with the same priors, do not change the line alike: each would be half as probable."""
    name = make_small(5150002, index, tmp_path)
    campaign = read_campaign(tmp_path / name / "campaign.toml")
    hypotheses = {
        id(cell.hypothesis): cell.hypothesis for cell in of_path(recalibrated(gather(campaign, threads=1)))
    }
    seen: dict[object, list[Model]] = {}
    for one in hypotheses.values():
        if one.moves:
            continue
        values = {f.name: f.value(0.7) for f in one.free}
        made = one.amend(campaign, values).model
        alike = seen.setdefault((one.form, tuple(values.values())), [])
        assert made not in alike, one.form
        alike.append(made)


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


def drawn_of(seed: int, index: int) -> tuple[str, str]:
    """Layout and variant of a small campaign."""
    random = generator(seed, index, "layout")
    _ = random.random()
    layout = draw_layout(random)
    return layout.name, layout.variant


def test_a_beam_clamped_at_one_end_is_looked_at_all_along(tmp_path: Path) -> None:
    """Joints are at its end alone."""
    index = next(i for i in range(200) if drawn_of(5150004, i) == ("beam", "clamped"))
    campaign = read_campaign(tmp_path / make_small(5150004, index, tmp_path) / "campaign.toml")
    length = campaign.model.line.segments()[0].stop
    assert campaign.model.line.joint_table().x.max() < 0.1 * length
    found = cells(recalibrated(gather(campaign, threads=1)))
    for entry in ("deck_attachment", "girder_crack", "novel"):
        places = [cell.hypothesis.locate(cell.values).x_m for cell in found if cell.hypothesis.entry == entry]
        middles = np.unique([0.5 * sum(x) for x in places if x is not None])
        assert middles.min() < 0.25 * length, entry
        assert middles.max() > 0.75 * length, entry


@pytest.mark.parametrize("length_m", [0.3, 6.0, 30.0])
def test_short_beams_are_looked_at_as_closely_for_their_length(length_m: float) -> None:
    beam = Beam(
        youngs_modulus_Pa=2e11,
        second_moment_m4=1e-8,
        density_kg_per_m3=7850.0,
        area_m2=1e-3,
        intervals_m=((0.0, length_m),),
        ends=("clamped", "free"),
    )
    line = Line(bodies={"beam": beam})
    ((segment, low, high),) = stretches(line)
    assert (segment.body, low, high) == ("beam", 0.0, length_m)
    assert 8 <= length_m / step_m(length_m) <= max(8.0, length_m) * (1.0 + 1e-9)
