"""The sizes of smooth errors, and the length of those of chains, learnt about a prediction.

MacKay's fixed point (1992): a coefficient counts by as much as the records tell of it.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.campaign.compare import NEPER_DB
from permway.diagnosis.evidence import LARGEST_SMOOTH, SMALLEST_SMOOTH, Evidence, Solved
from permway.diagnosis.gather import first_size
from permway.diagnosis.wander import LENGTHS

USUAL, SEEN = 0.02, 4.0
"""Size of smooth errors that is expected beforehand, neper or rad, or as those of its kind have; and how many
coefficients it counts for."""

APART, FEWEST_ALIKE = 3.0, 4
"""Times the median of its kind that the size of an origin may be, and of how many that is told."""

LARGEST = {"irregularity": 1.5, "decay": 0.5}
"""Of origins by their first word, nepers of a power, where it is not that of a chain."""

TRUSTED = 1.2
"""Times what is said of what is known within so many dB: what differs by more is sought."""

LEARNING_STEPS = 5
"""Of the fixed point, each time."""


def learnt(evidence: Evidence, solved: Solved) -> tuple[Evidence, float]:
    """Learn the sizes of smooth errors, and the length of those of chains, about a prediction.

    Sizes by MacKay's fixed point (1992): a coefficient counts by as much as the records tell of it.

    Returns
    -------
    (Evidence, float)
        And the largest change of a size's logarithm.
    """
    before = evidence.sizes
    for step in range(LEARNING_STEPS):
        deviations = evidence.deviations(solved.datasets)
        if step == 0:
            evidence = _of_best_length(evidence, deviations)
        whitener = evidence.whitener
        coefficients, told = whitener.explained(deviations), 1.0 - whitener.variances()
        origin_of = whitener.of_origin()
        sizes, change = dict(evidence.sizes), 0.0
        usual = {kind: max(typical, USUAL) for kind, typical in _typical(evidence.sizes).items()}
        for index, origin in enumerate(whitener.columns.origins):
            if origin.fixed:
                continue
            mine, old = origin_of == index, evidence.sizes[origin.name]
            # As if so many more of the usual size had been seen: what does not fit is not all chain.
            power = float(np.sum(coefficients[mine] ** 2)) * old**2
            expected = SEEN * usual.get(_kind(origin.name), USUAL) ** 2
            new = float(np.sqrt((power + expected) / (told[mine].sum() + SEEN)))
            highest = _highest(evidence.campaign, origin.name)
            sizes[origin.name] = float(np.clip(new, SMALLEST_SMOOTH, highest))
        sizes = _alike(sizes)
        for origin in whitener.columns.origins:
            old = evidence.sizes[origin.name]
            change = max(change, abs(np.log(sizes[origin.name] / old)))
        clean = deviations - whitener.smooth(coefficients, deviations.size)
        evidence = evidence.with_sizes(sizes).learnt_scatter(solved.datasets, clean)
        if change < 0.1:
            break
    return evidence, max((abs(np.log(evidence.sizes[o] / size)) for o, size in before.items()), default=0.0)


def _highest(campaign: Campaign, origin: str) -> float:
    if origin == "irregularity" and campaign.stated.irregularity.knowledge == "within":
        return TRUSTED * first_size(campaign, origin)
    stated = {f"record {r.name}": r.within_dB for r in campaign.stated.records}.get(origin)
    if stated is not None:
        # Two standard deviations, of an amplitude.
        return float(TRUSTED * 0.5 * stated / NEPER_DB)
    return LARGEST.get(_kind(origin), LARGEST_SMOOTH)


def _alike(sizes: dict[str, float]) -> dict[str, float]:
    """Without one that is far larger than most of its kind: chains of a kind wander alike.

    What one channel is missed by beyond that is a fault of its own, or physics, and is sought.
    """
    most = {kind: max(APART * typical, USUAL) for kind, typical in _typical(sizes).items()}
    return {name: min(size, most.get(_kind(name), np.inf)) for name, size in sizes.items()}


def _typical(sizes: Mapping[str, float]) -> dict[str, float]:
    """Median size of each kind of origin that there are enough of."""
    kinds: dict[str, list[float]] = {}
    for name, size in sizes.items():
        kinds.setdefault(_kind(name), []).append(size)
    return {kind: float(np.median(found)) for kind, found in kinds.items() if len(found) >= FEWEST_ALIKE}


def _kind(origin: str) -> str:
    return origin.split()[0]


def _of_best_length(evidence: Evidence, deviations: Reals) -> Evidence:
    """Of the present length and its neighbours, the one under which the deviations are likeliest."""
    at = int(np.argmin(np.abs(np.log(np.array(LENGTHS) / evidence.length))))
    tried = [evidence.with_sizes(evidence.sizes, length) for length in LENGTHS[max(0, at - 1) : at + 2]]
    return min(tried, key=lambda e: e.whitener.square(deviations) + e.whitener.log_determinant)
