"""`permway doctor --bench`: what this machine gives, and one number to compare machines by."""

from __future__ import annotations

import math
import os
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from permway.campaign.campaign import Campaign
    from permway.model.line import Line

ROUNDS = 15
"""Of every line with every number of threads, in turns: the least time counts, which other work enters least."""

ENOUGH_S = 6.0
"""After so long no further round begins, so that a slow machine ends in time, too."""

FREQUENCIES = {"ballasted track": 8000, "slab track on a span": 4000, "ten spans": 800}
"""Of one sweep: 12 to 27 ms on one core of the reference."""

REFERENCE: dict[str, Any] = {
    "processor": "AMD EPYC (Zen 4), AVX-512, one core",
    "us_per_frequency": {"ballasted track": 1.44, "slab track on a span": 3.87, "ten spans": 34.1},
    "diagnosis_s": 5.2,
}
"""The score counts such cores. Processor time on one thread: of a line the least of its rounds."""

SCORE_IS = (
    "geometric mean of four ratios, time of the reference over the time here with all threads: three lines and "
    "the diagnosis; 2 is what two cores of the reference would give at best"
)

SEED = 41
"""Of the small campaign's draw."""

BUSY = 0.5
"""Load of each processor above which times say more of other programs than of the machine."""


@dataclass(frozen=True)
class Timed:
    """Least times of one line, us per frequency: of the processor with one thread, on the clock with all."""

    line: str
    one_us: float
    all_us: float


def lines() -> dict[str, Line]:
    """The three lines, by name."""
    from permway.model.lines_ballasted import ballasted_b91_60e1
    from permway.model.presets import slab_track_viaduct_32m, wj7b_constant

    pad = wj7b_constant()
    return {
        "ballasted track": ballasted_b91_60e1(),
        "slab track on a span": slab_track_viaduct_32m(pad=pad),
        "ten spans": slab_track_viaduct_32m(pad=pad, spans=10),
    }


def time_lines(
    threads: int,
    *,
    frequencies: Mapping[str, int] = FREQUENCIES,
    rounds: int = ROUNDS,
    enough_s: float = ENOUGH_S,
) -> list[Timed]:
    """Time sweeps of the three lines from 10 to 1000 Hz, one force and one sensor on the rail.

    Parameters
    ----------
    threads : int
        All that the machine gives.
    frequencies : mapping of str to int
        Of one sweep, by line.
    rounds : int
        At most; one at least is done.
    enough_s : float
        No round begins later.
    """
    from permway.model.place import Place
    from permway.response.receptance import receptance

    at = [Place(body="rail", x_m=16.0)]
    tried = {name: (line, np.linspace(10.0, 1000.0, frequencies[name])) for name, line in lines().items()}
    found: dict[tuple[str, str], list[float]] = {}
    started = time.perf_counter()
    for done in range(rounds):
        if done and time.perf_counter() - started > enough_s:
            break
        for name, (line, grid) in tried.items():
            # One thread: what the processor spends, whatever else runs. Of several only the clock shows the gain.
            for kind, count, clock in (("one", 1, time.process_time), ("all", threads, time.perf_counter)):
                start = clock()
                receptance(line, grid, forces=at, sensors=at, threads=count)
                found.setdefault((name, kind), []).append(1e6 * (clock() - start) / grid.size)
    return [Timed(name, min(found[name, "one"]), min(found[name, "all"])) for name in tried]


def small_campaign(folder: Path) -> Campaign:
    """The campaign of the small diagnosis: a rail on 21 pads, struck at two points, nothing left out."""
    from permway.challenge.small.fixture import CAMPAIGN, MODEL, SPACING, simulate

    model, stated = deepcopy(MODEL), deepcopy(CAMPAIGN)
    line = model["line"]
    line["bodies"] = {"rail": line["bodies"]["rail"]}
    line["laws"] = {"pad": line["laws"]["pad"]}
    line["joints"] = [{"between": ["rail", "ground"], "law": "pad", "at": SPACING}]
    stated["parameters"] = [p for p in stated["parameters"] if p["name"].startswith("pad")]
    stated["sensors"] = [s for s in stated["sensors"] if s["body"] == "rail"]
    stated["forces"] = [f for f in stated["forces"] if f["body"] == "rail"]
    stated["records"][0] |= {"responses": {"r": "rail@6"}, "references": {"a": "hit", "b": "hit far"}}
    grid = np.arange(10.0, 201.0, 10.0)
    return simulate(folder, SEED, model=model, campaign=stated, frequency_Hz=grid).campaign


def diagnose_small(threads: int) -> str:
    """Diagnose the small campaign; the status of the verdict."""
    from permway.posterior.diagnose import diagnose

    with tempfile.TemporaryDirectory() as folder:
        return diagnose(small_campaign(Path(folder)), threads=threads).verdict.status


def score(timed: Sequence[Timed], diagnosis_s: float, reference: Mapping[str, Any] = REFERENCE) -> float:
    """How many cores of the reference this machine is worth: see :data:`SCORE_IS`."""
    ratios = [reference["us_per_frequency"][each.line] / each.all_us for each in timed]
    ratios.append(reference["diagnosis_s"] / diagnosis_s)
    return float(math.prod(ratios) ** (1.0 / len(ratios)))


def bench(
    *,
    time_all: Callable[[int], list[Timed]] = time_lines,
    diagnose_it: Callable[[int], object] = diagnose_small,
) -> dict[str, Any]:
    """What this machine gives, in about 15 s.

    Parameters
    ----------
    time_all, diagnose_it : callable
        Of the number of threads: what times the lines, and what diagnoses.

    Returns
    -------
    dict
        `bench`, a row for each line (us per frequency with one thread and with all, and their ratio);
        `small_diagnosis_s`; `score` and what it is; the reference; `load_average` of the last minute before, and
        `busy`, whether that leaves the times meaning little.
    """
    processors = os.cpu_count() or 1
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else None
    timed = time_all(processors)
    start = time.perf_counter()
    diagnose_it(processors)
    spent = time.perf_counter() - start
    return {
        "bench": [
            {
                "line": each.line,
                "one_thread_us": each.one_us,
                "all_threads_us": each.all_us,
                "gain": each.one_us / each.all_us,
            }
            for each in timed
        ],
        "small_diagnosis_s": spent,
        "score": score(timed, spent),
        "score_is": SCORE_IS,
        "reference": REFERENCE["processor"],
        "load_average": load,
        "busy": load is not None and load > BUSY * processors,
    }
