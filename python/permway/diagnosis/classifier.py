"""A classifier trained on simulated campaigns: a rival of the diagnosis that learns what effects look like.

For each effect of the catalogue, and for none, deviations are simulated about the recalibrated base: what the
effect does there to first order, at a size of its own, smooth errors of every chain, noise of every line, and what
recalibration takes away again. Trees boosted by their gradient (Friedman, Ann. Statist. 29, 2001) learn from means
and mean squares by sensor and octave which effect it was. Needs scikit-learn (`pip install permway[challenge]`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import linalg
from threadpoolctl import threadpool_limits

from permway.arrays import Reals
from permway.diagnosis.compete import Ring
from permway.diagnosis.fit import Fit
from permway.diagnosis.quick import Quick
from permway.diagnosis.whitener import Whitener
from permway.errors import InputError

PER_EFFECT, NONE_MORE = 40, 5
"""Simulations of each effect, and how many times as many of none."""

SMALLEST, LARGEST = 0.2, 2.0
"""Size of an effect, over that which it is screened at."""

CHAIN = 0.1
"""Size of simulated smooth errors, neper or rad: the middle of what chains have."""

TREES, LEAVES = 40, 8
"""Rounds of boosting, and leaves of a tree."""

NOTHING = ""


class Classifier:
    """Trained for one base: what deviations there are taken for.

    Parameters
    ----------
    ring : Ring
        Of the base, recalibrated on records whose errors are independent.
    screened : sequence of Quick
        Everything that was screened about the base, with what each does to the deviations.
    seed : int
    threads : int, optional
        Of the training; by default all processors.

    Raises
    ------
    InputError
        Without scikit-learn.
    """

    def __init__(
        self, ring: Ring, screened: Sequence[Quick], *, seed: int = 0, threads: int | None = None
    ) -> None:
        try:
            from sklearn.ensemble import HistGradientBoostingClassifier
        except ImportError as error:
            raise InputError(
                "is not installed", where="scikit-learn", remedy="pip install 'permway[challenge]'"
            ) from error
        self.known: dict[str, list[Quick]] = {}
        for quick in screened:
            if quick.direction is not None:
                self.known.setdefault(quick.hypothesis.entry, []).append(quick)
        self._sums, self._simulated = _Sums(ring.fit), _Simulated(ring)
        random = np.random.default_rng(seed)
        names = [NOTHING] * (NONE_MORE * PER_EFFECT) + [name for name in self.known for _ in range(PER_EFFECT)]
        features = [self._sums.of(self.simulate(name, random)) for name in names]
        self._trees = HistGradientBoostingClassifier(max_iter=TREES, max_leaf_nodes=LEAVES, random_state=seed)
        # Beside other work many threads wait for each other longer than they work.
        with threadpool_limits(threads, "openmp"):
            self._trees.fit(np.array(features), np.array(names))

    def simulate(self, name: str, random: np.random.Generator) -> Reals:
        """Deviations of a campaign with an effect, at some place and of some size, or with nothing missing."""
        made = self._simulated.nothing(random)
        if name == NOTHING:
            return made
        quick = self.known[name][int(random.integers(len(self.known[name])))]
        size = float(np.exp(random.uniform(np.log(SMALLEST), np.log(LARGEST))))
        return made + size * self._simulated.recalibrated(np.asarray(quick.direction, dtype=np.float64))

    def says(self, deviations: Reals) -> str:
        """The effect that deviations, shape (n,), are taken for; "" for none."""
        return str(self._trees.predict(self._sums.of(deviations)[None])[0])

    def answer(self, deviations: Reals) -> Quick | None:
        """The same, with its place: of all hypotheses of the effect the one that gains most."""
        said = self.says(deviations)
        return max(self.known[said], key=lambda quick: quick.gain) if said != NOTHING else None


class _Simulated:
    """Deviations of campaigns with nothing missing, recalibrated to first order."""

    def __init__(self, ring: Ring) -> None:
        evidence = ring.evidence
        origins = evidence.columns.origins
        sizes = {o.name: evidence.sizes[o.name] if o.fixed else CHAIN for o in origins}
        self.whitener = Whitener.of(evidence.columns, sizes, evidence.length)
        self.ring, self.count = ring, ring.fit.deviations.size
        self.coefficients = self.whitener.count

    def nothing(self, random: np.random.Generator) -> Reals:
        """Smooth errors and noise."""
        smooth = self.whitener.smooth(np.asarray(random.standard_normal(self.coefficients)), self.count)
        return self.recalibrated(np.asarray(smooth + random.standard_normal(self.count)))

    def recalibrated(self, deviations: Reals) -> Reals:
        """What no move of the base takes away."""
        jacobian = self.ring.fit.jacobian
        moved = linalg.cho_solve(self.ring.factor, jacobian.T @ deviations / self.ring.fit.heat)
        return np.asarray(deviations - jacobian @ moved)


class _Sums:
    """Means and logarithms of mean squares, by sensor, part of its rows and octave."""

    def __init__(self, fit: Fit) -> None:
        rows = fit.evidence.rows
        octave = np.floor(np.log2(rows.frequency_Hz)).astype(int)
        keys = [f"{block} {s} {o}" for block, s, o in zip(fit.evidence.block_of, rows.sensor, octave, strict=True)]
        _, group = np.unique(keys, return_inverse=True)
        self.order = np.argsort(group, kind="stable")
        self.starts = np.flatnonzero(np.diff(group[self.order], prepend=-1))
        self.counts = np.diff(np.append(self.starts, group.size))

    def of(self, deviations: Reals) -> Reals:
        """Two numbers a group."""
        ordered = deviations[self.order]
        mean = np.add.reduceat(ordered, self.starts) / self.counts
        square = np.add.reduceat(ordered**2, self.starts) / self.counts
        return np.concatenate([mean, np.log(square + 1e-12)])
