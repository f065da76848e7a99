"""What the sensors of a campaign can tell apart, before what they read is looked at.

Every effect of the catalogue is put into the owner's model at the size it starts from; what it does to the
records, with all that recalibration and smooth errors could do taken out, is held against what every other effect
could do at any size. Measured values play no part: only where, what and how well was measured.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.campaign.predict import predict
from permway.diagnosis.catalogue import hypotheses
from permway.diagnosis.clock import Progress
from permway.diagnosis.compete import Ring
from permway.diagnosis.decide import CLASS_DEVIANCE
from permway.diagnosis.gather import gather, predictable
from permway.diagnosis.hypothesis import Hypothesis, Situation
from permway.diagnosis.locate import unseen
from permway.diagnosis.refit import untouched
from permway.diagnosis.side_by_side import one_thread_of_blas
from permway.errors import InputError


@dataclass(frozen=True)
class Separability:
    """Expected deviances between effects.

    Attributes
    ----------
    names : tuple of str
        Effect and place of every hypothesis.
    entries, families : tuple of str
    size : tuple of str
        At which each was put in, in words.
    seen : ndarray, shape (H,)
        Deviance from the best recalibrated base: below about 15 there is not enough information.
    apart : ndarray, shape (H, H)
        Deviance of effect i from the best that effect j could do.
    """

    names: tuple[str, ...]
    entries: tuple[str, ...]
    families: tuple[str, ...]
    size: tuple[str, ...]
    seen: Reals
    apart: Reals

    def twins(self) -> list[tuple[str, str, float]]:
        """Pairs of different effects that are seen and cannot be told apart, with their deviance."""
        found: dict[tuple[str, str], float] = {}
        count = len(self.names)
        for i in range(count):
            for j in range(count):
                one, other = self.entries[i], self.entries[j]
                if one == other or self.seen[i] < CLASS_DEVIANCE or self.apart[i, j] >= CLASS_DEVIANCE:
                    continue
                key = (min(one, other), max(one, other))
                found[key] = min(found.get(key, np.inf), float(self.apart[i, j]))
        return [(a, b, value) for (a, b), value in sorted(found.items(), key=lambda item: item[1])]

    def summary(self) -> dict[str, object]:
        """For people and machines."""
        best: dict[str, int] = {}
        for i, entry in enumerate(self.entries):
            if entry not in best or self.seen[i] > self.seen[best[entry]]:
                best[entry] = i
        return {
            "effects": [
                {"effect": e, "at": self.names[i], "size": self.size[i], "deviance": round(float(self.seen[i]), 1)}
                for e, i in sorted(best.items(), key=lambda item: -self.seen[item[1]])
            ],
            "not told apart": [{"one": a, "other": b, "deviance": round(v, 1)} for a, b, v in self.twins()],
        }


@one_thread_of_blas()
def separability(
    campaign: Campaign, *, threads: int | None = None, progress: Progress | None = None
) -> Separability:
    """What a campaign's records could tell apart.

    Parameters
    ----------
    campaign : Campaign
        Its records are read for their frequencies, averages and coherence.
    threads : int, optional
    progress : callable, optional

    Raises
    ------
    InputError
        If no record can be predicted, or a file cannot be read.
    """
    say = progress or (lambda stage, done, total: None)
    say("read", 0, 0)
    datasets = predictable(campaign).kept
    datasets = [
        replace(dataset, data=dataset.data.assign({name: right[name] for name in right.data_vars}))
        for dataset, right in zip(datasets, predict(campaign, datasets, threads=threads), strict=True)
    ]
    fit = untouched(gather(campaign, datasets, threads=threads))
    ring = Ring(fit)
    offered = list(hypotheses(Situation(fit, tuple(unseen(fit)))))
    kept: list[tuple[Hypothesis, Reals, Reals, Reals]] = []
    for index, hypothesis in enumerate(offered):
        say("effects", index, len(offered))
        tried = ring.effect(hypothesis)
        if tried is not None:
            kept.append((hypothesis, *tried))
    say("compare", 0, 0)
    if not kept:
        raise InputError("no effect of the catalogue can be in this model", where="model")
    directions = np.column_stack([d for _, _, d, _ in kept])
    seen = np.maximum(np.diag(ring.projected(directions, directions)), 0.0)
    apart = np.zeros((len(kept), len(kept)))
    for j, (_, _, direction, slopes) in enumerate(kept):
        # At any size of its own, and at any near values.
        columns = np.column_stack([direction, slopes])
        inner = ring.projected(columns, columns) + np.eye(columns.shape[1])
        across = ring.projected(directions, columns)
        explained = np.einsum("ip,pi->i", across, linalg.solve(inner, across.T, assume_a="pos"))
        apart[:, j] = np.maximum(seen - explained, 0.0)
    values = [{f.name: f.value(float(v)) for f, v in zip(h.free, z, strict=True)} for h, z, _, _ in kept]
    return Separability(
        names=tuple(
            f"{h.entry} {h.locate(v).label}".strip() for (h, _, _, _), v in zip(kept, values, strict=True)
        ),
        entries=tuple(h.entry for h, _, _, _ in kept),
        families=tuple(h.family for h, _, _, _ in kept),
        size=tuple(h.law(v) for (h, _, _, _), v in zip(kept, values, strict=True)),
        seen=seen,
        apart=apart,
    )
