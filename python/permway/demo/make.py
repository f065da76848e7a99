"""Makes the embedded campaign: `python -m permway.demo.make FOLDER`.

The records come from the generator of :mod:`permway.challenge`, which shares no code with the solver: a deck of
one short span, its pads, layers and beams off their nominal values within the tolerances, calibration errors of
sensors and hammer, noise, and three fasteners that hold next to nothing.
"""

from __future__ import annotations

import json
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from permway.campaign.importers.sheet import import_sheet
from permway.challenge.case import Case, draw
from permway.challenge.effects.fasteners import FastenersLost
from permway.challenge.files import write_mat
from permway.challenge.layout import Layout
from permway.files import write_text

SEED = 1
LAYOUT = Layout(spans=1, bays=26, spacing_m=0.64, approach_bays=14)
LINES_HZ = (4.0, 200.0, 4.0)
LOST = (8, 9, 10)
"""Fasteners, counted from the deck's beginning."""

LEFT = 0.05
"""Of their stiffness."""


def case() -> Case:
    """The campaign, drawn from its seed: one hammer test, five sensors, nine points."""
    station, half = LAYOUT.station, 0.5 * LAYOUT.spacing_m
    middle = LAYOUT.bays // 2
    sensors = (
        ("rail", round(station(middle) + half, 2)),
        ("rail", station(7)),
        ("slab", station(middle)),
        ("girder", station(middle)),
        ("girder", station(6)),
    )
    points = (*(("rail", station(i)) for i in range(2, LAYOUT.bays, 3)), ("girder", station(middle)))
    drawn = draw(SEED, "single")
    tests = replace(
        drawn.tests, sensors=sensors, points=points, temperatures_C=(12.0,), lines_Hz=LINES_HZ, seconds=2.0
    )
    stretch = (round(station(LOST[0]) - half, 2), round(station(LOST[-1]) + half, 2))
    return replace(
        drawn, layout=LAYOUT, tests=tests, effects=(FastenersLost(stretch, LEFT),), strength="strong", text=False
    )


def make(folder: Path) -> None:
    """Write campaign, model, records and truth; the folder must be there."""
    made = case()
    (hammer,), _ = made.measure()
    with tempfile.TemporaryDirectory() as place:
        team = Path(place) / "demo"
        team.mkdir()
        sheet = made.sheet
        del sheet["runs"]
        (team / "sheet.json").write_text(json.dumps(sheet), encoding="utf-8")
        write_mat(team / "hammer_+12C.mat", hammer, made.tests.sensors, made.tests.points)
        import_sheet(team, folder)
    write_text(folder / "truth.json", json.dumps(made.truth, indent=1) + "\n")


if __name__ == "__main__":
    make(Path(sys.argv[1]))
