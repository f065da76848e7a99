"""What else may be what a set of amendments was fitted with: other forms begun at the same place and frequency.

A sharp resonance shows only near its own frequency, which a look at a few does not meet. Once one form has been
fitted there, all others with a frequency, a loss factor or a place are looked at with the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from permway.posterior.beam import Member
from permway.posterior.cells import Cell, coordinate

FAR = 3.0
"""Standard deviations from the middle of its prior, beyond which a value is another hypothesis's."""


def alternatives(found: Member, starts: Sequence[Cell]) -> list[Cell]:
    """Starts of other forms than a set's last amendment, with its values where parameters have the same name.

    Parameters
    ----------
    found : Member
        Of one amendment at least.
    starts : sequence of Cell
        Of all hypotheses.
    """
    last = found.amendments[-1]
    units = {free.name: free.unit for free in last.free}
    values = found.values(len(found.amendments) - 1)
    moved = []
    for cell in starts:
        hypothesis = cell.hypothesis
        if hypothesis.form == last.form:
            continue
        z, shared = cell.z.copy(), False
        for index, free in enumerate(hypothesis.free):
            if free.name != hypothesis.size and units.get(free.name) == free.unit:
                own = coordinate(free, values[free.name])
                if own is not None and abs(own) < FAR:
                    z[index], shared = own, True
        if shared:
            moved.append(replace(cell, z=z))
    return moved
