"""Which rows a part that is left out holds, and what is gained on it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.campaign.parts import HeldOut
from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.blocks_spectra import SpectraBlock
from permway.diagnosis.blocks_tabular import TableBlock
from permway.diagnosis.catalogue import sensor_gain
from permway.diagnosis.catalogue._change import with_chain
from permway.diagnosis.catalogue._excite import chain_with
from permway.diagnosis.catalogue._interval import weakened
from permway.diagnosis.compete import Ring
from permway.diagnosis.e_value import _halves, log_e_value
from permway.diagnosis.evidence import Evidence
from permway.diagnosis.gather import gather
from permway.diagnosis.heldout import Rest, at_fault, gains, parts
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.recalibrate import recalibrate
from simulated import simulate


@pytest.fixture(scope="module")
def evidence(tmp_path_factory: pytest.TempPathFactory) -> Evidence:
    case = simulate(tmp_path_factory.mktemp("held") / "c", 3, amend=lambda c: weakened(c, "pad", 7.5, 0.6, 0.05))
    return gather(case.campaign, threads=1)


def with_groups(evidence: Evidence, *groups: HeldOut) -> Evidence:
    campaign = evidence.campaign
    said = campaign.stated.model_copy(update={"held_out": groups})
    changed = Campaign(said, campaign.model, campaign.folder, campaign.parameters)
    return Evidence(changed, evidence.blocks, evidence.sizes, 1)


def test_groups_of_the_campaign_hold_their_rows(evidence: Evidence) -> None:
    groups = (
        HeldOut(name="deck", axis="channel", members=("deck@3",)),
        HeldOut(name="low", axis="band", band_Hz=(8.0, 40.0)),
        HeldOut(name="far end", axis="place", from_to_m=(9.0, 12.0)),
    )
    found = {part.name: part.rows for part in parts(with_groups(evidence, *groups))}
    rows = evidence.rows
    np.testing.assert_array_equal(found["deck"], rows.sensor == "deck@3")
    np.testing.assert_array_equal(found["low"], rows.frequency_Hz <= 40.0)
    np.testing.assert_array_equal(found["far end"], rows.force == "hit far")


def test_without_groups_points_and_bands_are_left_out(evidence: Evidence) -> None:
    found = {part.axis: part.rows for part in parts(evidence)}
    assert set(found) == {"place", "band"}
    assert all(rows.any() and not rows.all() for rows in found.values())


def test_the_right_model_gains_and_the_same_model_does_not(evidence: Evidence) -> None:
    base = recalibrate(evidence, learn=False)

    def lost(values: dict[str, float]) -> Campaign:
        return weakened(evidence.campaign.with_values(values), "pad", 7.5, 0.6, 0.05)

    amended = recalibrate(base.evidence, build=lost, free=base.free, learn=False)
    chosen = list(parts(evidence))
    before, after = Rest(base), Rest(amended)
    for gain in gains(before, after, chosen):
        assert gain.nats > 100.0
        assert gain.after_dB < gain.before_dB
    for gain in gains(before, before, chosen):
        assert gain.nats == pytest.approx(0.0, abs=1e-6)
    assert log_e_value(before, after, 1) > np.log(20.0)
    # What was chosen among many has to foretell as much more.
    assert log_e_value(before, after, 100) == pytest.approx(log_e_value(before, after, 1) - np.log(100.0))
    assert log_e_value(before, before, 1) == pytest.approx(0.0, abs=1e-6)


def test_levels_are_as_measured_however_large_the_errors_of_pairs(evidence: Evidence) -> None:
    """What a pair's smooth error explains is taken out of deviations, and not of levels that an engineer reads."""
    predicted = evidence.predicted(evidence.campaign).datasets
    sizes, levels = [], []
    for pair in (1e-4, 1.0):
        blocks = tuple(b.with_pair(pair) if isinstance(b, FrfBlock) else b for b in evidence.blocks)
        other = replace(evidence, blocks=blocks)
        sizes.append(float(np.sqrt(np.mean(other.deviations(predicted) ** 2))))
        levels.append(other.levels_dB(predicted))
    assert sizes[1] < 0.5 * sizes[0]
    np.testing.assert_array_equal(levels[0], levels[1])
    measured, said = evidence.datasets[0].data["frf"].values, predicted[0]["frf"].values
    expected = 20.0 * np.log10(np.abs(measured) / np.abs(said)).reshape(-1)
    np.testing.assert_allclose(levels[0][: expected.size], expected, atol=1e-9)
    assert np.isnan(levels[0][expected.size : 2 * expected.size]).all()


