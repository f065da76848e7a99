"""What simpler methods would say of a campaign: rivals that a challenge holds the diagnosis against.

They have the same model, the same parameters to recalibrate, the same catalogue and the same search through it.
What they lack is a guard: errors that are smooth in frequency, a gain that must hold on records not fitted, a
threshold from nulls.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from permway.campaign.campaign import Campaign, read_campaign
from permway.diagnosis.bases import bases
from permway.diagnosis.blocks import Block
from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.catalogue import hypotheses
from permway.diagnosis.choose import FOLLOWED, finalists_of, penalty
from permway.diagnosis.classifier import Classifier
from permway.diagnosis.clock import Clock
from permway.diagnosis.compete import Ring
from permway.diagnosis.discrepancy import Discrepancy, discrepancy
from permway.diagnosis.evidence import Evidence
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather, predictable
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.locate import scanned
from permway.diagnosis.looked import looked
from permway.diagnosis.quick import Quick
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.rivals_held_out import MOST_STEPS, LeftOut
from permway.diagnosis.side_by_side import one_thread_of_blas
from permway.diagnosis.verdict import NOVEL
from permway.errors import InputError, SolveError

NONE = 1e-6
"""Size of smooth errors of a method that knows of none, neper."""

PREFIX = "rival."
"""Of what is named, among the parameters of a fit in full."""

CALLED = 0.5
"""How often a random answer calls something missing."""

RIVALS = (
    "recalibration only",
    "smallest residual",
    "BIC, independent errors",
    "random answers",
    "Gaussian process",
    "classifier",
)

Progress = Callable[[str, int, int], object]
Answer = dict[str, Any]
"""The keys of a verdict that a score reads."""


@one_thread_of_blas()
def rivals(
    campaign: Campaign,
    *,
    seed: int = 0,
    ruled_out: Collection[str] = (),
    threads: int | None = None,
    progress: Progress | None = None,
) -> dict[str, Answer]:
    """What each rival says of a campaign.

    Parameters
    ----------
    campaign : Campaign
    seed : int
        Of random answers, together with the campaign's title.
    ruled_out : collection of str
        Effects of the catalogue that cannot be.
    threads : int, optional
        Of the solver.
    progress : callable, optional

    Returns
    -------
    dict of rival to dict
        `status`, `effects` and `held_out` as a verdict has them.

    Raises
    ------
    InputError
        If no record can be predicted.
    """
    evidence = gather(campaign, predictable(campaign).kept, threads=threads)
    left_out = LeftOut(bases(evidence, Clock(None))[0])
    fit = replace(recalibrate(independent(evidence), learn=False, reweigh=True), heat=1.0)
    ring = Ring(fit)
    offered = list(hypotheses(Situation(fit, scanned(fit)), ruled_out))
    screened, followed = looked(ring, offered, (), FOLLOWED, progress or _silent)
    fitted = [_fitted(ring, one) for one in finalists_of(followed, ring, -np.inf) or screened[:1]]
    best = min(fitted, key=lambda one: one.objective)
    by_bic = min(fitted, key=lambda one: one.objective + penalty(one.quick, ring))
    missing = by_bic.objective + penalty(by_bic.quick, ring) < fit.objective
    text = f"{seed} {campaign.stated.title}".encode()
    random = np.random.default_rng(int.from_bytes(hashlib.sha256(text).digest()[:8], "big"))
    drawn = screened[int(random.integers(len(screened)))]
    by_chance = _fitted(ring, drawn) if random.random() < CALLED else None
    said = Classifier(ring, screened, seed=seed, threads=threads).answer(fit.deviations)
    learnt = None if said is None else _fitted(ring, said)
    named = (None, best, by_bic if missing else None, by_chance)
    answers = [_answer(one, left_out) for one in named]
    if missing and by_bic is best:
        answers[2] = answers[1]
    answers += [_of_process(discrepancy(fit), left_out), _answer(learnt, left_out)]
    return dict(zip(RIVALS, answers, strict=True))


def of_file(campaign: Path, ruled_out: Collection[str]) -> dict[str, Answer]:
    """The same of a campaign file, on one thread."""
    return rivals(read_campaign(campaign), ruled_out=ruled_out, threads=1)


def independent(evidence: Evidence) -> Evidence:
    """The same records with errors that know nothing of their neighbours in frequency."""
    blocks: list[Block] = [b.with_pair(NONE) if isinstance(b, FrfBlock) else b for b in evidence.blocks]
    fixed = {origin.name for origin in evidence.columns.origins if origin.fixed}
    sizes = {name: size if name in fixed else NONE for name, size in evidence.sizes.items()}
    return replace(evidence, blocks=tuple(blocks)).with_sizes(sizes)


@dataclass(frozen=True)
class _Fitted:
    """What is named, fitted together with the base; None where that cannot be solved."""

    quick: Quick
    fit: Fit | None

    @property
    def objective(self) -> float:
        return np.inf if self.fit is None else self.fit.objective


def _fitted(ring: Ring, quick: Quick) -> _Fitted:
    try:
        fit = replace(ring.full(quick, prefix=PREFIX, most_steps=MOST_STEPS), heat=1.0)
    except (InputError, SolveError):
        fit = None
    return _Fitted(quick, fit)


def _silent(*_: object) -> None:
    """Progress that nobody follows."""


def _answer(named: _Fitted | None, left_out: LeftOut) -> Answer:
    if named is None:
        return {"status": "recalibrated", "effects": [], "held_out": left_out.base()}
    hypothesis, values = named.quick.hypothesis, named.quick.values
    if named.fit is not None:
        known = named.fit.values()
        values = {name: known[PREFIX + name] for name in values}
    where = hypothesis.locate(values)
    return {
        "status": "measurement" if hypothesis.domain == "measurement" else "named",
        "effects": [
            {
                "domain": hypothesis.domain,
                "name": hypothesis.entry,
                "class": [{"name": hypothesis.entry, "probability": 1.0}],
                "place": {"x": where.x_m, "channels": list(where.channels)},
                "parameters": _parameters(values),
            }
        ],
        "held_out": {} if named.fit is None else left_out.amended(named.fit),
    }


def _of_process(found: Discrepancy, left_out: LeftOut) -> Answer:
    """What a Gaussian process says: that something is missing, and near which sensor; not what."""
    if found.gain <= 0.0:
        return {"status": "recalibrated", "effects": [], "held_out": left_out.base()}
    effect = {
        "domain": "path" if found.sensor.body is not None else "vehicle",
        "name": None,
        "class": [{"name": NOVEL, "probability": 1.0}],
        "place": found.place,
        "parameters": {},
    }
    return {"status": "located", "effects": [effect], "held_out": left_out.with_discrepancy(found)}


def _parameters(values: Mapping[str, float]) -> dict[str, Any]:
    """Without intervals, which these methods have none of."""
    return {name: {"value": value, "low": None, "high": None} for name, value in values.items()}
