"""The smallest size of every effect that the records would have shown, where nothing is called missing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from permway.diagnosis.verdict_parts import Smallest
from permway.posterior.cells import Cell, resized
from permway.posterior.member import tempered
from permway.posterior.screening import Scores

ODDS = 4.0
"""Against nothing missing, from which an effect is called: see :data:`permway.posterior.answer.SUSPECTED`."""


def detectable(cells: Sequence[Cell], scores: Scores, residuals: int) -> dict[str, Smallest]:
    """The smallest size by effect, in the unit of the parameter that says how strong it is.

    A change d of the residuals, a times as large, raises the logarithm of the evidence by half of a^2 d' V^-1 d
    less what its parameter costs (Laplace). Physics is taken where it shows most. A fault of the measurement is
    taken for the channel that shows it least, for nobody chooses which channel goes wrong.

    Parameters
    ----------
    cells : sequence of Cell
        With small sizes.
    scores : Scores
        Of these about the fit that lacks nothing.
    residuals : int
        Of the records, by which evidence is tempered.

    Returns
    -------
    dict
        Effects that no possible size would show are left out.
    """
    best: dict[tuple[str, tuple[str, ...]], tuple[float, Smallest | None]] = {}
    for cell, shown in zip(cells, scores.shown, strict=True):
        if not shown > 0.0 or not cell.hypothesis.size:
            continue
        times = float((_needed(cell.log_prior, residuals) / shown) ** (0.5 / cell.hypothesis.power))
        fault = cell.hypothesis.domain == "measurement"
        channels = cell.hypothesis.locate(cell.values).channels if fault else ()
        place = cell.hypothesis.entry, channels
        if times < best.get(place, (np.inf, None))[0]:
            best[place] = times, _smallest(cell, times)
    found: dict[str, tuple[float, Smallest | None]] = {}
    for (entry, _), one in best.items():
        if one[0] > found.get(entry, (-np.inf, None))[0]:
            found[entry] = one
    return {entry: size for entry, (_, size) in found.items() if size is not None}


def _needed(log_prior: float, residuals: int) -> float:
    """Square of a change, in standard deviations, that makes up for a prior and for its own parameter."""
    wanted = 2.0 * (float(np.log(ODDS)) - log_prior) / tempered(1.0, residuals)
    square = wanted
    for _ in range(20):
        square = wanted + float(np.log1p(square))
    return square


def _smallest(cell: Cell, times: float) -> Smallest | None:
    """A size so many times as far from none; None beyond what the effect can be."""
    hypothesis = cell.hypothesis
    free = next(f for f in hypothesis.free if f.name == hypothesis.size)
    if np.isinf(hypothesis.none):
        return None
    wanted = hypothesis.none + times * (cell.values[free.name] - hypothesis.none)
    value = resized(cell, times).values[free.name]
    if not np.isclose(value, wanted, rtol=1e-6, atol=0.0):
        return None
    return Smallest(parameter=free.name, value=value, unit=free.unit, none=hypothesis.none)
