"""An e-value of the amended model: what it foretells of one half of the records from the other, over the base."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from permway.diagnosis.blocks_tabular import TableBlock
from permway.diagnosis.evidence import Evidence
from permway.diagnosis.heldout import Part, Rest


def log_e_value(base: Rest, amended: Rest, tried: int, faults: Sequence[Part] = ()) -> float:
    """Logarithm of an e-value: what the amended model foretells of one half from the other, over the base.

    With nothing missing, and parameters as their owner says, the ratio of the two predictive densities has the
    expectation 1, so it passes 20 once in twenty times at most (Vovk and Wang 2021). It is the mean over ways
    to take the halves, and over all effects that were tried, of which the others are counted as foretelling
    nothing: choosing the best of them is so paid for. (A split likelihood in the manner of Wasserman, Ramdas and
    Balakrishnan (2020) lets the base fit the judging half itself; with thirty parameters that are known beforehand
    this costs some twenty nats.) The sizes of smooth errors are those learnt on all records.

    Parameters
    ----------
    base, amended : Rest
    tried : int
        Effects, or sets of effects, that the amended model was chosen from.
    faults : sequence of Part
        Of channels that are said to be at fault (:func:`permway.diagnosis.heldout.at_fault`): further ways. Of a
        chain that reads too much every blow tells of every other, whether or not that is called a fault.
    """
    halves = [judging for half in _halves(base.fit.evidence) for judging in (half, ~half)]
    gained = [
        amended.scored(judging).log_density - base.scored(judging).log_density
        for judging in [*halves, *(part.rows for part in faults)]
    ]
    return float(np.logaddexp.reduce(gained)) - float(np.log(len(gained) * max(tried, 1)))


def _halves(evidence: Evidence) -> Iterator[np.ndarray]:
    """Every second point of the hammer; of what has none every second line, and, of several tables, every second.

    An effect may show in one run only; one that is smooth over frequency, lines between tell without it. Runs are
    no witnesses of each other: they meet one profile, whatever it has beside what its owner says.
    """
    rows = evidence.rows
    points = list(dict.fromkeys(rows.force[rows.force != ""]))
    struck = np.isin(rows.force, points[1::2])
    bare = np.ones(struck.size, dtype=bool) if len(points) < 2 else rows.force == ""
    _, line = np.unique(rows.frequency_Hz[bare], return_inverse=True)
    yield _with(struck, bare, line % 2 == 1)
    tables = [i for i, block in enumerate(evidence.blocks) if isinstance(block, TableBlock)]
    if len(tables) > 1:
        every_second = _with(struck, bare, line % 2 == 1)
        of_tables = np.isin(evidence.block_of, tables)
        yield _with(every_second, of_tables, np.isin(evidence.block_of[of_tables], tables[1::2]))


def _with(half: np.ndarray, bare: np.ndarray, values: np.ndarray) -> np.ndarray:
    found = half.copy()
    found[bare] = values
    return found
