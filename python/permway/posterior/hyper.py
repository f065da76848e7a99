"""What the likelihood does not know beforehand: sizes and length of calibration errors, and the discrepancy.

The same hyperpriors hold for every set of amendments, and every set is given its own most probable values: what is
estimated about the base alone would take an effect for an error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.blocks_passage import UNEVENNESS

SIZE, SIZE_FACTOR = 0.04, 3.0
"""Calibration errors, neper or rad: median (0.35 dB) and the factor of one standard deviation (0.12 to 1 dB)."""

STRAINED = SIZE * SIZE_FACTOR**1.5
"""Neper (1.8 dB): larger than errors of chains that were measured; what is missing may hide in such. Twice as much
leaves dampers hidden in errors of 2 to 4 dB; half as much looks farther in campaigns whose chains err by 1 dB."""

LENGTH, LENGTH_FACTOR = 0.8, 2.5
"""Their correlation length, octaves: median, and the factor of one standard deviation (0.32 to 2 octaves)."""

SHORTEST, LONGEST = 0.15, 4.0
"""Octaves: bounds of the length, as measured of real chains and of hammers that sit badly."""

EXACT, EXACT_FACTOR = 0.003, 3.0
"""Discrepancy of a model that lacks nothing, neper: median (0.026 dB), and the factor of one standard deviation.
Of 20 measured states that were recalibrated or rightly amended it is 0.001 to 0.019."""

IDEALISATION = "idealisation"

IDEAL, IDEAL_FACTOR = 0.0002, 2.0
"""Share by which the idealisation has a stiffness or a mass off, see :mod:`permway.posterior.idealised`: median,
and the factor of one standard deviation. In 50 campaigns with nothing missing it is 0.0001 to 0.0004."""

UNEVENNESS_FACTOR = 2.0
"""Of the forces by unevenness over those of the stated spectrum: the factor of one standard deviation about 1 (6
dB); neighbouring classes of the FRA's track are 1.1 to 2.5 apart. With half its logarithm a wrong spectrum is held
on to; with twice, what is missing passes for rough track more easily."""

COARSEST = 2.0
"""Neper: the largest discrepancy."""

NOVEL = 0.05
"""Prior probability that something of no catalogue acts: then the discrepancy is equally likely in its logarithm
from :data:`EXACT` to :data:`COARSEST`."""


LACKING = 0.5
"""Probability that a fit lacks something, from which large changes are tried and its errors are not relied on."""

STILL = 0.9
"""Share of a discrepancy from which as much is lacking as before: of three effects that do as much each, the first
leaves 0.82."""


@dataclass(frozen=True)
class Hyper:
    """Hyperparameters by their logarithms.

    Attributes
    ----------
    names : tuple of str
        Kinds of chains, "length", "discrepancy " of each statistic, "idealisation", and "unevenness" where axles
        meet one.
    log : ndarray, shape (h,)
    """

    names: tuple[str, ...]
    log: Reals

    @staticmethod
    def first(kinds: Sequence[str], statistics: Sequence[str], *, uneven: bool = False) -> Hyper:
        """The medians of the priors."""
        values = dict.fromkeys(kinds, SIZE)
        if kinds:
            values["length"] = LENGTH
        values |= {f"discrepancy {name}": EXACT for name in statistics}
        values[IDEALISATION] = IDEAL
        if uneven:
            values[UNEVENNESS] = 1.0
        return Hyper(tuple(values), np.log(np.array(list(values.values()))))

    def __getitem__(self, name: str) -> float:
        return float(np.exp(self.log[self.names.index(name)]))

    def discrepancy(self, statistic: str) -> float:
        """Of a statistic, neper."""
        return self[f"discrepancy {statistic}"]

    def with_discrepancy(self, value: float) -> Hyper:
        """The same with this discrepancy everywhere."""
        log = np.where([n.startswith("discrepancy") for n in self.names], np.log(value), self.log)
        return Hyper(self.names, log)

    def smaller(self) -> list[Hyper]:
        """One for each kind of chain, its errors smaller by the factor of a standard deviation of their size.

        Where errors of chains took up what is missing, they are smaller once that is modelled; so is the
        idealisation, which then is what it mostly is.
        """
        less = self.log - np.log(SIZE_FACTOR)
        found = [self.moved(np.where([n == kind for n in self.names], less, self.log)) for kind in self._kinds]
        if self[IDEALISATION] > IDEAL:
            found.append(self.moved(np.where([n == IDEALISATION for n in self.names], np.log(IDEAL), self.log)))
        return found

    def exact(self) -> Hyper:
        """The same of a model that lacks nothing."""
        return self.with_discrepancy(EXACT)

    def moved(self, log: Reals) -> Hyper:
        """With other logarithms, kept within the bounds."""
        low, high = self.bounds()
        return Hyper(self.names, np.clip(log, low, high))

    @property
    def strained(self) -> bool:
        """Whether errors of some kind of chain are larger than what is known of such."""
        return any(self[name] > STRAINED for name in self._kinds)

    @property
    def _kinds(self) -> list[str]:
        """Of chains."""
        others = ("length", IDEALISATION, UNEVENNESS)
        return [n for n in self.names if n not in others and not n.startswith("discrepancy")]

    def bounds(self) -> tuple[Reals, Reals]:
        """Of the logarithms."""
        ends = np.array([_bounds(name) for name in self.names]).reshape(-1, 2)
        return np.log(ends[:, 0]), np.log(ends[:, 1])

    @property
    def log_prior(self) -> float:
        """Density of the logarithms."""
        return float(sum(_log_prior(n, v) for n, v in zip(self.names, self.log, strict=True)))

    @property
    def lacks(self) -> float:
        """The largest discrepancy, neper."""
        logs = [v for n, v in zip(self.names, self.log, strict=True) if n.startswith("discrepancy")]
        return float(np.exp(max(logs)))

    @property
    def novel(self) -> float:
        """Probability that a discrepancy is more than that of an idealisation, given these values."""
        return 1.0 - float(np.prod([1.0 - p for p in self._each_novel.values()]))

    @property
    def _each_novel(self) -> dict[str, float]:
        """The same of each kind of record."""
        parts = {
            n: _components(v) for n, v in zip(self.names, self.log, strict=True) if n.startswith("discrepancy")
        }
        return {name: broad / (exact + broad) for name, (exact, broad) in parts.items()}

    def lacks_as(self, before: Hyper) -> bool:
        """Whether every kind of record that lacked something before still lacks as much."""
        lacking = [name for name, novel in before._each_novel.items() if novel > LACKING]
        return bool(lacking) and all(self[name] > STILL * before[name] for name in lacking)


def _bounds(name: str) -> tuple[float, float]:
    if name == "length":
        return SHORTEST, LONGEST
    if name == IDEALISATION:
        return 1e-5, 0.005
    if name == UNEVENNESS:
        return 0.02, 50.0
    return (1e-4, COARSEST) if name.startswith("discrepancy") else (1e-3, 0.5)


def _normal(log: float, median: float, factor: float) -> float:
    sigma = np.log(factor)
    return float(np.exp(-0.5 * ((log - np.log(median)) / sigma) ** 2) / (sigma * np.sqrt(2.0 * np.pi)))


def _components(log: float) -> tuple[float, float]:
    """Density of a discrepancy as an idealisation has it, and as something missing has it, each with its prior."""
    inside = np.log(EXACT) <= log <= np.log(COARSEST)
    broad = NOVEL / np.log(COARSEST / EXACT) if inside else 0.0
    return (1.0 - NOVEL) * _normal(log, EXACT, EXACT_FACTOR), broad


def _log_prior(name: str, log: float) -> float:
    if name == "length":
        return float(np.log(_normal(log, LENGTH, LENGTH_FACTOR)))
    if name == IDEALISATION:
        return float(np.log(_normal(log, IDEAL, IDEAL_FACTOR)))
    if name == UNEVENNESS:
        return float(np.log(_normal(log, 1.0, UNEVENNESS_FACTOR)))
    if name.startswith("discrepancy"):
        return float(np.log(sum(_components(log)) + 1e-300))
    return float(np.log(_normal(log, SIZE, SIZE_FACTOR)))
