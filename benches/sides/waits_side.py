"""One part of what people wait for, in a process of its own, of the permway that this Python finds.

`python waits_side.py PART [ARGUMENT]` prints a row of JSON: what the part measures of itself, or {}; times of the
whole process are taken by whoever calls. Ends with status 3 where this permway has no such thing.
"""

from __future__ import annotations

import hashlib
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

STATIONS = 32_000
SPANS = (1, 10, 200)
FREQUENCIES = 9600
"""Times spans: work is the same for any number of them."""

ROUNDS = 5


def about(_: str) -> dict[str, Any]:
    """What is compared: version, and a hash of the compiled core."""
    from permway import _core

    core = hashlib.sha256(Path(_core.__file__).read_bytes()).hexdigest()[:12]
    return {"version": _core.__version__, "core": core, "python": sys.version.split()[0]}


def small(folder: str) -> dict[str, Any]:
    """Write the small campaign of `permway doctor --bench`."""
    from permway.cli.bench import small_campaign

    small_campaign(Path(folder))
    return {}


def diagnosis(campaign: str) -> dict[str, Any]:
    """A diagnosis by the method that stands in `permway.posterior`, or by that before it."""
    from permway.campaign.campaign import read_campaign
    from permway.posterior.diagnose import diagnose

    return {"status": diagnose(read_campaign(campaign)).verdict.status}


def diagnosis_before(campaign: str) -> dict[str, Any]:
    """The same where there is no `permway.posterior`."""
    from permway.diagnosis.diagnose import diagnose
    from permway.recordings.campaign import read_campaign

    return {"status": diagnose(read_campaign(campaign)).verdict.status}


def least(work: Callable[[], object], rounds: int, clock: Callable[[], float] = time.process_time) -> float:
    found = []
    for _ in range(rounds):
        start = clock()
        work()
        found.append(clock() - start)
    return min(found)


def irregular(_: str) -> dict[str, Any]:
    """Processor time of a rail on irregular supports, set-up and the first eight frequencies."""
    import permway
    from permway.laws import Hysteretic

    gaps = 0.6 + 0.05 * np.random.default_rng(1).uniform(-1.0, 1.0, STATIONS)
    at = tuple(np.cumsum(gaps).tolist())
    section = {"youngs_modulus_Pa": 2.1e11, "second_moment_m4": 3.04e-5, "density_kg_per_m3": 7850.0}
    rail = permway.Beam(area_m2=7.67e-3, loss_factor=0.02, **section)
    line = permway.Line(
        bodies={"rail": rail},
        joints=(permway.Joints(between=("rail", "ground"), law="pad", at=at),),
        laws={"pad": Hysteretic(stiffness=3e8, loss_factor=0.25)},
    )
    here, grid = [permway.Place(body="rail", x_m=at[STATIONS // 2] + 0.1)], np.linspace(50.0, 400.0, 8)
    return {"s": least(lambda: permway.receptance(line, grid, forces=here, sensors=here, threads=1), 2)}


def _sweep(spans: int, frequencies: int) -> Callable[[int], object]:
    import permway

    line, at = permway.slab_track_viaduct_32m(spans=spans), [permway.Place(body="rail", x_m=16.0 * spans)]
    grid = np.linspace(10.0, 1000.0, frequencies)
    return lambda threads: permway.receptance(
        line, grid, forces=at, sensors=at, temperature_C=20.0, threads=threads
    )


def stations(_: str) -> dict[str, Any]:
    """Processor time of a span and frequency, ns, by the number of spans: the whole call, its set-up taken out."""
    rows = {}
    for spans in SPANS:
        count = max(FREQUENCIES // spans, 96)
        few, many = (_sweep(spans, count * factor) for factor in (1, 3))
        spent = least(lambda many=many: many(1), ROUNDS) - least(lambda few=few: few(1), ROUNDS)
        rows[spans] = 1e9 * spent / (2 * count * spans)
    return {"ns_per_span": rows, "growth": rows[SPANS[-1]] / rows[1]}


def threads(_: str) -> dict[str, Any]:
    """Time of one thread over that of two, 1 and 10 spans, the least of many short sweeps in turns."""
    found = {}
    for spans, frequencies in ((1, 2000), (10, 400)):
        sweep, times = _sweep(spans, frequencies), {1: [], 2: []}
        for _round in range(12):
            for count, spent in times.items():
                spent.append(least(lambda count=count, sweep=sweep: sweep(count), 1, time.perf_counter))
        found[spans] = min(times[1]) / min(times[2])
    return {"ratio": found, "least": min(found.values())}


PARTS = {f.__name__: f for f in (about, small, diagnosis, diagnosis_before, irregular, stations, threads)}

if __name__ == "__main__":
    try:
        print(json.dumps(PARTS[sys.argv[1]]([*sys.argv, ""][2])))
    except ImportError as missing:
        print(missing, file=sys.stderr)
        sys.exit(3)
