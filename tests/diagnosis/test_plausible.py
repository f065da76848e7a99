"""Constants that no such thing has: the catalogue's ranges are read, and all of an interval has to lie beyond."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from permway.diagnosis.plausible import beyond_belief, plausible


def finalist(entry: str, **intervals: tuple[float, float]) -> Any:
    return SimpleNamespace(
        values={name: float(np.mean(ends)) for name, ends in intervals.items()},
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


def test_what_ends_where_its_range_does_would_go_on() -> None:
    """A springpot of the highest order is a dashpot, which has a name of its own."""
    assert beyond_belief(finalist("pad_frequency", order=(0.7998, 0.8001)))
    assert not beyond_belief(finalist("pad_frequency", order=(0.70, 0.78)))
    # All of the loss may go, and all of a stiffness be lost.
    assert not beyond_belief(finalist("layer_damping", share=(0.9999, 1.0001)))
    assert not beyond_belief(finalist("fastener_loss", factor=(-1e-6, 1e-6)))
