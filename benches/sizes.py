"""Cost against size: `python benches/sizes.py`, into sizes.json and benches/README.md.

Processor time on one thread, the least of several: a sweep of receptances, and all records of a campaign
predicted, as a diagnosis does thousands of times. One size changes, the others stay. `--big` sweeps ten spans with
40 sensors and 100,000 lines of frequency in blocks, and says time and memory.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import json
import resource
import sys
import tempfile
import time
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
from common import HERE, processor
from permway.campaign.campaign import Campaign
from permway.challenge.small.fixture import CAMPAIGN, MODEL, simulate
from permway.diagnosis.gather import gather
from permway.model.place import Place
from permway.model.presets import slab_track_viaduct_32m, wj7b_constant
from permway.response.receptance import receptance
from sides.waits_side import least
from waits import placed

README = HERE / "README.md"
MARKS = "<!-- sizes: written by sizes.py -->", "<!-- end of sizes -->"
ROUNDS = 5
SPAN_M = {"receptance": 32.0, "prediction": 12.0}
BASE = {"sensors": 4, "points": 4, "lines": 400, "spans": 4}
SIZES = {
    "sensors": (1, 4, 16, 64),
    "points": (1, 4, 16, 64),
    "lines": (100, 400, 1600, 6400),
    "spans": (1, 4, 16, 64),
}
FURTHER: tuple[tuple[str, str, str, tuple[int, ...], dict[str, int]], ...] = (
    (
        "receptance",
        "spans, one sensor and point in the middle",
        "spans",
        (1, 4, 16, 64),
        {"sensors": 1, "points": 1},
    ),
    ("receptance", "points, on one span", "points", (4, 16, 64, 256), {"spans": 1}),
    ("receptance", "sensors, on one span", "sensors", (4, 16, 64, 256), {"spans": 1}),
    ("receptance", "sensors and points, on one span", "sensors points", (4, 16, 64, 256), {"spans": 1}),
)
"""Work, what the row says, the sizes that change, and others that are not those of the base: to tell why."""

BIG = {"sensors": 40, "points": 1, "lines": 100_000, "spans": 10}
BLOCK = 5000
"""Lines of frequency of one call of the big sweep: beyond some hundreds a call costs nothing more."""

Size = dict[str, int]


def along(count: int, length: float) -> list[float]:
    """So many places along a length, at the middle of equal parts."""
    return [round(length * (i + 0.5) / count, 3) for i in range(count)]


def sweep(size: Size) -> Callable[[], object]:
    """Receptances of the slab track on so many spans, sensors and points along all of the rail."""
    line = slab_track_viaduct_32m(pad=wj7b_constant(), spans=size["spans"])
    length = SPAN_M["receptance"] * size["spans"]
    sensors, forces = ([Place(body="rail", x_m=x) for x in along(size[k], length)] for k in ("sensors", "points"))
    grid = np.linspace(10.0, 1000.0, size["lines"])
    return lambda: receptance(line, grid, forces=forces, sensors=sensors, threads=1)


def campaign(size: Size, folder: Path) -> Campaign:
    """The fixture's decks in a row, with so many sensors and points on the rail."""
    model, stated = deepcopy(MODEL), deepcopy(CAMPAIGN)
    deck, spans = SPAN_M["prediction"], size["spans"]
    length = deck * spans
    bodies, joints = model["line"]["bodies"], model["line"]["joints"]
    bodies["rail"]["intervals_m"] = [[-3.0, length + 3.0]]
    bodies["deck"]["intervals_m"] = [[deck * i, deck * (i + 1)] for i in range(spans)]
    joints[0]["at"] = {"from_m": 0.3, "to_m": length - 0.3, "spacing_m": 0.6}
    sensors, points = along(size["sensors"], length), along(size["points"], length)
    stated["sensors"] = [
        {"name": f"s{i}", "body": "rail", "x_m": x, "unit": "m/s2"} for i, x in enumerate(sensors)
    ]
    stated["forces"] = [{"name": f"p{i}", "body": "rail", "x_m": x} for i, x in enumerate(points)]
    stated["records"][0] |= {
        "responses": {f"r{i}": f"s{i}" for i in range(len(sensors))},
        "references": {f"h{i}": f"p{i}" for i in range(len(points))},
        # As many lines as are recorded, none left out for lying close.
        "lines_per_frequency": 1e6,
    }
    grid = np.linspace(8.0, 200.0, size["lines"])
    return simulate(folder, 1, model=model, campaign=stated, frequency_Hz=grid).campaign


def prediction(size: Size) -> Callable[[], object]:
    """All records predicted."""
    with tempfile.TemporaryDirectory() as folder:
        read = campaign(size, Path(folder))
        observations = gather(read, threads=1)
    return lambda: observations.predicted(read)


