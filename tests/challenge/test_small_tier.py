"""The proof in small, end to end: a deck with fasteners lost, of a seed that stays (`pytest -m injection`)."""

from __future__ import annotations

from pathlib import Path

import pytest
from short_deck import scored

LOST = 5
"""Of a single: fasteners that are lost, strongly."""


@pytest.mark.injection
def test_lost_fasteners_are_found_placed_and_named(tmp_path: Path) -> None:
    one = scored(tmp_path, LOST, "single")
    assert one.truth == ("fastener_loss",)
    assert (one.status, one.found, one.placed, one.family) == ("named", True, True, True)
    assert not one.false_name
    assert not one.harmed
    assert len(one.covered) == 1
