"""What the catalogue says that a parameter may plausibly be, the search can reach."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from permway.diagnosis.catalogue import entries
from permway.diagnosis.fit import Free
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.separability import places
from simulated import simulate
from simulated_train import measured, tables, written

RANGE = re.compile(r"[^,]*, ([-\d.e]+) to ([-\d.e]+)(?=:|$)")
"""A parameter's unit, and from what to what it may be, as `PARAMETERS` of an entry has it."""

ROUNDED = 0.03
"""Of the whole range, in logarithms where it lies above zero."""


def situations(folder: Path) -> Iterator[Situation]:
    """A hammer test, and a train on a rough rail."""
    hammer = recalibrate(gather(simulate(folder / "hammer", 3).campaign, threads=1))
    yield Situation(hammer, tuple(places(hammer)))
    train = written(folder / "train", *tables(cold=True))
    yield Situation(recalibrate(gather(train, measured(train, 1), threads=1)), ())


def plausible(entry: str) -> dict[str, tuple[float, float]]:
    """Lowest and highest plausible value by parameter, for those that have such."""
    matched = {name: RANGE.match(text) for name, text in entries()[entry].PARAMETERS.items()}
    return {name: (float(m[1]), float(m[2])) for name, m in matched.items() if m is not None}


def beyond(free: Free, low: float, high: float) -> float:
    """How far what is plausible goes beyond what can be reached, in shares of the range."""
    reached = sorted(free.value(end) for end in free.limits)
    stated = np.array([low, high])
    if low > 0.0:
        reached, stated = list(np.log(reached)), np.log(stated)
    return float(max(reached[0] - stated[0], stated[1] - reached[1]) / np.ptp(stated))


def test_what_is_plausible_can_be_reached(tmp_path: Path) -> None:
    checked = set()
    for situation in situations(tmp_path):
        for name, entry in entries().items():
            for hypothesis in entry.hypotheses(situation):
                for free in hypothesis.free:
                    if free.name in plausible(name):
                        low, high = plausible(name)[free.name]
                        assert beyond(free, low, high) < ROUNDED, (name, free.name, free.limits)
                        checked.add((name, free.name))
    assert len(checked) > 50
    assert len({name for name, _ in checked}) > 25
