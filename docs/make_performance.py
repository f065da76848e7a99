"""Writes docs/performance.md from the committed results of the benches: run `python docs/make_performance.py`."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

BENCHES = Path(__file__).parents[1] / "benches"
SIZES = (100, 200, 500, 1000)
"""Of the dense solve, as shown."""
sys.path.insert(0, str(BENCHES))


def _read(name: str) -> dict[str, Any]:
    return json.loads((BENCHES / name).read_text("utf-8"))


def _machine(report: dict[str, Any]) -> str:
    machine = report["machine"]
    return f"{machine['processor']}, {machine['cores']} cores, {', '.join(machine['instructions'])}"


def _part_of_the_peak() -> list[str]:
    report = _read("fraction.json")
    lines = [
        "## Part of the processor's peak",
        "",
        f"{_machine(report)}; {report['peak']['kinds'][0]['fused_gflops']:.1f} Gflop/s a core at the peak.",
        "",
        "| line | us per frequency | kflop | Gflop/s | of the peak |",
        "|---|---:|---:|---:|---:|",
    ]
    for row in report["chain"]:
        numbers = f"{row['us']:.2f} | {row['flops'] / 1e3:.0f} | {row['gflops']:.1f} | {row['of_peak']:.2f}"
        lines.append(f"| {row['layout']} | {numbers} |")
    lines += ["", "| line | forces and sensors | us per frequency and span |", "|---|---|---:|"]
    for row in report["working_sets"]:
        lines.append(f"| {row['layout']} | {row['points']} | {row['us_per_frequency_and_span']:.1f} |")
    return [*lines, ""]


def _instructions() -> list[str]:
    report = _read("instructions.json")
    lines = [
        "## Instructions",
        "",
        f"Counted by valgrind ({report['path']} path, rustc {report['tools']['rustc']}).",
        "`python benches/gates.py` fails if one grows by 2 %.",
        "",
        "Per support: one more support of an infinite rail, for set-up and first eight frequencies.",
        "",
        "| case | instructions | per |",
        "|---|---:|---|",
    ]
    rows = report["counts"].items()
    return [*lines, *(f"| {name} | {row['per_unit']:,.0f} | {row['unit']} |" for name, row in rows), ""]


def _dense() -> list[str]:
    report = _read("dense.json")
    lines = [
        "## A dense complex solve: faer against OpenBLAS",
        "",
        f"{_machine(report)}; faer {report['machine']['faer']}, {report['machine']['lapack']}; one thread.",
        "",
        "| n | OpenBLAS, ms | faer, ms | ratio | faer, Gflop/s |",
        "|---:|---:|---:|---:|---:|",
    ]
    for row in report["rows"]:
        if row["n"] not in SIZES:
            continue
        times = f"{row['openblas_ms']:.4f} | {row['faer_reused_ms']:.4f} | {row['ratio_reused']:.2f}"
        lines.append(f"| {row['n']} | {times} | {row['faer_gflops']:.1f} |")
    return [*lines, ""]


def page() -> str:
    """The page as Markdown."""
    from peers_table import markdown

    peers = markdown(_read("peers.json")).removeprefix("# permway and its peers\n").replace("\n### ", "\n#### ")
    lines = [
        "# Performance",
        "",
        "Times are of a machine that others used at the same time, so they are upper bounds. How each was",
        "measured, and what limits it, is described in `benches/README.md`.",
        "",
        "## Against peers",
        peers.replace("\n#### ", "\n### "),
        *_part_of_the_peak(),
        *_instructions(),
        *_dense(),
    ]
    return "\n".join(lines).rstrip() + "\n"


if __name__ == "__main__":
    (Path(__file__).parent / "performance.md").write_text(page(), "utf-8")
