"""Places of the line at which an effect may be looked for, and the stretches that they lie in."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from permway.model.line import Line
from permway.model.segments import Segment


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

    An endless rail counts between the first and the last joint; a supported beam that nothing else holds, from end
    to end. A body without either has no stretch.
    """
    x = line.joint_table().x
    first, last = (float(x.min()), float(x.max())) if x.size else (-np.inf, np.inf)
    for _, segment in line.beams():
        low, high = max(segment.start, first), min(segment.stop, last)
        if low < high and np.isfinite([low, high]).all():
            yield segment, low, high
