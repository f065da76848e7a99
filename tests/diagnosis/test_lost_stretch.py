"""Which joints of a stretch have lost how much: the first look that a fit begins from."""

from __future__ import annotations

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
    first = next(iter(entries()["fastener_loss"].hypotheses(Situation(searched, scanned(searched)))))
    start = {f.name: f.value(z) for f, z in zip(first.free, first.starts[0], strict=True)}
    assert start["centre_m"] == pytest.approx(centre_m)
    assert start["length_m"] == pytest.approx(length_m)
    assert start["factor"] == pytest.approx(left, rel=0.45)