WORK: dict[str, Callable[[Size], Callable[[], object]]] = {"receptance": sweep, "prediction": prediction}


def exponents(sizes: list[int], seconds: list[float]) -> tuple[float, float]:
    """Slope of the logarithm of time by that of size: of all, and from the last size but one to the last."""
    x, y = np.log(sizes), np.log(seconds)
    return float(np.polyfit(x, y, 1)[0]), float((y[-1] - y[-2]) / (x[-1] - x[-2]))


def measured() -> list[dict[str, Any]]:
    """A row for each kind of work and size that changes."""
    rows = []
    cases = [(work, what, what, sizes, {}) for work in WORK for what, sizes in SIZES.items()]
    for work, says, what, sizes, others in (*cases, *FURTHER):
        sized = [{**BASE, **others, **dict.fromkeys(what.split(), n)} for n in sizes]
        seconds = [least(WORK[work](size), ROUNDS) for size in sized]
        slopes = exponents(list(sizes), seconds)
        row = {"work": work, "against": says, "sizes": sizes, "processor_s": seconds}
        rows.append({**row, "exponent": slopes[0], "exponent_at_the_end": slopes[1]})
        print(json.dumps(rows[-1]), file=sys.stderr, flush=True)
    return rows


def big(size: Size = BIG, block: int = BLOCK) -> dict[str, Any]:
    """The big sweep, block by block, the answer kept as one array."""
    line = slab_track_viaduct_32m(pad=wj7b_constant(), spans=size["spans"])
    length = SPAN_M["receptance"] * size["spans"]
    sensors, forces = ([Place(body="rail", x_m=x) for x in along(size[k], length)] for k in ("sensors", "points"))
    grid = np.linspace(1.0, 1000.0, size["lines"])
    found = np.empty((grid.size, len(sensors), len(forces)), complex)
    clock, start = time.process_time(), time.perf_counter()
    for first in range(0, grid.size, block):
        part = slice(first, first + block)
        found[part] = receptance(line, grid[part], forces=forces, sensors=sensors).receptance.values
    unit = 2**20 if sys.platform == "darwin" else 2**10
    return {
        **size,
        "block": block,
        "s": time.perf_counter() - start,
        "processor_s": time.process_time() - clock,
        "peak_memory_MiB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit,
        "answer_MiB": found.nbytes / 2**20,
        "finite": bool(np.isfinite(found).all()),
        "load_average": round(os.getloadavg()[0], 2),
    }


def _ms(seconds: float) -> str:
    return f"{1e3 * seconds:.3g}" if seconds < 1.0 else f"{1e3 * seconds:.0f}"


def table(report: dict[str, Any]) -> str:
    """The report as Markdown."""
    machine = report["machine"]
    base = ", ".join(f"{count} {what}" for what, count in report["base"].items())
    lines = [
        f"{machine['processor']}, load {machine['load_average'][0]:.0f}; processor time on one thread, least of "
        f"{report['rounds']}. What does not",
        f"change: {base}. Sensors and points stand along",
        "all of the rail. Exponents of a power law: of all sizes, and from the last but one to the last.",
        "",
        "| work | against | sizes | ms | exponent | at the end |",
        "|---|---|---|---|---:|---:|",
    ]
    for row in report["rows"]:
        sizes, times = ", ".join(map(str, row["sizes"])), ", ".join(_ms(s) for s in row["processor_s"])
        slopes = f"{row['exponent']:.2f} | {row['exponent_at_the_end']:.2f}"
        lines.append(f"| {row['work']} | {row['against']} | {sizes} | {times} | {slopes} |")
    if (one := report.get("big")) is not None:
        lines += [
            "",
            f"**{one['spans']} spans, {one['sensors']} sensors, {one['lines']:,} lines of frequency**, one force,",
            f"in blocks of {one['block']:,}: {one['s']:.0f} s on the clock (load {one['load_average']:.0f}), "
            f"{one['processor_s']:.1f} s of processor,",
            f"{one['peak_memory_MiB']:.0f} MiB, the answer's {one['answer_MiB']:.0f} MiB included.",
        ]
    return "\n".join(lines)


def main() -> None:
    """Measure, write the results, and put the table into the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, default=HERE / "sizes.json")
    parser.add_argument("--big", action="store_true", help="the big sweep alone; the other results stay")
    parser.add_argument("--render", action="store_true", help="write the table alone, of results that are there")
    options = parser.parse_args()
    report = json.loads(options.output.read_text("utf-8")) if options.output.exists() else {}
    if options.big:
        report["big"] = big()
    elif not options.render:
        report |= {"machine": processor(), "base": BASE, "rounds": ROUNDS, "rows": measured()}
    options.output.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    if "rows" in report:
        README.write_text(placed(README.read_text("utf-8"), MARKS, table(report)), encoding="utf-8")


if __name__ == "__main__":
    main()
