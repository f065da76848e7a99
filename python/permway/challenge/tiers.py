"""The number of a tier, from which the seeds of its campaigns and of its part of a suite follow."""

from __future__ import annotations

import hashlib

NUMBERS: dict[str, int] = {
    "null": 0,
    "single": 1,
    "twin": 2,
    "multiple": 3,
    "outside": 4,
    "nonlinear": 5,
    "graded": 6,
    "sparse": 7,
    "running": 8,
}
"""Numbers that are fixed by hand; a tier that is not here has the number of its name.

To change one is to draw every campaign of the tier anew.
"""

HASHED = 1000, 10000
"""From where and below where the numbers of names lie.

The lower end keeps clear of `NUMBERS`. The upper keeps a suite's seeds below ten million more than its own; of
two tiers one in 9000 pairs would share a number, twice as many pairs at half the range, half as many at double.
"""


def number_of(tier: str) -> int:
    """The number that stands for a tier in seeds: it depends on the tier's name alone.

    Parameters
    ----------
    tier : str
        Its name; any is taken.
    """
    if tier in NUMBERS:
        return NUMBERS[tier]
    first, end = HASHED
    return first + int.from_bytes(hashlib.sha256(tier.encode()).digest()[:8]) % (end - first)
