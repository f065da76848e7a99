"""permway alone: cost per station against length, two threads against one, and a line of 3.2 km."""

from __future__ import annotations

import argparse
import json
import resource
import statistics
import sys
import time

import numpy as np
import permway
from permway import _core
from problems import Part

SPANS = (1, 2, 5, 10, 20, 50, 100, 200)
FASTENERS = 51
FREQUENCIES = 1000
CORE = Part(_core.solve_line)
_core.solve_line = CORE


class Sweep:
    """One force and one sensor at the middle of so many spans; all times in s."""

    def __init__(self, spans: int, frequencies: int):
        self.spans, self.grid = spans, np.linspace(1.0, 1000.0, frequencies)
        self.line = permway.slab_track_viaduct_32m(spans=spans)
        self.at = [permway.Place(body="rail", x_m=16.0 * spans)]

    def run(self, threads: int, most: int | None = None) -> tuple[float, float]:
        """Times of the whole call and of the core in it, over the first `most` frequencies."""
        grid, before, start = self.grid[:most], CORE.spent, time.perf_counter()
        permway.receptance(self.line, grid, forces=self.at, sensors=self.at, temperature_C=20.0, threads=threads)
        return time.perf_counter() - start, CORE.spent - before


def per_station(rounds: int) -> list[dict[str, float]]:
    """Cost of a fastener's station per frequency, lengths taking turns; and of a sweep before it begins."""
    sweeps = [Sweep(n, FREQUENCIES) for n in SPANS]
    times = [[s.run(1) for s in sweeps] for _ in range(rounds)]
    rows = []
    for i, sweep in enumerate(sweeps):
        unit = 1e9 / (sweep.spans * FASTENERS * FREQUENCIES)
        core = [t[i][1] * unit for t in times]
        # One group of eight frequencies, less its part of the long sweep: tables, tape and threads.
        group = min(sweep.run(1, 8)[1] for _ in range(3))
        rows.append(
            {
                "spans": sweep.spans,
                "core_ns_per_station": min(core),
                "median_core_ns_per_station": statistics.median(core),
                "call_ns_per_station": min(t[i][0] for t in times) * unit,
                "setting_up_ms": 1e3 * (group - 8 * min(core) / unit / FREQUENCIES),
            }
        )
    return rows


def by_threads(rounds: int) -> list[dict[str, float]]:
    """One thread and two taking turns, in short sweeps: some of them meet a quiet moment."""
    rows = []
    for spans, frequencies in ((1, 4000), (10, 800), (100, 160)):
        sweep = Sweep(spans, frequencies)
        times = np.array([[sweep.run(threads) for threads in (1, 2)] for _ in range(rounds)])
        call, core = times.min(axis=0).T
        ratios = times[:, 0, 1] / times[:, 1, 1]
        row = {"spans": spans, "frequencies": frequencies, "core_ratio": core[0] / core[1]}
        row |= {"call_ratio": call[0] / call[1], "median_core_ratio": float(np.median(ratios))}
        rows.append(row)
    return rows


def long_line(threads: int) -> dict[str, float]:
    """100 spans, 2000 frequencies, from the model to the dataset."""
    start = time.perf_counter()
    call, core = Sweep(100, 2000).run(threads)
    whole = time.perf_counter() - start
    unit = 2**20 if sys.platform == "darwin" else 2**10
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit
    return {
        "threads": threads,
        "model_and_call_s": whole,
        "call_s": call,
        "core_s": core,
        "peak_memory_MiB": memory,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("stations", "threads", "long"))
    parser.add_argument("--rounds", type=int)
    parser.add_argument("--threads", type=int, default=1)
    options = parser.parse_args()
    if options.what == "long":
        print(json.dumps(long_line(options.threads)))
    else:
        measure, rounds = {"stations": (per_station, 5), "threads": (by_threads, 20)}[options.what]
        print(json.dumps(measure(options.rounds or rounds)))


if __name__ == "__main__":
    main()
