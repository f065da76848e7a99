"""Which joints of a stretch have lost how much: the first look that a fit begins from."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from permway.diagnosis.bases import bases
from permway.diagnosis.catalogue import entries
from permway.diagnosis.catalogue._interval import weakened
from permway.diagnosis.clock import Clock
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.locate import scanned
from simulated import simulate


def started(situation: Situation) -> dict[str, float]:
    """Constants that the first hypothesis begins with."""
    first = next(iter(entries()["fastener_loss"].hypotheses(situation)))
    return {f.name: f.value(z) for f, z in zip(first.free, first.starts[0], strict=True)}


@pytest.mark.parametrize(
    ("seed", "centre_m", "length_m", "left"),
    [
        (5, 7.2, 0.0, 0.5),
        (5, 7.2, 0.0, 0.15),
        (5, 7.2, 1.2, 0.7),
        (5, 7.2, 1.2, 0.05),
        (7, 9.0, 0.0, 0.5),
        (7, 6.6, 0.0, 0.6),
        (9, 9.0, 0.0, 0.5),
    ],
)
def test_a_fit_begins_with_the_right_joints_and_about_what_is_left(
    tmp_path: Path, seed: int, centre_m: float, length_m: float, left: float
) -> None:
    """A wider stretch that keeps less of its neighbours' stiffness is no better start for one that keeps half."""
    case = simulate(
        tmp_path / "c", seed, amend=lambda campaign: weakened(campaign, "pad", centre_m, length_m, left)
    )
    _, searched = bases(gather(case.campaign, threads=1), Clock(None))
    start = started(Situation(searched, scanned(searched)))
    assert start["centre_m"] == pytest.approx(centre_m)
    assert start["length_m"] == pytest.approx(length_m)
    assert start["factor"] == pytest.approx(left, rel=0.45)


def test_where_a_bent_base_names_other_places_joints_are_looked_at_all_along(tmp_path: Path) -> None:
    """As of three sensors about a long line: the scan named bearings, and no pad near the one that keeps half."""
    case = simulate(tmp_path / "c", 5, amend=lambda campaign: weakened(campaign, "pad", 7.2, 0.0, 0.5))
    _, searched = bases(gather(case.campaign, threads=1), Clock(None))
    found = [one for one in scanned(searched) if one.spot.name == "bearing" or one.spot.x_m[0] < 3.0]
    assert started(Situation(searched, tuple(found)))["centre_m"] != pytest.approx(7.2, abs=0.5)
    start = started(Situation(replace(searched, heat=2.0), tuple(found)))
    assert (start["centre_m"], start["length_m"], start["factor"]) == (pytest.approx(7.2), 0.0, 0.5)
