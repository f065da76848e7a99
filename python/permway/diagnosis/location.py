"""Places of the line at which an effect may be looked for, and the stretches that they lie in."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from permway.model.line import Line
from permway.model.segments import Segment

APART_M, FEWEST = 1.0, 8
"""Between places along a body, m: a third of what the priors of places span. And how many places a short one has,
so that its third bending shape is seen."""


@dataclass(frozen=True)
class Location:
    """A place at which an effect may be looked for.

    Attributes
    ----------
    kind : "joint" or "body"
    name : str
        Law of the joint, or segment of the body.
    x_m : float
    """

    kind: Literal["joint", "body"]
    name: str
    x_m: float


def stretches(line: Line) -> Iterator[tuple[Segment, float, float]]:
    """Each beam or shaft with the stretch of it that counts, from and to in m.

    A body with ends counts from end to end, wherever it is held; an endless one between the first and the last
    joint. One without either has no stretch.
    """
    x = line.joint_table().x
    first, last = (float(x.min()), float(x.max())) if x.size else (-np.inf, np.inf)
    for _, segment in line.beams():
        low = segment.start if np.isfinite(segment.start) else first
        high = segment.stop if np.isfinite(segment.stop) else last
        if low < high and np.isfinite([low, high]).all():
            yield segment, low, high


def step_m(length_m: float) -> float:
    """Distance between places at which a body of some length is looked at, m."""
    return min(APART_M, length_m / FEWEST)
