"""What passages say of loads and speed, and how surely: `python benches/passages/run.py FOLDER [FIRST COUNT]`.

Small campaigns at random, five of six of constant forces, the others of masses on springs; made by an
integration in time that shares no code with it. Each is recalibrated as `permway compare` does. FOLDER keeps a
line of JSON a case, and what is there is not run again; the summary of all goes to passages.json beside this
file.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from cases import drawn
from permway.campaign.campaign import read_campaign
from permway.diagnosis.gather import gather
from permway.diagnosis.side_by_side import one_thread_of_blas
from permway.posterior.recalibrated import recalibrated

Z90, LACKING = 1.6449, 0.5
"""Half the width of a 90 % interval; probability that something is missing from which a fit says so."""

KINDS = ("constant force", "mass on a spring")
SPRUNG_EACH = 6
"""Of so many seeds one is of masses on springs."""


@one_thread_of_blas()
def fitted(seed: int) -> dict[str, object]:
    """One case: by how much every parameter is missed, in proportion (entry: s), and in standard deviations."""
    sprung = seed % SPRUNG_EACH == SPRUNG_EACH - 1
    with TemporaryDirectory() as place:
        case = drawn(seed, Path(place), sprung=sprung)
        campaign = read_campaign(case.path)
        fit = recalibrated(gather(campaign, threads=1))
    sigma = np.sqrt(np.diag(fit.spread))
    missed, deviations = {}, {}
    for index, free in enumerate(fit.model.free):
        name, true = free.name, case.true[free.name]
        value = free.value(float(fit.z[index]))
        missed[name] = value - true if name == "t0" else value / true - 1.0
        z = campaign.parameters.known[name].z(true)
        deviations[name] = float((fit.z[index] - z) / sigma[index])
    lacking = bool(fit.hyper.novel > LACKING)
    return {"seed": seed, "kind": KINDS[sprung], "missed": missed, "deviations": deviations, "lacking": lacking}


def summary(cases: list[dict[str, Any]]) -> dict[str, object]:
    """Of all cases of a kind; the first were run before it was kept whether something is called missing."""
    lacking = [c["lacking"] for c in cases if "lacking" in c]
    loads = [abs(v) for c in cases for name, v in c["missed"].items() if name.startswith("P")]
    speeds = [abs(c["missed"]["V"]) for c in cases]
    off = np.abs([v for c in cases for v in c["deviations"].values()])
    every = [(name, value) for case in cases for name, value in case["deviations"].items()]
    held = {
        what: float(np.mean([abs(value) < Z90 for name, value in every if name[0] == what[0]]))
        for what in ("E", "V", "P", "t0", "K")
        if any(name[0] == what[0] for name, _ in every)
    }
    return {
        "cases": len(cases),
        "called_missing": float(np.mean(lacking)),
        "of_cases": len(lacking),
        "loads_missed_median": float(np.median(loads)),
        "loads_missed_90": float(np.quantile(loads, 0.9)),
        "loads_within_3_percent": float(np.mean(np.array(loads) < 0.03)),
        "speeds_missed_90": float(np.quantile(speeds, 0.9)),
        "speeds_within_0.3_percent": float(np.mean(np.array(speeds) < 0.003)),
        "held_by_90_percent": float(np.mean(off < Z90)),
        "held_each": held,
    }


def main() -> None:
    """Run what is missing, then sum up."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("first", type=int, nargs="?", default=0)
    parser.add_argument("count", type=int, nargs="?", default=240)
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    for seed in range(given.first, given.first + given.count):
        path = given.folder / f"{seed}.json"
        if not path.exists():
            path.write_text(json.dumps(fitted(seed)), "utf-8")
    cases = [json.loads(p.read_text("utf-8")) for p in sorted(given.folder.glob("*.json"))]
    by_kind = {kind: [c for c in cases if c["kind"] == kind] for kind in KINDS}
    found = {kind: summary(of_kind) for kind, of_kind in by_kind.items() if of_kind}
    (Path(__file__).parent / "passages.json").write_text(json.dumps(found, indent=1) + "\n", "utf-8")
    print(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
