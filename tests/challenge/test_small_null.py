"""The proof in small, end to end: a short deck with nothing concealed, of a seed that is new each time."""

from __future__ import annotations

import secrets
from collections.abc import Callable
from pathlib import Path

import pytest
from short_deck import scored


# Its seed is another each time, and so is what it takes: two to six minutes.
@pytest.mark.injection
def test_a_new_seed_with_nothing_concealed_comes_to_a_verdict(
    tmp_path: Path, record_property: Callable[[str, object], None]
) -> None:
    """An alarm in forty is what is allowed, so that a verdict is asked for, and which one is shown, not judged."""
    seed = secrets.randbelow(10**9)
    one = scored(tmp_path, seed, "null")
    record_property("outcome", f"null {seed}, not used before: {one.status} {', '.join(one.named)}")
    assert one.found is None
    assert not one.covered
