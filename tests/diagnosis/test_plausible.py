"""Constants that no such thing has: the catalogue's ranges are read, and all of an interval has to lie beyond."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest
from permway.diagnosis.plausible import beyond_belief, plausible


def finalist(entry: str, **intervals: tuple[float, float]) -> Any:
    return SimpleNamespace(
        hypothesis=SimpleNamespace(entry=entry, free=[SimpleNamespace(name=name) for name in intervals]),
        own=[f"1.{name}" for name in intervals],
        fit=SimpleNamespace(intervals=lambda: {f"1.{name}": ends for name, ends in intervals.items()}),
    )


def test_ranges_are_those_of_the_catalogue() -> None:
    found = plausible("deck_attachment")
    assert found["loss_factor"] == (0.005, 0.5)
    assert "x_m" not in found
    assert plausible("novel") == {}
    # A second line that is not there is no reason for doubt.
    assert not beyond_belief(finalist("mains_lines", second=(3e-5, 5e-4)))


@pytest.mark.parametrize(
    ("ends", "strange"),
    [((0.02, 0.1), False), ((0.4, 1.2), False), ((0.6, 1.6), True), ((0.001, 0.004), True)],
)
def test_only_what_lies_beyond_with_all_its_interval_is_strange(ends: tuple[float, float], strange: bool) -> None:
    one = finalist("deck_attachment", mass_kg=(900.0, 1100.0), loss_factor=ends)
    assert beyond_belief(cast(Any, one)) is strange
    # A coordinate may run the other way.
    one = finalist("deck_attachment", mass_kg=(900.0, 1100.0), loss_factor=ends[::-1])
    assert beyond_belief(cast(Any, one)) is strange
