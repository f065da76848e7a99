"""A folder as a laboratory hands it over: hammer tests of a track, a wide CSV of responses a hit point, no more.

The track is that of :mod:`ridden`, by finite elements that share no code with the solver. One fastener carries
nothing.
"""

from __future__ import annotations

import csv
import re
from pathlib import Path

import numpy as np
from ridden import FREQUENCY, READ, STRUCK, hammer

LOST_M = 10.2
UNIT = "(m/s2)/N"

CAMPAIGN_ANSWERS = ((r"^# (body|x_m) = (\S+) .*", r"\1 = \2"), (r"^# averages = 8 .*", "averages = 8"))
"""Places are those of the labels; eight blows a point."""

MODEL_ANSWERS = (
    (r"^second_moment_m4 = .*", "second_moment_m4 = 3.05e-5"),
    (r"^loss_factor = 0.01", "loss_factor = 0.02"),
    (r'^type = "hysteretic".*', 'type = "kelvin_voigt"'),
    (r"^# stiffness = .*", "stiffness = 120e6"),
    (r"^# loss_factor = .*", "damping = 48e3"),
    (r"^# at = .*", "at = { from_m = 0.0, to_m = 30.0, spacing_m = 0.6 }"),
)
"""The rail's data sheet, the pads' test report, the drawing."""

TOLERANCES = """
[[parameters]]
name = "pad stiffness"
paths = "line.laws.pad.stiffness"
unit = "N/m"
tolerance_2sigma = 0.3

[[parameters]]
name = "pad damping"
paths = "line.laws.pad.damping"
unit = "N s/m"
tolerance_2sigma = 0.5
"""


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


def answered(campaign: str, model: str) -> tuple[str, str]:
    """Both files of `permway new` with what the notes say, answered as the page of the first hour answers them."""
    for old, new in CAMPAIGN_ANSWERS:
        campaign, count = re.subn(old, new, campaign, flags=re.MULTILINE)
        assert count, old
    for old, new in MODEL_ANSWERS:
        model, count = re.subn(old, new, model, flags=re.MULTILINE)
        assert count == 1, old
    return campaign + TOLERANCES, model
