"""Few sensors, few blows, often one run: records that leave open which of two effects acts.

A team that begins with these is given what to measure next, and whether that helps can be seen.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from permway.challenge.layout import Tests

FEWEST, MOST = 2, 4
"""Sensors, and points, that are left."""

NOISE = 300.0
"""Times the noise of a clean hammer test at most, in amplitude, as often in any decade."""

ONE_RUN = 0.5
"""How often only one of two runs is made."""


def sparse(tests: Tests, random: np.random.Generator) -> Tests:
    """The same with a few of its sensors, points and runs, at one temperature; the rail is always struck and read.

    Parameters
    ----------
    tests : Tests
    random : Generator
    """

    def some(count: int) -> list[int]:
        left = int(random.integers(FEWEST, MOST + 1))
        return [0, *sorted(1 + int(i) for i in random.permutation(count - 1)[: left - 1])]

    runs = tests.speeds_kmh[:1] if random.random() < ONE_RUN else tests.speeds_kmh
    return replace(
        tests,
        sensors=tuple(tests.sensors[i] for i in some(len(tests.sensors))),
        points=tuple(tests.points[i] for i in some(len(tests.points))),
        temperatures_C=tests.temperatures_C[:1],
        speeds_kmh=runs,
    )
