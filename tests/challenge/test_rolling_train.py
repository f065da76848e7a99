"""Campaigns of trains that truly run: the ring they run round, and what of a standing train they share."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from permway.campaign.importers.sheet import import_sheet
from permway.challenge import rolling
from permway.challenge.assembly import assemble
from permway.challenge.case import Case, draw, write
from permway.challenge.closed_mesh import ClosedMesh
from permway.challenge.layout import NOMINAL, Layout
from permway.challenge.measure import measure
from permway.challenge.mesh import Mesh
from permway.challenge.newmark import line_matrices
from permway.challenge.plan import Chain
from permway.challenge.running import with_dashpots
from permway.errors import InputError
from permway.laws import KelvinVoigt
from scipy.sparse.linalg import splu
from short_deck import small_case

THREE = Layout(spans=3, bays=61, spacing_m=0.6, approach_bays=20)
SECONDS = 2.0


def short_case(laps: tuple[int, int] = (3, 4)) -> Case:
    """A train on three short spans, for two seconds, with nothing wrong in what records it."""
    case = small_case(clean=True, layout=THREE)
    speeds = tuple(round(3.6 * n * THREE.length_m / SECONDS, 3) for n in laps)
    tests = replace(case.tests, seconds=SECONDS, speeds_kmh=speeds)
    return replace(
        case,
        tests=tests,
        nominal=with_dashpots(case.nominal),
        true=with_dashpots(case.true),
        chain=Chain(clean=True),
    )


def test_a_ring_is_the_deck_closed() -> None:
    """Held by its bearings alone; in its middle it yields as a straight deck with approaches does."""
    track = assemble(THREE, NOMINAL)
    ring, deck = ClosedMesh(track), Mesh(track, ())
    mass, _, stiffness = line_matrices(ring, viscous_at_Hz=20.0)
    moved = np.zeros(ring.size)
    for body in track.beams:
        for dofs, _, _ in ring.elements(body):
            moved[dofs[::2]] = 1.0
    beams = [(NOMINAL[b]["rho"] * NOMINAL[b]["A"]) for b in ("rail", "slab", "base", "girder")]
    assert moved @ mass @ moved == pytest.approx(sum(beams) * THREE.length_m, rel=1e-9)
    assert moved @ stiffness @ moved == pytest.approx(6.0 * NOMINAL["bearing"]["k"], rel=1e-9)
    yields = []
    for mesh in (ring, deck):
        force = np.zeros(mesh.size)
        force[mesh.at(("rail", THREE.station(30)))] = 1.0
        held = splu(line_matrices(mesh, viscous_at_Hz=20.0)[2])
        yields.append(held.solve(force) @ force)
    assert yields[0] == pytest.approx(yields[1], rel=1e-4)


def test_a_ring_is_the_same_from_its_end_to_its_beginning() -> None:
    """A force half a bay before the joint yields as one half a bay behind it."""
    ring = ClosedMesh(assemble(THREE, NOMINAL), [("rail", 0.3), ("rail", 36.3)])
    held = splu(line_matrices(ring, viscous_at_Hz=20.0)[2])
    found = []
    for x in (0.3, 36.3):
        force = np.zeros(ring.size)
        force[ring.at(("rail", x))] = 1.0
        # The joint is both 0 and 36.6 m.
        found.append(held.solve(force)[ring.at(("rail", 0.0))])
    assert found[0] == pytest.approx(found[1], rel=1e-6)


def test_a_train_that_rolls_is_one_that_stands_but_for_what_it_rolls_over(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of one profile: below the fasteners' passing the same; there a line that a standing train has not."""
    monkeypatch.setattr(rolling, "FINER", 4)
    monkeypatch.setattr(rolling, "BEFORE_S", 2.0)
    case = short_case()
    plan = case.plan()
    _, stands = measure(plan, np.random.default_rng(3))
    plan.rolls = True
    _, rolls = measure(plan, np.random.default_rng(3))
    for still, run in zip(stands, rolls, strict=True):
        frequency = np.fft.rfftfreq(still.values.shape[0], 1.0 / still.sampling_Hz)
        before, after = (np.abs(np.fft.rfft(one.values[:, :4], axis=0)) for one in (still, run))
        slow = (frequency > 4.0) & (frequency < 20.0)
        off = np.linalg.norm(before[slow] - after[slow], axis=0) / np.linalg.norm(before[slow], axis=0)
        assert off.max() < 0.08
        passing = round(run.speed_kmh / 3.6 / THREE.spacing_m * SECONDS)
        assert (after[passing] > 4.0 * before[passing]).all()


def test_laps_must_be_whole() -> None:
    case = short_case()
    plan = replace(case, tests=replace(case.tests, speeds_kmh=(200.0, 300.0))).plan()
    plan.rolls = True
    with pytest.raises(InputError, match=r"whole number of laps \(got 55.*laps are 36.6 m long"):
        measure(plan, np.random.default_rng(3))


@pytest.mark.parametrize("seed", range(6))
def test_running_trains_are_drawn_for_whole_laps_over_five_spans(seed: int) -> None:
    case = draw(seed, "running")
    assert case.layout.spans == 5
    assert case.layout.length_m > 1.5 * (case.nominal["vehicle"]["lc"] + case.nominal["vehicle"]["lt"])
    for written, factor in zip(case.tests.speeds_kmh, case.chain.speed, strict=True):
        laps = written / 3.6 * factor * case.tests.seconds / case.layout.length_m
        assert laps == pytest.approx(round(laps), abs=1e-3)
    assert case.effects[0].ID == "parametric_support"
    assert case.plan().rolls


def test_layers_of_dashpots_are_imported_as_such(tmp_path: Path) -> None:
    case = short_case()
    write(case, tmp_path / "sheet")
    assert json.loads((tmp_path / "sheet" / "sheet.json").read_text())["values"]["pad"]["viscous_at_Hz"] == 80.0
    campaign = import_sheet(tmp_path / "sheet", tmp_path / "imported")
    # Sheets of all tiers have the irregularity move, also where the truth is a train that rolls.
    assert campaign.stated.irregularity.rolling is False
    pad = case.nominal["pad"]
    law = campaign.model.line.laws["pad"]
    assert isinstance(law, KelvinVoigt)
    assert law.complex([80.0])[0] == pytest.approx(pad["k"] * (1.0 + 1j * pad["eta"]))
    assert law.complex([20.0])[0] == pytest.approx(pad["k"] * (1.0 + 0.25j * pad["eta"]))
    known = campaign.parameters.nominal()
    stiffer = campaign.with_values({"pad.k": 2.0 * known["pad.k"]}).model.line.laws["pad"]
    assert stiffer.complex([80.0])[0] == pytest.approx(2.0 * pad["k"] * (1.0 + 1j * pad["eta"]))
    lossy = campaign.with_values({"pad.eta": 2.0 * known["pad.eta"]}).model.line.laws["pad"]
    assert lossy.complex([80.0])[0] == pytest.approx(pad["k"] * (1.0 + 2j * pad["eta"]))
