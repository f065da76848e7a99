"""Posterior masses: of nothing missing, of names, and of what no catalogue holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from permway.diagnosis.verdict import NOVEL
from permway.posterior.member import Member, tempered

CLASS = 0.95
"""Posterior mass that a class of names holds."""

LIKELY = 0.5
"""Posterior probability from which nothing is called missing, or something of no catalogue."""

ALIKE = 2_000
"""Residuals from which the model's own idealisation shows between sets with amendments: see
:data:`permway.posterior.member.IDEALISED`, ten times as many, for sets differ less from each other than from
nothing."""

SHOWN = 1e-3
"""Smallest probability that a class shows."""


@dataclass(frozen=True)
class Masses:
    """What the records say of a set of fitted members.

    Attributes
    ----------
    members : tuple of Member
        Sets with amendments, the most probable first, then the empty one.
    nothing : float
        Posterior probability that the nominal model, recalibrated, lacks nothing.
    unamended : float
        The same, or that it lacks what no set describes.
    far_behind : tuple of Member
        The best sets of sizes of which none is near the best: they count in no probability.
    """

    members: tuple[Member, ...]
    nothing: float
    unamended: float
    far_behind: tuple[Member, ...] = ()

    @staticmethod
    def of(members: Sequence[Member]) -> Masses:
        """From members with their prior and their evidence; one of them is the empty set."""
        behind = tuple(m for m in members if m.far_behind)
        members = [m for m in members if not m.far_behind]
        log = np.array([m.log_mass for m in members])
        whole = np.exp(log - log.max())
        share = float(whole[[not m.amendments for m in members]].sum() / whole.sum())
        ordered = sorted(members, key=lambda m: (bool(m.amendments), _coarse(m)), reverse=True)
        return Masses(tuple(ordered), share * (1.0 - ordered[-1].fit.hyper.novel), share, behind)

    @property
    def empty(self) -> Member:
        """The nominal model, recalibrated."""
        return self.members[-1]

    @property
    def best(self) -> Member:
        """The empty set if it is more probable than all others together; else the most probable of those."""
        return self.empty if self.unamended >= LIKELY else self.members[0]

    def names(self, index: int) -> list[tuple[str, float]]:
        """Names that one amendment of the best set may have, the others of the set as they are.

        Those of other sets with as many amendments of which all others bear the same names. They sum to the
        probability that something is missing.
        """
        best = self.best
        others = sorted(a.entry for i, a in enumerate(best.amendments) if i != index)
        weight: dict[str, float] = {}
        for member in self.members:
            if len(member.amendments) != len(best.amendments):
                continue
            mass = float(np.exp(_coarse(member) - _coarse(best))) * (1.0 - member.fit.hyper.novel)
            for place, amendment in enumerate(member.amendments):
                rest = sorted(a.entry for i, a in enumerate(member.amendments) if i != place)
                if rest == others:
                    weight[amendment.entry] = weight.get(amendment.entry, 0.0) + mass
                    break
        known = sum(weight.values())
        # What lacks something may be something else altogether.
        novel = best.fit.hyper.novel
        found = {name: (1.0 - novel) * w / known for name, w in weight.items()} if known > 0.0 else {}
        found[NOVEL] = found.get(NOVEL, 0.0) + (novel if found else 1.0)
        missing = 1.0 - self.nothing
        return sorted([(n, missing * p) for n, p in found.items() if p >= SHOWN], key=lambda one: -one[1])


def _coarse(member: Member) -> float:
    """Logarithm of a set's mass by which names are weighed, up to a constant of the records."""
    return member.log_prior + tempered(member.fit.log_evidence, member.fit.state.residuals.size, ALIKE)
