"""Effects put into the tool's own model: unit tests of scan, catalogue and fits, and no proof of them."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.diagnosis.blocks import Basis
from permway.diagnosis.catalogue import entries
from permway.diagnosis.catalogue._interval import weakened
from permway.diagnosis.catalogue.deck_attachment import resonators
from permway.diagnosis.compete import Ring
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.locate import scan
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.spot import Found
from permway.errors import InputError
from simulated import Simulated, simulate

LOST = {"centre_m": 7.5, "length_m": 0.6, "factor": 0.05}
HUNG = {"x_m": 4.0, "mass_kg": 900.0, "frequency_Hz": 40.0, "loss_factor": 0.05}


def base_of(case: Simulated) -> tuple[Fit, list[Found], Ring]:
    evidence = gather(case.campaign, threads=1)
    fit = recalibrate(evidence, learn=False)
    return fit, scan(fit), Ring(fit)


def lost(campaign: Campaign) -> Campaign:
    return weakened(campaign, "pad", **LOST)


@pytest.fixture(scope="module")
def nothing(tmp_path_factory: pytest.TempPathFactory) -> tuple[Fit, list[Found], Ring]:
    return base_of(simulate(tmp_path_factory.mktemp("nothing") / "c", 3))


@pytest.fixture(scope="module")
def hung_loose(tmp_path_factory: pytest.TempPathFactory) -> tuple[Fit, list[Found], Ring]:
    return base_of(simulate(tmp_path_factory.mktemp("lost") / "c", 3, amend=lost))


def gains(fit: Fit, found: list[Found], ring: Ring) -> dict[str, tuple[float, Any]]:
    best: dict[str, tuple[float, Any]] = {}
    for entry in entries().values():
        for hypothesis in entry.hypotheses(Situation(fit, tuple(found))):
            quick = ring.quick(hypothesis)
            if quick.gain > best.get(entry.ID, (-np.inf, None))[0]:
                best[entry.ID] = (quick.gain, quick)
    return best


def test_lost_fasteners_are_found_at_their_place_and_named(hung_loose: tuple[Fit, list[Found], Ring]) -> None:
    fit, found, ring = hung_loose
    assert fit.heat > 2.0
    joints = [f for f in found if f.spot.kind == "joint" and f.spot.name == "pad"]
    assert abs(joints[0].spot.x_m[0] - LOST["centre_m"]) < 1.3
    best = gains(fit, found, ring)
    name = max(best, key=lambda key: best[key][0])
    assert name == "fastener_loss"
    full = ring.full(best[name][1])
    values = full.values()
    assert full.heat < 1.5
    assert abs(values["centre_m"] - LOST["centre_m"]) < 0.3
    assert values["factor"] < 0.2


def test_nothing_missing_gains_little(
    nothing: tuple[Fit, list[Found], Ring], hung_loose: tuple[Fit, list[Found], Ring]
) -> None:
    fit, found, ring = nothing
    assert fit.heat < 1.3
    most = max(gain for gain, _ in gains(fit, found, ring).values())
    there = max(gain for gain, _ in gains(*hung_loose).values())
    assert most < 0.05 * there
    # A free stiffness takes up its own number of degrees, more or less, where nothing is to be found.
    assert np.median([f.gain / f.degrees for f in found]) < 2.5


def test_a_resonator_is_found_by_its_frequency(tmp_path: Path) -> None:
    def amend(campaign: Campaign) -> Campaign:
        spot = FoundAt("deck", 6.0)
        (hypothesis,) = resonators(SituationOf(campaign, spot), "deck", "deck_attachment")
        return hypothesis.amend(campaign, HUNG)

    fit, found, ring = base_of(simulate(tmp_path / "c", 5, amend=amend))
    (hypothesis,) = resonators(Situation(fit, tuple(found)), "deck", "deck_attachment")
    quick = ring.quick(hypothesis)
    values = ring.full(quick).values()
    assert values["frequency_Hz"] == pytest.approx(HUNG["frequency_Hz"], rel=0.02)
    assert values["mass_kg"] == pytest.approx(HUNG["mass_kg"], rel=0.15)
    assert abs(values["x_m"] - HUNG["x_m"]) < 0.7


class FoundAt:
    """A place, as a scan would give it."""

    def __init__(self, body: str, x_m: float) -> None:
        self.spot = type("Spot", (), {"name": body, "x_m": (x_m, x_m)})
        self.by_band, self.frequency_Hz = np.ones(1), np.array([40.0])


class SituationOf:
    """A campaign and one place, instead of a fit and a scan."""

    def __init__(self, campaign: Campaign, found: FoundAt) -> None:
        self.campaign, self._found = campaign, found

    def bodies(self, body: str, most: int = 3) -> list[FoundAt]:
        return [self._found]


def test_a_free_stiffness_is_linear_in_what_is_missing(nothing: tuple[Fit, list[Found], Ring]) -> None:
    _, found, _ = nothing
    assert {f.spot.kind for f in found} == {"joint", "body"}
    assert all(np.isfinite(f.stiffness_N_per_m).all() for f in found)
    assert found[0].surplus >= found[-1].surplus


def test_basis_is_a_partition_of_one() -> None:
    frequency = np.geomspace(3.0, 300.0, 50)
    np.testing.assert_allclose(Basis(2.0, 400.0, 2.0).values(frequency).sum(axis=1), 1.0, rtol=1e-12)


def test_entries_say_what_they_are() -> None:
    found = entries()
    assert len(found) >= 4
    for name, entry in found.items():
        assert name == entry.ID
        assert entry.DOMAIN in ("path", "irregularity", "vehicle", "measurement")
        for text in (entry.SUMMARY, entry.SIGNATURE, entry.SOURCE, entry.FAMILY):
            assert text
        assert entry.PARAMETERS
        assert entry.CONFUSED_WITH


def test_scan_needs_frequency_responses(nothing: tuple[Fit, list[Found], Ring]) -> None:
    fit, _, _ = nothing
    bare = partial(scan, Fit(**{**vars(fit), "evidence": fit.evidence.selected([])}))
    with pytest.raises(InputError, match="no frequency response to locate by"):
        bare()
