"""A set of amendments with its fit, and what probability that gives it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from permway.diagnosis.hypothesis import Hypothesis
from permway.posterior.cells import SOMETHING, Cell
from permway.posterior.fit import Fit

IDEALISED = 20_000.0
"""Residuals from which the model's own idealisation shows. It errs on neighbouring lines and pairs alike, and the
likelihood counts each anew. A posterior that allows for that has the evidence of n residuals to the power
1 / (1 + n / a) (Miller and Dunson 2019, J. Am. Stat. Assoc. 114, 1113-1125): 0.9 of the 3,000 of a small campaign,
0.5 of the 20,000 that are weighed of a large one."""


def tempered(log_evidence: float, residuals: int, idealised: float = IDEALISED) -> float:
    """Logarithm of an evidence to the power that a model's idealisation leaves it."""
    return log_evidence / (1.0 + residuals / idealised)


@dataclass(frozen=True)
class Member:
    """A set of amendments with its fit.

    Attributes
    ----------
    amendments : tuple of Hypothesis
    fit : Fit
    log_priors : tuple of float
        Of each amendment, nats.
    far_behind : bool
        Whether it is kept only to be shown, as the best of its size.
    """

    amendments: tuple[Hypothesis, ...]
    fit: Fit
    log_priors: tuple[float, ...]
    far_behind: bool = False

    @property
    def log_prior(self) -> float:
        """Of the set, nats."""
        return float(np.log(1.0 - SOMETHING)) + sum(self.log_priors)

    @property
    def log_mass(self) -> float:
        """Logarithm of prior times tempered evidence, up to a constant of the records."""
        return self.log_prior + tempered(self.fit.log_evidence, self.fit.state.residuals.size)

    @property
    def names(self) -> tuple[str, ...]:
        """Entries of the catalogue, in alphabetical order."""
        return tuple(sorted(a.entry for a in self.amendments))

    @property
    def last(self) -> Cell:
        """Its last amendment as it is fitted."""
        return Cell(self.amendments[-1], self.fit.z[self.own(len(self.amendments) - 1)], self.log_priors[-1])

    def own(self, index: int) -> slice:
        """Where the parameters of one amendment stand among all."""
        counts = [len(a.free) for a in self.amendments]
        start = len(self.fit.model.free) - sum(counts) + sum(counts[:index])
        return slice(start, start + counts[index])

    def values(self, index: int) -> dict[str, float]:
        """Of one amendment's parameters, by name; where it moves a nominal parameter, the whole move."""
        free, z = self.amendments[index].free, self.fit.z[self.own(index)]
        found = {f.name: f.value(float(v)) for f, v in zip(free, z, strict=True)}
        at = self.moved(index)
        if at is not None:
            found[free[0].name] += float(self.fit.z[at])
        return found

    def moved(self, index: int) -> int | None:
        """Where the nominal parameter that an amendment moves stands among all; None if it moves none."""
        name = self.amendments[index].moves
        if not name:
            return None
        return [f.name for f in self.fit.model.free].index(name)
