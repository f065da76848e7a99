"""Posterior masses: of nothing missing, of names, and of what no catalogue holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from permway.diagnosis.verdict import NOVEL
from permway.posterior.beam import Member

CLASS = 0.95
"""Posterior mass that a class of names holds."""

COARSENED = 0.5
"""Power of the evidence in the posterior. The model's own idealisation errs on neighbouring lines alike, and the
likelihood counts each line anew. A posterior that allows for that has the evidence to a power below 1 (Miller and
Dunson 2019, J. Am. Stat. Assoc. 114, 1113-1125). Chosen on small campaigns: at 1 names are surer than they are
true, at 0.25 weak effects are no longer found."""

SHOWN = 1e-3
"""Smallest probability that a class shows."""


@dataclass(frozen=True)
class Masses:
    """What the records say of a set of fitted members.

    Attributes
    ----------
    members : tuple of Member
        The most probable first.
    probability : ndarray, shape (members,)
        Of each, that it holds and nothing else is missing; it sums to 1 with `novel`.
    novel : float
        Posterior probability that something of no catalogue acts, beside a member or alone.
    """

    members: tuple[Member, ...]
    probability: np.ndarray
    novel: float

    @staticmethod
    def of(members: Sequence[Member]) -> Masses:
        """From members with their prior and their evidence."""
        ordered = sorted(members, key=_coarse, reverse=True)
        log = np.array([_coarse(m) for m in ordered])
        whole = np.exp(log - log.max())
        whole /= whole.sum()
        novel = np.array([m.fit.hyper.novel for m in ordered])
        return Masses(tuple(ordered), whole * (1.0 - novel), float((whole * novel).sum()))

    @property
    def nothing(self) -> float:
        """Probability that the nominal model, recalibrated, lacks nothing."""
        empty = [p for m, p in zip(self.members, self.probability, strict=True) if not m.amendments]
        return float(sum(empty))

    @property
    def empty(self) -> Member:
        """The nominal model, recalibrated."""
        return next(m for m in self.members if not m.amendments)

    @property
    def best(self) -> Member:
        """The most probable set, whatever it lacks."""
        return self.members[0]

    def names(self, index: int) -> list[tuple[str, float]]:
        """Names that one amendment of the best set may have, the others of the set as they are; they sum to 1.

        Those of other sets with as many amendments of which all others bear the same names.
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
        return sorted([one for one in found.items() if one[1] >= SHOWN], key=lambda one: -one[1])


def _coarse(member: Member) -> float:
    """Logarithm of a set's mass in the coarsened posterior, up to a constant of the records."""
    return member.log_prior + COARSENED * member.fit.log_evidence