def test_halves_are_points_and_lines_and_of_several_tables_whole_tables(evidence: Evidence) -> None:
    """Runs meet one profile, so one says nothing of whether another was met by chance."""
    assert len(list(_halves(evidence))) == 1
    table, run = TableBlock.__new__(TableBlock), SpectraBlock.__new__(SpectraBlock)
    rows = SimpleNamespace(force=np.array([""] * 6), frequency_Hz=np.array([10.0, 20.0] * 3))

    def halves(*blocks: object) -> list[list[bool]]:
        some = SimpleNamespace(rows=rows, block_of=np.array([0, 0, 1, 1, 2, 2]), blocks=blocks)
        return [half.tolist() for half in _halves(cast(Evidence, some))]

    by_line = [False, True] * 3
    assert halves(run, run, run) == [by_line]
    assert halves(table, table, table) == [by_line, [False, False, True, True, False, False]]
    assert halves(table, run, table) == [by_line, [False, False, False, True, True, True]]
    rows.force = np.array(["a", "b", "", "", "", ""])
    struck = [False, True, False, True, False, True]
    assert halves(run, table, table) == [struck, [False, True, False, False, True, True]]


def test_with_nothing_missing_the_e_value_passes_20_once_in_twenty_times_at_most(tmp_path: Path) -> None:
    """An effect that was not chosen by these records, on twenty campaigns without it: P(E > 20) <= 1/20."""
    passed, drawn = np.zeros(2), []
    for seed in range(20):
        base = recalibrate(gather(simulate(tmp_path / str(seed), seed).campaign, threads=1), learn=False)
        (effect,) = (
            h for h in sensor_gain.hypotheses(Situation(base, ())) if h.locate({}).channels == ("deck@3",)
        )
        ring = Ring(base)
        amended = ring.full(ring.quick(effect), prefix="1.")
        before, after = Rest(base), Rest(amended)
        faults = list(at_fault(base.evidence, ("deck@3",)))
        drawn.append([log_e_value(before, after, 1, some) for some in ([], faults)])
        passed += np.array(drawn[-1]) > np.log(20.0)
    # Four or more would come once in sixty times.
    assert (passed <= 3).all()
    assert (np.exp(np.minimum(drawn, 3.0)).mean(axis=0) < 2.0).all()


def test_a_fault_of_a_chain_is_told_by_the_rest_of_its_band(tmp_path: Path) -> None:
    """Where chains err by much, each blow tells of the next what the chain does, called a fault or not."""
    case = simulate(
        tmp_path / "c",
        5,
        smooth=0.15,
        amend=lambda c: with_chain(c, "deck@3", chain_with(c.sensor("deck@3").chain, gain=0.4)),
    )
    base = recalibrate(gather(case.campaign, threads=1))
    (effect,) = (h for h in sensor_gain.hypotheses(Situation(base, ())) if h.locate({}).channels == ("deck@3",))
    ring = Ring(base)
    amended = ring.full(ring.quick(effect), prefix="1.")
    before, after = Rest(base), Rest(amended)
    faults = list(at_fault(base.evidence, ("deck@3",)))
    assert log_e_value(before, after, 60) < np.log(20.0) < log_e_value(before, after, 60, faults)
