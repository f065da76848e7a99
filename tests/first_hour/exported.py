"""A folder as a laboratory hands it over: hammer tests of a track, a wide CSV of responses a hit point, no more.

The track is that of :mod:`ridden`, by finite elements that share no code with the solver; one fastener carries nothing.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
from ridden import FREQUENCY, READ, STRUCK, hammer

LOST_M = 10.2
UNIT = "(m/s2)/N"


def wide(folder: Path, seed: int = 1, lost: tuple[float, ...] = (LOST_M,)) -> None:
    """Write `rail_9.csv` and so on: real and imaginary part and coherence of each accelerometer, by frequency."""
    random = np.random.default_rng([seed, 471])
    pads = float(np.exp(0.5 * np.log1p(0.25) * random.standard_normal()))
    frf, coherence = hammer(random, pads, lost)
    head = ["Frequency [Hz]"]
    for x in READ:
        head += [f"rail@{x:g} Real [{UNIT}]", f"rail@{x:g} Imag [{UNIT}]", f"rail@{x:g} Coherence"]
    for j, struck in enumerate(STRUCK):
        columns = [FREQUENCY]
        for i in range(len(READ)):
            columns += [frf[i, j].real, frf[i, j].imag, coherence[i, j]]
        rows = [[f"{value:.6g}" for value in row] for row in np.column_stack(columns)]
        with (folder / f"rail_{struck:g}.csv").open("w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([head, *rows])
