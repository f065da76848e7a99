"""Runs whose lines scatter more than those of a steady process: impacts, or lines, that a model does not have.

By how much lines of a spectrum differ from their neighbours is learnt from the records: the level of a track
changes from place to place, and so its spectra scatter by 1.1 to 1.5 times what the averages of a steady record
would. What wheels leave that fly over welds, or joints that are not in the model, scatters by 2 to 6 times. Once
that is learnt a misfit of 1 says little, and whatever makes records less coherent gains: a slow clock, another
source.
"""

from __future__ import annotations

import numpy as np

from permway.diagnosis.blocks_spectra import SpectraBlock
from permway.diagnosis.decide import HALF
from permway.diagnosis.fit import Fit
from permway.diagnosis.verdict import NOVEL
from permway.diagnosis.verdict_parts import ClassMember, Effect, Mechanics, Place

STEADY = 3.0
"""Variance of lines, in that of a steady record's, up to which a track of changing level explains it (1.6 to 2.3
where amended models were right)."""


SEEN = 1.1
"""Mean square of the deviations of records that are no runs, from which they say that something is missing."""


def raggedness(run: SpectraBlock) -> float:
    """By how much lines of a run vary more than a steady record's: their variance, the mean of all parts."""
    return float(np.mean([size**2 for _, size in run.scatter]))


def unsteady_misfit(fit: Fit) -> float:
    """Mean square of the deviations, were lines to scatter no more than a track of changing level lets them."""
    return fit.heat * max([1.0, *(raggedness(run) / STEADY for run in _runs(fit))])


def explains_elsewhere(base: Fit, amended: Fit) -> bool:
    """Whether most of what the base lacks in records that are no runs is explained: runs have no part in that."""
    before, after = (_misfit_beside_runs(fit) for fit in (base, amended))
    return before > SEEN and after - 1.0 < HALF * (before - 1.0)


def unexplained_lines(fit: Fit) -> Effect:
    """What acts where lines scatter so: a steady irregularity on a linear track does not leave them."""
    worst = max(_runs(fit), key=raggedness)
    times = np.sqrt(raggedness(worst))
    words = (
        f"lines of {worst.dataset.record.name} scatter {times:.2g} times as much as those of a steady record: "
        "impacts, or what is not linear"
    )
    return Effect(
        domain="irregularity",
        place=Place(body="irregularity", channels=_ragged(worst)),
        class_=(ClassMember(name=NOVEL, probability=1.0),),
        law=Mechanics(words=words),
    )


def _misfit_beside_runs(fit: Fit) -> float:
    """Mean square of the deviations, without what smooth errors explain, of all records but runs; 1 of none."""
    runs = {run.dataset.record.name for run in _runs(fit)}
    beside = np.array([block.dataset.record.name not in runs for block in fit.evidence.blocks])
    squares = fit.clean[beside[fit.evidence.block_of]] ** 2
    return float(np.mean(squares)) if squares.size else 1.0


def _runs(fit: Fit) -> list[SpectraBlock]:
    return [block for block in fit.evidence.blocks if isinstance(block, SpectraBlock)]


def _ragged(run: SpectraBlock) -> tuple[str, ...]:
    """Channels whose lines scatter more than a track of changing level lets them."""
    return tuple(sorted({channel for channel, size in run.scatter if size**2 > STEADY}))
