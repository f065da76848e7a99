"""What simpler methods would say of a campaign: rivals that a challenge holds the diagnosis against.

They have the same model, the same parameters to recalibrate and the same catalogue. What they lack is a guard:
errors that are smooth in frequency, a gain that must hold on records not fitted, a threshold from nulls.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from permway.diagnosis.blocks import Block
from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.catalogue import hypotheses
from permway.diagnosis.choose import lines
from permway.diagnosis.classifier import Classifier
from permway.diagnosis.compete import Ring
from permway.diagnosis.discrepancy import Discrepancy, discrepancy
from permway.diagnosis.evidence import Evidence
from permway.diagnosis.gather import gather, predictable
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.locate import scanned
from permway.diagnosis.quick import Quick
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.verdict import NOVEL
from permway.recordings.campaign import Campaign, read_campaign

NONE = 1e-6
"""Size of smooth errors of a method that knows of none, neper."""

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
        `status`, `effects` and `held_out` as a verdict has them; nothing is held out.

    Raises
    ------
    InputError
        If no record can be predicted.
    """
    evidence = independent(gather(campaign, predictable(campaign).kept, threads=threads))
    fit = replace(recalibrate(evidence, learn=False, reweigh=True), heat=1.0)
    ring = Ring(fit)
    offered = list(hypotheses(Situation(fit, scanned(fit)), ruled_out))
    screened: list[Quick] = []
    for index, hypothesis in enumerate(offered):
        if progress is not None:
            progress("rivals", index, len(offered))
        found = ring.screen(hypothesis)
        if np.isfinite(found.gain):
            screened.append(found)
    count = float(np.log(lines(fit)))
    best = max(screened, key=lambda q: q.gain)
    by_bic = max(screened, key=lambda q: q.gain - count * len(q.hypothesis.free))
    missing = by_bic.gain > count * len(by_bic.hypothesis.free)
    text = f"{seed} {campaign.said.title}".encode()
    random = np.random.default_rng(int.from_bytes(hashlib.sha256(text).digest()[:8], "big"))
    drawn = screened[int(random.integers(len(screened)))]
    quicks = (None, best, by_bic if missing else None, drawn if random.random() < CALLED else None)
    learnt = Classifier(ring, screened, seed=seed, threads=threads).answer(fit.deviations)
    answers = [*(_answer(quick) for quick in quicks), _of_process(discrepancy(fit)), _answer(learnt)]
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


def _answer(quick: Quick | None) -> Answer:
    if quick is None:
        return {"status": "recalibrated", "effects": [], "held_out": {}}
    hypothesis, values = quick.hypothesis, quick.values
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
        "held_out": {},
    }


def _of_process(found: Discrepancy) -> Answer:
    """What a Gaussian process says: that something is missing, and near which sensor; not what."""
    if found.gain <= 0.0:
        return {"status": "recalibrated", "effects": [], "held_out": {}}
    effect = {
        "domain": "path" if found.sensor.body is not None else "vehicle",
        "name": None,
        "class": [{"name": NOVEL, "probability": 1.0}],
        "place": found.place,
        "parameters": {},
    }
    return {"status": "located", "effects": [effect], "held_out": {}}


def _parameters(values: Mapping[str, float]) -> dict[str, Any]:
    """Without intervals, which these methods have none of."""
    return {name: {"value": value, "low": None, "high": None} for name, value in values.items()}
