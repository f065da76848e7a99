"""What else may be what a set of amendments was fitted with: other forms begun at the same place and frequency.

A narrow resonance shows only near its own frequency, which a look at a few does not meet. Once one form has been
fitted there, all others with a frequency, a loss factor or a place are looked at with the same.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from permway.posterior.cells import Cell, coordinate
from permway.posterior.fit import Model, extended
from permway.posterior.fitter import Fitter
from permway.posterior.member import Member

FAR = 3.0
"""Standard deviations from the middle of its prior, beyond which a value is another hypothesis's."""


def without_each(fitter: Fitter, member: Member, nominal: Model) -> Iterator[tuple[int, Member]]:
    """A set without each of its amendments in turn, all else as it is and not fitted again."""
    fit, campaign = member.fit, fitter.frame.observations.campaign
    for index in range(len(member.amendments)):
        kept = [i for i in range(len(member.amendments)) if i != index]
        model, columns = nominal, [np.arange(len(nominal.free))]
        for number, i in enumerate(kept, start=1):
            model = extended(model, member.amendments[i], f"{number}.", campaign)
            columns.append(np.arange(member.own(i).start, member.own(i).stop))
        own = np.concatenate(columns)
        left = fitter.begin(model, fit.z[own], fit.hyper, fit.jacobian[:, own], fit.bend)
        amendments = tuple(member.amendments[i] for i in kept)
        yield index, Member(amendments, left, tuple(member.log_priors[i] for i in kept))


def alternatives(found: Member, index: int, starts: Sequence[Cell], *, sized: bool = False) -> list[Cell]:
    """Starts of other forms than one amendment of a set, with its values where parameters have the same name.

    Of an amendment of a whole part of the line, as a law, those of the same part, too.

    Parameters
    ----------
    found : Member
    index : int
        Of the amendment.
    starts : sequence of Cell
        Of all hypotheses.
    sized : bool
        Whether the size is shared, too: then of forms that have the same, each once.
    """
    last = found.amendments[index]
    units = {free.name: free.unit for free in last.free}
    values = found.values(index)
    part = last.locate(values)
    whole = not sized and bool(part.what) and part.x_m is None
    moved: dict[tuple[object, ...], Cell] = {}
    for cell in starts:
        hypothesis = cell.hypothesis
        if hypothesis.form == last.form or (sized and hypothesis.size != last.size):
            continue
        z, shared = cell.z.copy(), set()
        for place, free in enumerate(hypothesis.free):
            if (sized or free.name != hypothesis.size) and units.get(free.name) == free.unit:
                own = coordinate(free, values[free.name])
                if own is not None and abs(own) < FAR:
                    z[place] = own
                    shared.add(free.name)
        other = replace(cell, z=z)
        same_part = whole and hypothesis.locate(other.values) == part
        if same_part or (shared and (not sized or hypothesis.size in shared)):
            rest = tuple(round(float(v), 6) for v in other.values.values())
            where = hypothesis.locate(other.values)
            key = (hypothesis.form, rest, where.what, where.x_m) if sized else (len(moved),)
            moved.setdefault(key, other)
    return list(moved.values())


def rivals(leader: Member, tried: Sequence[Member]) -> list[Cell]:
    """What sets that were tried have last, as fitted there: the best of each effect, of forms not in the leader.

    Parameters
    ----------
    leader : Member
    tried : sequence of Member
    """
    held, best = {amendment.form for amendment in leader.amendments}, dict[str, Cell]()
    for cell in [member.last for member in sorted(tried, key=lambda m: -m.log_mass)]:
        if cell.hypothesis.form not in held:
            best.setdefault(cell.hypothesis.entry, cell)
    return list(best.values())
