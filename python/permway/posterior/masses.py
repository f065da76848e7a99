"""Posterior masses: of nothing missing, of names, and of what no catalogue holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from permway.diagnosis.verdict import NOVEL
from permway.posterior.search import Member

CLASS = 0.95
"""Posterior mass that a class of names holds."""

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
        ordered = sorted(members, key=lambda m: -m.log_mass)
        log = np.array([m.log_mass for m in ordered])
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
            mass = float(np.exp(member.log_mass - best.log_mass)) * (1.0 - member.fit.hyper.novel)
            for place, amendment in enumerate(member.amendments):
                rest = sorted(a.entry for i, a in enumerate(member.amendments) if i != place)
                if rest == others:
                    weight[amendment.entry] = weight.get(amendment.entry, 0.0) + mass
                    break
        known = sum(weight.values())
        # What lacks something may be something else altogether.
        novel = best.fit.hyper.novel
        found = [(name, (1.0 - novel) * w / known) for name, w in weight.items()] if known > 0.0 else []
        found.append((NOVEL, novel if found else 1.0))
        return sorted([one for one in found if one[1] >= SHOWN], key=lambda one: -one[1])
