"""The proof in small, end to end: short decks, one seed that stays and one that is new each time."""

from __future__ import annotations

import secrets
from collections.abc import Callable
from pathlib import Path

from permway.challenge import write, write_truth
from permway.challenge.case import Tier
from permway.challenge.run import run
from permway.challenge.score import Scored, score
from permway.diagnosis.catalogue import entries
from short_deck import small_case

LOST = 5
"""Of a single: fasteners that are lost, strongly."""


def scored(folder: Path, seed: int, tier: Tier) -> Scored:
    case = small_case(seed, tier)
    write(case, folder / f"{tier}-{seed}")
    (folder / "truth").mkdir()
    write_truth(case, folder / "truth" / f"{tier}-{seed}.json")
    assert run(folder) == {"verdicts": 1, "failed": 0}, [p.read_text() for p in folder.rglob("failed.txt")]
    (one,) = score(folder, {name: entry.FAMILY for name, entry in entries().items()})
    return one


def test_lost_fasteners_are_found_placed_and_named(tmp_path: Path) -> None:
    one = scored(tmp_path, LOST, "single")
    assert one.truth == ("fastener_loss",)
    assert (one.status, one.found, one.placed, one.family) == ("named", True, True, True)
    assert not one.false_name
    assert not one.harmed
    assert len(one.covered) == 1


def test_a_new_seed_with_nothing_concealed_comes_to_a_verdict(
    tmp_path: Path, record_property: Callable[[str, object], None]
) -> None:
    """An alarm in forty is what is allowed, so that a verdict is asked for, and which one is told, not judged."""
    seed = secrets.randbelow(10**9)
    one = scored(tmp_path, seed, "null")
    record_property("told", f"null {seed}, not used before: {one.status} {', '.join(one.said)}")
    assert one.found is None
    assert not one.covered
