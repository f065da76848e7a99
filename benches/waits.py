"""What people wait for, before and after: `python benches/waits.py --before PYTHON --after PYTHON`.

A side is a Python with a permway, or one Python with two folders to find permway in (`--before-path`,
`--after-path`). Every part runs in a process of its own, sides take turns, and medians of the rounds count. The
table goes into benches/README.md.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from common import HERE, processor

SIDE, MODEL, README = (
    HERE / "sides" / "waits_side.py",
    HERE.parent / "examples" / "viaduct.toml",
    HERE / "README.md",
)
MARKS = "<!-- waits: written by waits.py -->", "<!-- end of waits -->"
MISSING = 3
"""Status of a part that this side has not."""


@dataclass(frozen=True)
class Part:
    """Something to wait for; `own` is the key and the format of what it measures of itself."""

    name: str
    title: str
    words: tuple[tuple[str, ...], ...]
    """Arguments after `python`; further ones are tried where a side lacks the first."""
    own: tuple[str, str] | None = None
    larger_is_better: bool = False


PARTS = (
    Part("import", "`import permway`", (("-c", "import permway"),)),
    Part("first", "... and its first function", (("-c", "import permway; permway.receptance"),)),
    Part(
        "solve",
        "`permway solve` of the paper's model",
        (("-m", "permway", "solve", str(MODEL), "-o", "{out}/a.nc"),),
    ),
    Part("demo", "`permway demo`", (("-m", "permway", "demo", "--no-open", "-o", "{out}/demo"),)),
    Part(
        "small",
        "a small diagnosis",
        ((str(SIDE), "diagnosis", "{small}"), (str(SIDE), "diagnosis_before", "{small}")),
    ),
    Part(
        "whole",
        "a whole diagnosis",
        ((str(SIDE), "diagnosis", "{whole}"), (str(SIDE), "diagnosis_before", "{whole}")),
    ),
    Part(
        "irregular",
        "32,000 irregular supports: set-up and 8 frequencies",
        ((str(SIDE), "irregular"),),
        ("s", ".3f"),
    ),
    Part(
        "stations", "cost of a span on 200 spans over that on one", ((str(SIDE), "stations"),), ("growth", ".2f")
    ),
    Part(
        "threads",
        "one thread over two, least of 1 and 10 spans",
        ((str(SIDE), "threads"),),
        ("least", ".2f"),
        True,
    ),
    Part(
        "build",
        "a release build from nothing, dependencies at hand",
        (
            (
                *("-m", "maturin", "build", "--release", "--offline", "-m", "{tree}/rust/bindings/Cargo.toml"),
                *("--target-dir", "{out}/target", "-o", "{out}"),
            ),
        ),
    ),
)
LONG = {"demo": 3, "small": 3, "build": 1}
"""Rounds at most, of parts that take long."""


@dataclass(frozen=True)
class Side:
    """A Python, where it finds permway, and the sources it is built from."""

    python: str
    path: str | None
    tree: str | None = None

    def run(self, words: tuple[str, ...], log: Any) -> tuple[int, str, dict[str, float]]:
        """Status, output, and seconds on the clock and of the processor, the processes it starts included."""
        env = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
        if self.path:
            env["PYTHONPATH"] = self.path
        with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryDirectory() as here:
            start = time.perf_counter()
            child = subprocess.Popen([self.python, *words], stdout=out, stderr=log, env=env, cwd=here)
            _, status, used = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
            spent = {"s": time.perf_counter() - start, "processor_s": used.ru_utime + used.ru_stime}
            out.seek(0)
            return child.returncode, out.read(), spent

    def measure(self, part: Part, given: dict[str, str]) -> dict[str, Any] | None:
        """One round of a part; None where this side lacks it."""
        for words in part.words:
            with tempfile.TemporaryDirectory() as out, tempfile.TemporaryFile("w+") as log:
                status, text, spent = self.run(
                    tuple(w.format(out=out, tree=self.tree, **given) for w in words), log
                )
                if status == 0:
                    own = json.loads(text) if SIDE.name in words[0] else {}
                    return {**spent, **{f"own_{key}": value for key, value in own.items()}}
                log.seek(0)
                printed = log.read()
                # Usage (2) is a command or a key of a file that this side does not know.
                if status not in (2, MISSING) and "InputError" not in printed:
                    raise SystemExit(f"{part.name}: status {status}\n{printed}")
                print(f"{part.name}: lacks {' '.join(words[:3])}: {printed.strip()[-200:]}", file=sys.stderr)
        return None


def measured(part: Part, sides: dict[str, Side], rounds: int, given: dict[str, str]) -> dict[str, Any]:
    """All rounds of a part, sides in turns."""
    found: dict[str, list[dict[str, Any]] | None] = {name: [] for name in sides}
    for _ in range(min(rounds, LONG.get(part.name, rounds))):
        for name, side in sides.items():
            if (rows := found[name]) is None:
                continue
            row = side.measure(part, given)
            print(f"{part.name}, {name}: {row}", file=sys.stderr, flush=True)
            found[name] = None if row is None else [*rows, row]
    return {**found, "load_average": round(os.getloadavg()[0], 2)}


def middle(rows: list[dict[str, Any]] | None, key: str) -> float | None:
    """Median of a key; None where the side lacks the part."""
    return None if not rows else statistics.median(row[key] for row in rows)


def _cells(before: float | None, after: float | None, form: str, larger: bool) -> list[str]:
    shown = ["-" if value is None else f"{value:{form}}" for value in (before, after)]
    if before is None or after is None:
        return [*shown, "-"]
    return [*shown, f"{after / before if larger else before / after:.2f}"]


def _rounds(report: dict[str, Any]) -> str:
    counts = sorted({len(row[name] or ()) for row in report["parts"].values() for name in report["sides"]} - {0})
    return f"{counts[0]} rounds" if len(counts) == 1 else f"{counts[0]} to {counts[-1]} rounds"


def table(report: dict[str, Any]) -> str:
    """The report as Markdown."""
    machine, sides = report["machine"], report["sides"]
    cores = {side["core"] for side in sides.values()}
    loads = [row["load_average"] for row in report["parts"].values()]
    lines = [
        f"{machine['processor']}, {machine['cores']} cores, {', '.join(machine['instructions'])}; "
        f"before: {sides['before']['name']}, after: {sides['after']['name']}; medians of {_rounds(report)}, in "
        "turns.",
        "Seconds of whole processes, and of the processor in them and in those they start; ratios: before over "
        "after.",
    ]
    if len(cores) == 1:
        lines.append("Both sides had the **same compiled core**: what the core gained is not in this table.")
    if max(loads) > 1.0:
        lines.append(
            f"The machine was **busy** (load {min(loads):.0f} to {max(loads):.0f}): times on the clock say "
            "little,\nthose of the processor are of use; one thread over two cannot be judged."
        )
    lines += [
        "",
        "| what | before, s | after, s | ratio | processor before, s | after, s | ratio |",
        "|---|---:|---:|---:|---:|---:|---:|",
    ]
    for part in (p for p in PARTS if p.name in report["parts"]):
        row = report["parts"][part.name]
        before, after = row["before"], row["after"]
        if part.own is None:
            cells = _cells(middle(before, "s"), middle(after, "s"), ".3g", False)
            cells += _cells(middle(before, "processor_s"), middle(after, "processor_s"), ".3g", False)
        else:
            key, form = f"own_{part.own[0]}", part.own[1]
            cells = _cells(middle(before, key), middle(after, key), form, part.larger_is_better)
            cells = [*cells, "", "", ""] if part.name == "threads" else ["", "", "", *cells]
        lines.append(f"| {part.title} | {' | '.join(cells)} |")
    return "\n".join(lines)


def placed(text: str, marks: tuple[str, str], content: str) -> str:
    """A page with other content between its marks."""
    head, begin, rest = text.partition(marks[0])
    _, end, tail = rest.partition(marks[1])
    if not begin or not end:
        raise SystemExit(f"no {marks[0]} and {marks[1]} in the page")
    return f"{head}{begin}\n\n{content}\n\n{end}{tail}"


def main() -> None:
    """Measure, write the results, and put the table into the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for side in ("before", "after"):
        parser.add_argument(f"--{side}", default=sys.executable, help="Python")
        parser.add_argument(f"--{side}-path", help="folder in which it finds permway")
        parser.add_argument(f"--{side}-tree", help="its sources, for the part build, which takes minutes")
        parser.add_argument(f"--{side}-name", default=side, help="a commit, say: stands in the table")
    parser.add_argument("-o", "--output", type=Path, default=HERE / "waits.json")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--whole", metavar="CAMPAIGN", help="campaign file of a whole diagnosis; takes minutes")
    parser.add_argument("--only", nargs="+", choices=[p.name for p in PARTS], help="these parts")
    parser.add_argument("--add", action="store_true", help="keep the other parts of the results that are there")
    parser.add_argument("--render", action="store_true", help="write the table alone, of results that are there")
    options = parser.parse_args()
    if not options.render:
        report = run(options)
        options.output.write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    report = json.loads(options.output.read_text("utf-8"))
    README.write_text(placed(README.read_text("utf-8"), MARKS, table(report)), encoding="utf-8")


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Results of all parts that are wanted."""
    sides, stated = {}, {}
    for name in ("before", "after"):
        python, path, tree, label = (getattr(options, f"{name}{end}") for end in ("", "_path", "_tree", "_name"))
        sides[name] = Side(python, *(str(Path(p).resolve()) if p else None for p in (path, tree)))
        status, text, _ = sides[name].run((str(SIDE), "about"), None)
        if status:
            raise SystemExit(f"{name}: no permway here")
        stated[name] = {"name": label, **json.loads(text)}
    trees = all(side.tree for side in sides.values())
    possible = {"whole": bool(options.whole), "build": trees}
    wanted = options.only or [p.name for p in PARTS if possible.get(p.name, True)]
    if "build" in wanted and not trees:
        raise SystemExit("build: name the sources of both by --before-tree and --after-tree")
    if "whole" in wanted and not options.whole:
        raise SystemExit("whole: name its campaign by --whole")
    parts: dict[str, Any] = {}
    if options.add:
        there = json.loads(options.output.read_text("utf-8"))
        if there["sides"] != stated:
            raise SystemExit(f"--add: {options.output.name} compares other sides: {there['sides']}")
        parts = there["parts"]
    with tempfile.TemporaryDirectory() as folder:
        status, _, _ = sides["after"].run((str(SIDE), "small", folder), None)
        if status:
            raise SystemExit("after: has no small campaign")
        given = {"small": f"{folder}/campaign.toml", "whole": str(Path(options.whole or ".").resolve())}
        for part in (p for p in PARTS if p.name in wanted):
            parts[part.name] = measured(part, sides, options.rounds, given)
    return {"machine": processor(), "sides": stated, "parts": parts}


if __name__ == "__main__":
    main()
