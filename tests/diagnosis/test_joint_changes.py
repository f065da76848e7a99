"""Lines that differ in joints, by a change of low rank, against the same lines solved."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import passages
import pytest
import tables_of_modes
from effects.trains import campaign_in, drawn
from permway.campaign.campaign import Campaign, read_campaign
from permway.challenge.small.make import make_small
from permway.diagnosis import joint_changes
from permway.diagnosis.catalogue._change import with_fields, with_joints
from permway.diagnosis.gather import gather
from permway.diagnosis.joint_changes import MOST_JOINTS, Changed, JointChanges
from permway.diagnosis.observations import Observations
from permway.errors import InputError, SolveError
from permway.laws import Hysteretic
from permway.model.bodies import Beam
from permway.model.joints import GROUND, Joints
from permway.posterior.cells import Cell, cells, small
from permway.posterior.fit import Fit
from permway.posterior.recalibrated import recalibrated


def changes_of(fit: Fit, *, tiny: bool = False) -> tuple[Campaign, JointChanges]:
    """Of the fit's own line."""
    campaign = fit.state.solved.campaign
    return campaign, JointChanges(fit.frame.observations, campaign, fit.state.solved, small=tiny)


def some(fit: Fit, count: int, seed: int) -> list[Cell]:
    """Starts of the search on the path, at random."""
    found = [cell for cell in cells(fit) if cell.hypothesis.domain == "path" and not cell.hypothesis.moves]
    chosen = np.random.default_rng(seed).permutation(len(found))[:count]
    return [found[index] for index in chosen]


def pairs_of(campaign: Campaign, joined: JointChanges, starts: list[Cell]) -> list[tuple[Campaign, Changed]]:
    """Amended campaigns that differ by joints, with what differs."""
    found = []
    for cell in starts:
        try:
            amended = cell.hypothesis.amend(campaign, cell.values)
            changed = joined.of(amended)
        except InputError:
            continue
        if changed is not None:
            found.append((amended, changed))
    return found


def solved(observations: Observations, campaign: Campaign) -> np.ndarray | None:
    """Residuals of a campaign whose line is solved."""
    try:
        return observations.residuals(observations.predicted(campaign).datasets)
    except (InputError, SolveError):
        return None


@pytest.mark.parametrize("index", range(6))
def test_residuals_are_those_of_solved_lines(tmp_path: Path, index: int) -> None:
    """Any layout, any effect of the catalogue and any element of none, of any size: to rounding."""
    campaign = read_campaign(tmp_path / make_small(5150004, index, tmp_path) / "campaign.toml")
    fit = recalibrated(gather(campaign, threads=1))
    base, joined = changes_of(fit)
    pairs = pairs_of(base, joined, some(fit, 60, index))
    joined.solve([changed for _, changed in pairs])
    compared = 0
    for amended, changed in pairs:
        expected = solved(fit.frame.observations, amended)
        if expected is not None and np.isfinite(expected).all():
            found = joined.residuals(changed, lambda amended=amended: amended)
            np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-6)
            compared += 1
    assert compared >= 10


def test_residuals_of_runs_are_those_of_solved_lines(tmp_path: Path) -> None:
    campaign = campaign_in(tmp_path)
    fit = recalibrated(gather(campaign, drawn(campaign, 3), threads=1))
    base, joined = changes_of(fit)
    pairs = pairs_of(base, joined, some(fit, 25, 1))
    joined.solve([changed for _, changed in pairs])
    assert len(pairs) >= 10
    for amended, changed in pairs:
        expected = solved(fit.frame.observations, amended)
        assert expected is not None
        found = joined.residuals(changed, lambda amended=amended: amended)
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-6)


def test_small_changes_of_many_joints_are_those_of_solved_lines_to_first_order(tmp_path: Path) -> None:
    """A thousandth of what a start changes, of whole layers too: its direction to 3 %, most to 0.1 %."""
    off = []
    for index in range(4):
        campaign = read_campaign(tmp_path / make_small(5150004, index, tmp_path) / "campaign.toml")
        fit = recalibrated(gather(campaign, threads=1))
        base, joined = changes_of(fit, tiny=True)
        pairs = pairs_of(base, joined, small(some(fit, 60, index)))
        joined.solve([changed for _, changed in pairs])
        for amended, changed in pairs:
            expected = solved(fit.frame.observations, amended)
            if expected is not None and np.isfinite(expected).all():
                move = expected - fit.state.residuals
                found = joined.residuals(changed, lambda amended=amended: amended) - fit.state.residuals
                off.append(np.linalg.norm(found - move) / (np.linalg.norm(move) + 1e-6))
    assert len(off) >= 80
    assert max(off) < 0.03
    assert np.median(off) < 1e-3


def test_what_is_more_than_joints_is_solved(tmp_path: Path) -> None:
    campaign = read_campaign(tmp_path / make_small(5150004, 0, tmp_path) / "campaign.toml")
    fit = recalibrated(gather(campaign, threads=1))
    base, joined = changes_of(fit)
    line = base.model.line
    beam = next(name for name, body in line.bodies.items() if isinstance(body, Beam))
    assert joined.of(with_fields(base, beam, loss_factor=0.07)) is None
    fewer = line.model_copy(update={"joints": line.joints[1:]})
    assert joined.of(base.with_model(base.model.model_copy(update={"line": fewer}))) is None
    law = {"stiff": Hysteretic(stiffness=1e6)}
    first, last = (line.segments()[0].start, line.segments()[0].stop)
    first, last = max(first, -10.0), min(last, 10.0)
    many = tuple(np.linspace(first + 0.1, last - 0.1, MOST_JOINTS + 1).tolist())
    for at, handled in ((many, False), (many[1:], True)):
        layer = Joints(between=(line.segments()[0].body, GROUND), law="stiff", at=at)
        assert (joined.of(with_joints(base, layer, laws=law)) is not None) == handled


@pytest.mark.parametrize("kind", ["modes", "passage"])
def test_tables_of_modes_and_passages_are_predicted_anew(tmp_path: Path, kind: str) -> None:
    """Their poles, and what a passage asks for along the line, are others where joints are."""
    if kind == "modes":
        path = tables_of_modes.write(tmp_path, tables_of_modes.rows_of(tables_of_modes.changed(), seed=4))
    else:
        time = passages.time_s()
        path = passages.write(
            tmp_path, {name: passages.history(name, time, 0.02) for name in "wv"}, loss_factor=0.04
        )
    fit = recalibrated(gather(read_campaign(path), threads=1))
    base, joined = changes_of(fit)
    starts = some(fit, 80, 1)
    assert any(cell.hypothesis.entry == "novel" for cell in starts)
    assert pairs_of(base, joined, starts) == []


def test_what_could_not_be_solved_leaves_what_is_known(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    campaign = read_campaign(tmp_path / make_small(5150004, 0, tmp_path) / "campaign.toml")
    fit = recalibrated(gather(campaign, threads=1))
    base, joined = changes_of(fit)
    pairs = pairs_of(base, joined, some(fit, 60, 2))
    several = [changed for _, changed in pairs if len(changed.ports) > 1]
    assert several

    def refused(*_: object, **__: object) -> None:
        raise SolveError("the line cannot be solved")

    with monkeypatch.context() as patched:
        patched.setattr(joint_changes, "between_pairs", refused)
        with pytest.raises(SolveError):
            joined.solve(several)
    joined.solve([changed for _, changed in pairs])
    for amended, changed in pairs:
        expected = solved(fit.frame.observations, amended)
        if expected is not None and np.isfinite(expected).all():
            found = joined.residuals(changed, lambda amended=amended: amended)
            np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-6)
