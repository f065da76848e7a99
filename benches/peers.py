"""permway against its peers on the same problems, in one run.

    python benches/peers.py                     # about five minutes
    python benches/peers.py --permway WHEEL     # with a wheel built before

Makes a throw-away virtual environment with rolland (from PyPI; needs Python 3.12 or later), numpy, scipy and
permway from this checkout, runs every side of every case as a process of its own, sides taking turns, one thread
each, and writes peers.json and peers.md: time per frequency, ratio, peak memory, how far the answers lie apart.
A ratio is that of the least times; permway's is the whole public call, from the model to the labelled dataset.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from common import HERE, processor
from peers_table import markdown

SIDES = HERE / "sides"
# Case, the bar, the aim, and the peers: name, script, every so many-th frequency, rounds, repeats in a round.
CASES = (
    ("rail", 500, 2000, (("rolland", 1, 2, 1), ("numpy", 30, 3, 3), ("sparse", 30, 3, 3))),
    ("viaduct-1", 50, 200, (("numpy", 10, 3, 3), ("sparse", 30, 3, 3))),
    ("viaduct-10", 3000, 10000, (("numpy", 375, 3, 2), ("sparse", 60, 3, 2))),
)
# A peer further away than this, in terms of direct receptances, has not solved the same problem.
AGREE = 1e-8
ROLLAND_GIB = 7


def python(wanted: str | None) -> str:
    """An interpreter of at least 3.12."""
    names = [f"python3.{minor}" for minor in range(14, 11, -1)] + ["python3", "python"]
    found = [wanted] if wanted else [path for name in names if (path := shutil.which(name))] + [sys.executable]
    if not wanted:
        found += sorted(map(str, Path.home().glob(".pyenv/versions/3.1[2-9]*/bin/python")))
    for path in found:
        test = [path, "-c", "import sys, venv; sys.exit(sys.version_info < (3, 12))"]
        if subprocess.run(test, stderr=subprocess.DEVNULL).returncode == 0:
            return path
    raise SystemExit(f"none of {found} is a Python of 3.12 or later: name one with --python")


def environment(folder: Path, options: argparse.Namespace) -> tuple[str, dict[str, str]]:
    """Install everybody; the environment's interpreter and the versions."""
    subprocess.run([python(options.python), "-m", "venv", folder], check=True)
    inside = str(folder / ("Scripts" if os.name == "nt" else "bin") / "python")
    install = [inside, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    wheel = options.permway
    if wheel is None:
        subprocess.run([*install, "maturin>=1.9,<2"], check=True)
        build = [inside, "-m", "maturin", "build", "--release", "--quiet", "-i", inside, "-o", folder / "wheels"]
        subprocess.run(build, cwd=HERE.parent, check=True)
        wheel = next((folder / "wheels").glob("*.whl"))
    subprocess.run([*install, "numpy", "scipy", wheel], check=True)
    # An environment that was kept may hold another permway of the same version.
    subprocess.run([*install, "--force-reinstall", "--no-deps", wheel], check=True)
    if subprocess.run([*install, "rolland"]).returncode:
        print("rolland could not be installed: its comparison is left out", file=sys.stderr)
    listed = subprocess.run(
        [*install[:3], "list", "--format", "json"], check=True, stdout=subprocess.PIPE, text=True
    )
    versions = {package["name"]: package["version"] for package in json.loads(listed.stdout)}
    wanted = ("permway", "rolland", "numpy", "scipy")
    return inside, {name: versions[name] for name in wanted if name in versions}


def run(interpreter: str, script: str, *words: object, needed: bool = True) -> Any:
    """What one side states, on one thread; None of a peer that fails."""
    names = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
    surroundings = {**os.environ, **dict.fromkeys(names, "1"), "PYTHONPATH": ""}
    command = [interpreter, str(SIDES / f"{script}_side.py"), *map(str, words)]
    done = subprocess.run(command, env=surroundings, stdout=subprocess.PIPE, text=True)
    if done.returncode:
        if needed:
            raise SystemExit(f"{' '.join(command)} failed")
        print(f"{' '.join(command)} failed: left out", file=sys.stderr)
        return None
    return json.loads(done.stdout)


def least(rows: list[dict]) -> dict:
    """The least times and the most memory of a side's rounds."""
    best = min(rows, key=lambda row: row["ms_per_frequency"])
    best = best | {key: min(row[key] for row in rows) for key in best if key.endswith("ms_per_frequency")}
    best["peak_memory_MiB"] = max(row["peak_memory_MiB"] for row in rows)
    best["median_ms_per_frequency"] = sorted(row["median_ms_per_frequency"] for row in rows)[len(rows) // 2]
    if "difference" in best:
        best["difference"] = max(row["difference"] for row in rows)
    return best


def memory_GiB() -> float:
    """Memory that is free, GiB; where the system does not tell, it counts as enough."""
    info = Path("/proc/meminfo")
    lines = info.read_text().splitlines() if info.exists() else []
    return next((int(line.split()[1]) / 2**20 for line in lines if line.startswith("MemAvailable:")), float("inf"))


def compare(interpreter: str, folder: Path, versions: dict[str, str]) -> list[dict]:
    """All sides of all cases."""
    results = []
    for case, bar, aim, peers in CASES:
        own, others = [], {name: [] for name, *_ in peers if name != "rolland" or "rolland" in versions}
        for turn in range(max(rounds for _, _, rounds, _ in peers)):
            own.append(run(interpreter, "permway", case, "--folder", folder, "--repeat", 15, "--reference"))
            for name, every, rounds, repeat in peers:
                if name not in others or turn >= rounds:
                    continue
                if name == "rolland" and memory_GiB() < ROLLAND_GIB:
                    # It holds all frequencies at once.
                    every *= 10
                words = (case, "--folder", folder, "--every", every, "--repeat", repeat)
                if row := run(interpreter, name, *words, needed=False):
                    others[name].append(row)
        row = {"case": case, "bar": bar, "aim": aim, "permway": least(own), "peers": {}}
        for name, rows in others.items():
            if not rows:
                continue
            peer = least(rows)
            peer["ratio"] = peer["ms_per_frequency"] / row["permway"]["ms_per_frequency"]
            peer["ratio_of_solving"] = (
                peer["solving_ms_per_frequency"] / row["permway"]["solving_ms_per_frequency"]
            )
            peer["ratio_of_processor"] = (
                peer["processor_ms_per_frequency"] / row["permway"]["processor_ms_per_frequency"]
            )
            row["peers"][name] = peer
            if peer["difference"] > AGREE:
                print(f"{case}: {name} differs by {peer['difference']:.1e}: no comparison", file=sys.stderr)
        results.append(row)
        print(f"{case} done", file=sys.stderr, flush=True)
    return results


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", help="a Python of 3.12 or later (default: one on the PATH)")
    parser.add_argument("--permway", type=Path, help="a wheel of permway (default: built from this checkout)")
    parser.add_argument("--environment", type=Path, help="keep the environment here, or use what stands there")
    parser.add_argument(
        "-o", "--output", type=Path, default=HERE / "peers", help="less .json and .md: %(default)s"
    )
    options = parser.parse_args()
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.environment or Path(scratch) / "environment"
        interpreter, versions = environment(folder, options)
        before = processor()
        report = {"machine": before, "versions": versions, "installing_s": round(time.monotonic() - start)}
        report["cases"] = compare(interpreter, Path(scratch), versions)
        report["stations"] = run(interpreter, "scaling", "stations")
        report["threads"] = run(interpreter, "scaling", "threads")
        report["long"] = [run(interpreter, "scaling", "long", "--threads", n) for n in (1, 2)]
    report["load_average_after"] = processor()["load_average"]
    report["whole_s"] = round(time.monotonic() - start)
    options.output.with_suffix(".json").write_text(json.dumps(report, indent=2) + "\n")
    text = markdown(report)
    options.output.with_suffix(".md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
