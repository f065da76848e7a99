"""Kills sweeps and diagnoses at random times: `python tests/kill/run.py --sweeps 50 --diagnoses 10`.

After each kill every file that is there must be whole; after the last the command is run to its end and must give
what an undisturbed run gives. Temporary files are counted, in the folder and in the system's place for them.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from permway.demo.run import campaign_files

STUDY = """
keep = ["receptance"]
[model.frequencies]
from_Hz = 10.0
to_Hz = 1000.0
points = 40
[model.line.bodies.rail]
type = "beam"
youngs_modulus_Pa = 2.1e11
second_moment_m4 = 3.038e-5
density_kg_per_m3 = 7850.0
area_m2 = 7.67e-3
[model.line.laws.pad]
type = "hysteretic"
stiffness = 6.0e7
loss_factor = 0.2
[[model.line.joints]]
between = ["rail", "ground"]
law = "pad"
at = { from_m = 0.0, to_m = 1.8, spacing_m = 0.6 }
[[model.forces]]
body = "rail"
x_m = 0.9
[[model.sensors]]
body = "rail"
x_m = 1.5
[axes.stiffness]
path = "line.laws.pad.stiffness"
values = { from = 2e7, to = 9e7, count = CASES }
"""


def command(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "permway", *map(str, arguments)]


def killed(arguments: list[object], after_s: float, scratch: Path) -> bool:
    """Start a command and kill it after a while; whether it was still at work."""
    environment = {**os.environ, "TMPDIR": str(scratch), "OPENBLAS_NUM_THREADS": "1"}
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    process = subprocess.Popen(command(*arguments), env=environment, start_new_session=True, **quiet)  # type: ignore[call-overload]
    time.sleep(after_s)
    alive = process.poll() is None
    if alive:
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    return alive


def contents(folder: Path) -> dict[str, bytes]:
    return {p.name: p.read_bytes() for p in folder.iterdir() if p.is_file()} if folder.is_dir() else {}


def sweeps(kills: int, place: Path, chance: random.Random) -> dict[str, Any]:
    """Kill sweeps of one folder, each going on where the last stopped."""
    study, scratch = place / "study.toml", place / "scratch"
    scratch.mkdir()
    study.write_text(STUDY.replace("CASES", str(40 * kills)))
    done = parts = 0
    folder = place / "out"
    seen: dict[str, bytes] = {}
    begin = time.monotonic()
    subprocess.run(command("doctor", "--json"), check=True, capture_output=True)
    start_s = time.monotonic() - begin
    while done < kills:
        if not killed(["sweep", study, "-o", folder, "--threads", 1], chance.uniform(0.5, 2.5) * start_s, scratch):
            break
        done += 1
        there = contents(folder)
        parts += sum(name.endswith(".part") for name in there)
        seen |= {name: content for name, content in there.items() if name.startswith("case-")}
    subprocess.run(command("sweep", study, "-o", folder), check=True, capture_output=True)
    undisturbed = place / "undisturbed"
    subprocess.run(command("sweep", study, "-o", undisturbed), check=True, capture_output=True)
    resumed, expected = contents(folder), contents(undisturbed)
    cases = {name for name in expected if name.startswith("case-")}
    return {
        "kills": done,
        "cases": len(cases),
        "cases there at the last kill": len(seen),
        "cases that differ from an undisturbed sweep": sum(resumed.get(n) != expected[n] for n in cases),
        "cases half-written at a kill": sum(expected[n] != content for n, content in seen.items()),
        "parts left at a kill, taken away at resumption": parts,
        "files left after all": len(set(resumed) - set(expected)),
        "files left in the system's place for them": len(list(scratch.iterdir())),
    }


def diagnoses(kills: int, place: Path, chance: random.Random) -> dict[str, Any]:
    """Kill diagnoses of the embedded campaign, each going on where the last stopped; one that ends begins anew."""
    campaign, scratch = place / "campaign", place / "scratch-of-diagnoses"
    campaign.mkdir()
    scratch.mkdir()
    for name, content in campaign_files().items():
        (campaign / name).write_bytes(content)
    ask = ["diagnose", campaign / "campaign.toml", "--threads", 1, "-o"]
    begin = time.monotonic()
    subprocess.run(command(*ask, place / "undisturbed-diagnosis"), check=True, capture_output=True)
    whole_s = time.monotonic() - begin
    expected = contents(place / "undisturbed-diagnosis")
    done = ended = half = parts = differ = 0
    while done < kills:
        folder = place / f"diagnosis-{ended}"
        was_at_work = killed([*ask, folder], chance.uniform(0.0, 0.6) * whole_s, scratch)
        done += was_at_work
        there = contents(folder)
        parts += sum(name.endswith(".part") for name in there)
        half += sum(there[n] != expected[n] for n in there if n in ("verdict.json", "amended.toml"))
        half += sum(not there[n].rstrip().endswith(b"</html>") for n in there if n == "report.html")
        if not was_at_work:
            differ += set(there) != set(expected)
            ended += 1
    folder = place / f"diagnosis-{ended}"
    subprocess.run(command(*ask, folder), check=True, capture_output=True)
    after_all = contents(folder)
    differ += after_all["verdict.json"] != expected["verdict.json"] or set(after_all) != set(expected)
    return {
        "kills": done,
        "diagnoses that came to their end in spite of them": ended + 1,
        "seconds of an undisturbed one": round(whole_s, 1),
        "files half-written at a kill": half,
        "parts left at a kill": parts,
        "verdicts or files that differ after all": differ,
        "files left in the system's place for them": len(list(scratch.iterdir())),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sweeps", type=int, default=20, help="kills of sweeps")
    parser.add_argument("--diagnoses", type=int, default=10, help="kills of diagnoses")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    chance = random.Random(given.seed)
    account: dict[str, Any] = {"seed": given.seed}
    with tempfile.TemporaryDirectory(prefix="permway-kills-") as place:
        if given.sweeps:
            account["sweep"] = sweeps(given.sweeps, Path(place), chance)
        if given.diagnoses:
            account["diagnose"] = diagnoses(given.diagnoses, Path(place), chance)
    text = json.dumps(account, indent=1)
    print(text)
    if given.json is not None:
        given.json.write_text(text + "\n")


if __name__ == "__main__":
    main()
