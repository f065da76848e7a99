"""Makes campaigns of measured pairs and diagnoses each: `python benches/pairs/run.py FOLDER [NAME ...]`.

Needs the recordings beside the repository. What is in FOLDER already is not made or diagnosed again; NAME takes
those whose names begin so. Prints a line each: seconds of processor, status, what is stated with its class,
decibels of what was left out, before and after. Each has four minutes of processor at most.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from beam import beams
from oscillators import carts, reuss, silverbox
from pair_folders import RECORDINGS
from permway.campaign.importers.rubber_rig import import_rubber_rig
from permway.campaign.importers.track_decay import import_track_decay
from permway.diagnosis.verdict import Verdict
from truss import passage

LIMIT_S = 240
"""Of processor."""


def rubbers(folder: Path) -> dict[str, Path]:
    """Both rubbers, with their DMA and as a data sheet has them."""
    found = {}
    for law, name in (("constant", "sheet"), ("fractional_zener", "dma")):
        made = import_rubber_rig(RECORDINGS / "rubber-rig", folder / f"rubber-{name}", law=law)
        found |= {f"rubber-{name}-{c.folder.name}": c.folder / "campaign.toml" for c in made}
    return found


def decay(folder: Path) -> dict[str, Path]:
    """The reference section's decay rates."""
    made = import_track_decay(RECORDINGS / "track-decay", folder / "track-decay")
    return {"track-decay": made.folder / "campaign.toml"}


def bridge(folder: Path) -> dict[str, Path]:
    """The passage at 40 km/h; the other is for `truss_held_out.py`."""
    return {"truss-40": passage(folder, 40)}


MADE: dict[str, Callable[[Path], dict[str, Path]]] = {
    "cart": carts,
    "piezo": beams,
    "silverbox": silverbox,
    "reuss": reuss,
    "truss": bridge,
    "rubber": rubbers,
    "track": decay,
}


def line_of(verdict: Verdict) -> str:
    """One line."""
    effects = []
    for effect in verdict.effects:
        members = ", ".join(f"{m.name} {m.probability:.2f}" for m in effect.class_)
        words = effect.law.words if effect.law is not None else ""
        effects.append(f"[{members}] {effect.place.body or effect.place.joint or ''}: {words}")
    levels = [(g.db_before, g.db_after) for g in verdict.held_out.values() if g.db_before is not None]
    dB = np.array([pair for pair in levels if None not in pair], dtype=float)
    moved = f"; {np.sqrt(np.mean(dB**2, axis=0)).round(2).tolist()} dB" if dB.size else ""
    return f"{verdict.status}: {'; '.join(effects)}{moved}"


def main() -> None:
    """Make, diagnose, print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*", default=[""])
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    for begins, make in MADE.items():
        if not any(begins.startswith(name[: len(begins)]) for name in given.names):
            continue
        there = sorted(given.folder.glob(f"{begins}*/**/campaign.toml"))
        made = {"-".join(path.parent.relative_to(given.folder).parts): path for path in there}
        for name, path in (made or make(given.folder)).items():
            if not name.startswith(tuple(given.names)):
                continue
            into = path.parent / "out"
            before = _processor_s()
            if not (into / "verdict.json").exists():
                where = ["--allow-outside", "--threads", "1", "-o", str(into)]
                command = [sys.executable, "-m", "permway", "diagnose", str(path), *where]
                done = subprocess.run(command, capture_output=True, text=True, preexec_fn=_limited, check=False)
                if done.returncode:
                    last = (done.stderr.strip().splitlines() or ["no message"])[-1]
                    print(f"{name}: status {done.returncode}, {_processor_s() - before:.0f} s: {last}", flush=True)
                    continue
            verdict = Verdict.read(into / "verdict.json")
            print(f"{name} ({_processor_s() - before:.0f} s) {line_of(verdict)}", flush=True)


def _processor_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _limited() -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (LIMIT_S, LIMIT_S))


if __name__ == "__main__":
    main()
