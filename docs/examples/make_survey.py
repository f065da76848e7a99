"""An impact survey of a viaduct span, as a measuring team exports it: `python make_survey.py FOLDER`.

One CSV for each struck place, with magnitude, phase and coherence of six sensors side by side. The measurement is
stood for by permway's challenge generator (finite elements of its own), which shares no code with the solver.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from permway.challenge.case import draw
from permway.challenge.effects import Site
from permway.challenge.effects.fasteners import FastenersLost
from permway.challenge.layout import Layout, draw_tests

SENSORS, STRUCK = slice(0, 6), slice(0, 13, 2)
NOISE = 9.97e-7
"""Of a sensor at one line, m/s2 for a blow of 1 N."""


def measured(seed: int = 11) -> tuple[str, list[tuple[str, str]]]:
    """What is wrong with the span, and the name and content of each CSV."""
    case, layout = draw(seed, "null"), Layout(spans=1, bays=26, spacing_m=0.64, approach_bays=14)
    tests = draw_tests(np.random.default_rng(seed), layout, temperatures=1)
    tests = replace(tests, lines_Hz=(4.0, 400.0, 4.0), seconds=8.0)
    lost = FastenersLost.draw(np.random.default_rng(5), "strong", Site(layout, tests))
    case = replace(case, layout=layout, tests=tests, effects=(lost,), chain=replace(case.chain, noise=NOISE))
    test = case.measure()[0][0]
    names, files = [f"{body}@{x:.2f}" for body, x in tests.sensors[SENSORS]], []
    for (body, x), frf, coherence in zip(
        tests.points[STRUCK],
        np.moveaxis(test.frf[:, SENSORS, STRUCK], 2, 0),
        np.moveaxis(test.coherence[:, SENSORS, STRUCK], 2, 0),
        strict=True,
    ):
        head = ["frequency [Hz]"]
        for name in names:
            head += [f"mag {name} [(m/s2)/N]", f"phase {name} [deg]", f"coh {name}"]
        parts = np.stack([np.abs(frf), np.degrees(np.angle(frf)), coherence], axis=-1).reshape(len(frf), -1)
        rows = np.column_stack([test.frequency_Hz, parts])
        lines = [";".join(head), *(";".join(f"{v:.6g}" for v in row) for row in rows)]
        files.append((f"impact_{body}_{x:.2f}m.csv", "\n".join(lines) + "\n"))
    return lost.mechanical, files


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in measured()[1]:
        (folder / name).write_text(content)
