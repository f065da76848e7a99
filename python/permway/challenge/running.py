"""A line on which trains truly run: five short spans that repeat, and dashpots for what layers lose."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from permway.challenge.layout import Layout, Tests

SPANS = 5

SPAN_M = (12.0, 14.5)
"""Short, so that five of them are no longer than two of the usual."""

SPACINGS_M = (0.60, 0.65)
"""Of which a hundred and one bays end five spans on whole centimetres."""

SECONDS = 32.0

VISCOUS_AT_HZ = {"pad": 80.0, "mortar": 80.0, "sliding": 80.0, "bearing": 30.0}
"""Where layers lose what the sheet states: in proportion to frequency, as what is marched in time must."""


def running_layout(random: np.random.Generator) -> Layout:
    """Five spans, whose piers lie between stations."""
    spacing = float(random.choice(SPACINGS_M))
    bays = SPANS * round(float(random.uniform(*SPAN_M)) / spacing) + 1
    return Layout(SPANS, bays, spacing, approach_bays=int(random.integers(28, 34)))


def with_dashpots(values: Mapping[str, Mapping[str, float]]) -> dict[str, dict[str, float]]:
    """The same values of layers that lose by viscosity."""
    return {
        name: {**table, **({"viscous_at_Hz": VISCOUS_AT_HZ[name]} if name in VISCOUS_AT_HZ else {})}
        for name, table in values.items()
    }


def running_tests(tests: Tests, layout: Layout, speed_factor: tuple[float, ...]) -> Tests:
    """Shorter runs, at speeds next to those drawn of which a record holds a whole number of laps.

    Parameters
    ----------
    tests : Tests
    layout : Layout
    speed_factor : tuple of float
        True speeds over those written down.
    """
    lap = layout.length_m / SECONDS
    true = [lap * round(v / 3.6 * factor / lap) for v, factor in zip(tests.speeds_kmh, speed_factor, strict=True)]
    written = tuple(round(3.6 * v / factor, 3) for v, factor in zip(true, speed_factor, strict=True))
    return replace(tests, seconds=SECONDS, speeds_kmh=written)
