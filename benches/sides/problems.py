"""The problems that all sides solve, and how each side times and reports itself."""

from __future__ import annotations

import argparse
import json
import resource
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

# UIC60, and 60.20 kg/m beside the rotary inertia of 7850 kg/m3: the track whose mobilities are printed.
UIC60 = {
    "youngs_modulus_Pa": 2.1e11,
    "shear_modulus_Pa": 8.1e10,
    "shear_area_m2": 0.4 * 76.70e-4,
    "second_moment_m4": 3038.3e-8,
    "mass_kg_per_m": 60.20,
    "density_kg_per_m3": 7850.0,
    "loss_factor": 0.02,
}
SUPPORTS, BAY_M = 241, 0.6
PAD_N_PER_M, PAD_LOSS = 300e6, 0.25
WHEELS_M = (-10.0, -7.5, 7.5, 10.0)


def frequencies(case: str) -> np.ndarray:
    """The whole grid of a case, Hz."""
    return np.linspace(20.0, 3000.0, 1500) if case == "rail" else np.linspace(1.0, 1000.0, 1500)


def places(case: str) -> list[float]:
    """Where unit forces act on the rail and where it is read, m."""
    if case == "rail":
        return [BAY_M * (SUPPORTS // 2)]
    return [16.0 * spans(case) + x for x in WHEELS_M]


def spans(case: str) -> int:
    """Spans of "viaduct-N"."""
    return int(case.removeprefix("viaduct-"))


def difference(a: np.ndarray, b: np.ndarray) -> float:
    """Largest difference of receptances (F, S, S), in terms of the direct receptances of the two places."""
    direct = np.sqrt(np.abs(np.einsum("fii->fi", b)))
    return float(np.max(np.abs(a - b) / (direct[:, :, None] * direct[:, None, :])))


class Part:
    """A function, and the time spent in it: the part of a side's work that is solving alone."""

    def __init__(self, function: Callable):
        self.function, self.spent = function, 0.0

    def __call__(self, *arguments, **named):
        start = time.perf_counter()
        try:
            return self.function(*arguments, **named)
        finally:
            self.spent += time.perf_counter() - start


def run(prepare: Callable[[str, np.ndarray, Path], Callable[[], np.ndarray]], part: Part | None = None) -> None:
    """Time one side of one case as its own process; print the row as JSON.

    `prepare` takes the case, the frequencies and the folder of tables, and returns a function without arguments
    that solves them all and gives receptances (F, S, S) in m/N. `part` is what of it counts as solving alone.
    """
    parser = argparse.ArgumentParser()
    parser.add_argument("case")
    parser.add_argument("--every", type=int, default=1, help="take every so many-th frequency")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--folder", type=Path, required=True, help="of tables and answers")
    parser.add_argument("--reference", action="store_true", help="write the answers that others are held against")
    options = parser.parse_args()
    grid = frequencies(options.case)[:: options.every]
    solve = prepare(options.case, grid, options.folder)
    times, busy, parts = [], [], []
    for _ in range(options.repeat):
        before, clock, start = part.spent if part else 0.0, time.process_time(), time.perf_counter()
        answer = solve()
        times.append(time.perf_counter() - start)
        busy.append(time.process_time() - clock)
        parts.append(part.spent - before if part else times[-1])
    row = {
        "case": options.case,
        "frequencies": grid.size,
        "ms_per_frequency": 1e3 * min(times) / grid.size,
        # Of the processor alone: other work on the machine enters less.
        "processor_ms_per_frequency": 1e3 * min(busy) / grid.size,
        "solving_ms_per_frequency": 1e3 * min(parts) / grid.size,
        "median_ms_per_frequency": 1e3 * statistics.median(times) / grid.size,
        # Kilobytes on Linux, bytes on macOS.
        "peak_memory_MiB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        / (2**20 if sys.platform == "darwin" else 2**10),
    }
    stored = options.folder / f"{options.case}.npy"
    if options.reference:
        np.save(stored, answer)
    else:
        row["difference"] = difference(answer, np.load(stored)[:: options.every])
    print(json.dumps(row))
