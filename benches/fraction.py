"""What part of the processor's peak the chain reaches on one core, and what limits it.

    python benches/fraction.py        # needs cargo, valgrind and objdump; x86-64; writes fraction.json

Callgrind states how often every instruction of the chain's AVX2 code ran (it knows no AVX-512), objdump what it
is: operations, loads and stores of a frequency are counted, not guessed. The same sweep is then timed on the code
that the processor really gets, and held against what small kernels reach: fused products and sums in registers,
loads, and loads with stores. Working sets grow with the line and with how much is kept for the way back.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import tempfile
from collections import Counter
from pathlib import Path

from common import HERE, build, processor

LAYOUTS = ("rail", "viaduct-1", "viaduct-10")
SIZES = (16, 48)
# Layout, points, frequencies: what is kept for the way back is nothing at "middle", the whole line at "ends".
WORKING_SETS = (
    ("viaduct-1", "middle", 512),
    ("viaduct-1", "ends", 512),
    ("viaduct-10", "middle", 128),
    ("viaduct-10", "ends", 128),
    ("viaduct-100", "middle", 64),
    ("viaduct-100", "ends", 64),
)
# Bytes and doubles of a register in the code that callgrind counts.
BYTES, WIDTH = 32, 4


def executed(binary: Path, words: tuple[object, ...]) -> Counter[int]:
    """How often the instruction at each address of the binary ran."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out"
        plain = ["--dump-instr=yes", "--compress-pos=no", "--compress-strings=no", f"--callgrind-out-file={out}"]
        command = ["valgrind", "--tool=callgrind", *plain, str(binary), *map(str, words)]
        subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
        counts, ours, inclusive = Counter(), False, False
        for line in out.read_text().splitlines():
            if line.startswith("ob="):
                ours = Path(line[3:]).name == binary.name
            elif line.startswith("calls="):
                # The line that follows is the cost of the whole call.
                inclusive = True
            elif line.startswith("0x"):
                address, _, cost = line.split()
                if ours and not inclusive:
                    counts[int(address, 16)] += int(cost)
                inclusive = False
        return counts


def kinds(binary: Path) -> dict[int, set[str]]:
    """What the instruction at each address does, for those on vector registers and all that touch memory."""
    text = subprocess.run(
        ["objdump", "-d", "--no-show-raw-insn", binary], check=True, stdout=subprocess.PIPE, text=True
    )
    found = {}
    for line in text.stdout.splitlines():
        match = re.match(r"\s*([0-9a-f]+):\s+(\S+)\s*([^#<]*)", line)
        if not match:
            continue
        name, operands = match[2], match[3].strip()
        what = set()
        vector = name.startswith("v") and "ymm" in operands and (name.endswith("pd") or name.startswith("vmov"))
        if vector:
            if re.match(r"vf(n?m)(add|sub)", name):
                what.add("fused")
            elif name == "vmulpd":
                what.add("product")
            elif name in ("vaddpd", "vsubpd"):
                what.add("sum")
            elif name == "vdivpd":
                what.add("division")
            elif not name.startswith("vmov"):
                what.add("other")
            if "(" in operands:
                what.add("store" if operands.endswith(")") else "load")
        else:
            what.add("scalar")
        found[int(match[1], 16)] = what
    return found


def mix(binary: Path, table: dict[int, set[str]], layout: str) -> dict[str, float]:
    """Instructions of one frequency by kind, and its floating-point operations."""
    few, many = (executed(binary, (layout, "chain", n)) for n in SIZES)
    counts: Counter[str] = Counter()
    for address, times in many.items():
        for kind in table.get(address, {"scalar"}):
            counts[kind] += times - few[address]
        counts["all"] += times - few[address]
    row = {kind: count / (SIZES[1] - SIZES[0]) for kind, count in sorted(counts.items())}
    row["flops"] = WIDTH * (2 * row["fused"] + row["product"] + row["sum"] + row["division"])
    return row


def printed(binary: Path, *words: object) -> dict:
    """What a program of the benches prints."""
    command = [str(binary), *map(str, words)]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout)


def best(reports: list[dict]) -> dict:
    """The most that the kernels reached in all rounds."""
    kinds = [
        {
            key: value if isinstance(value, str) else max(r["kinds"][i][key] for r in reports)
            for key, value in k.items()
        }
        for i, k in enumerate(reports[0]["kinds"])
    ]
    return {key: max(r[key] for r in reports) for key in ("clock_GHz", "pair_gflops")} | {"kinds": kinds}


def measure(peak: Path, line: Path, rounds: int) -> tuple[dict, dict[tuple, float]]:
    """Kernels and sweeps taking turns: the most of those, the least time of these, us per frequency."""
    sweeps = [(layout, "wheels", 512) for layout in LAYOUTS] + list(WORKING_SETS)
    reports, times = [], {}
    for _ in range(rounds):
        reports.append(printed(peak))
        for layout, points, n in sweeps:
            us = printed(line, layout, "chain", n, "--points", points, "--repeat", 7)["us_per_frequency"]
            times[layout, points] = min(us, times.get((layout, points), us))
    return best(reports), times


def shares(row: dict[str, float], most: dict) -> dict[str, float]:
    """Part of the peak, and of the time that each unit alone would need at the rates of the kernels."""
    kind, us = most["kinds"][0], 1e3 * row["us"]
    return {
        "gflops": row["flops"] / us,
        "of_peak": row["flops"] / us / kind["fused_gflops"],
        "arithmetic_share": 2 * WIDTH * (row["fused"] + row["product"]) / kind["fused_gflops"] / us,
        "load_share": BYTES * row["load"] / kind["load_gbytes"] / us,
        "store_share": BYTES * row["store"] / kind["update_gbytes"] / us,
        "scalar_per_period": row["scalar"] / (us * most["clock_GHz"]),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--folder", type=Path, help="of the binaries, if already built")
    parser.add_argument("-o", "--output", type=Path, default=HERE / "fraction.json", help="default: %(default)s")
    options = parser.parse_args()
    names = ("peak", "line", "instructions")
    peak, line, instructions = (options.folder / n if options.folder else build(n) for n in names)
    most, times = measure(peak, line, options.rounds)
    print(json.dumps(most))
    print(
        "| layout | us per frequency | kflop | Gflop/s | of peak | arithmetic | loads | stores | scalar a period |"
    )
    print("|---|---:|---:|---:|---:|---:|---:|---:|---:|")
    table, rows = kinds(instructions), []
    for layout in LAYOUTS:
        row = {"layout": layout, "us": times[layout, "wheels"]} | mix(instructions, table, layout)
        row |= shares(row, most)
        rows.append(row)
        numbers = list(shares(row, most).values())
        print(f"| {layout} | {row['us']:.2f} | {row['flops'] / 1e3:.0f} | {numbers[0]:.1f} |", end=" ")
        print(" | ".join(f"{n:.2f}" for n in numbers[1:]), "|")
    print("\n| layout | points | us per frequency and span |\n|---|---|---:|")
    sets = []
    for layout, points, _ in WORKING_SETS:
        us = times[layout, points] / int(layout.removeprefix("viaduct-"))
        sets.append({"layout": layout, "points": points, "us_per_frequency_and_span": us})
        print(f"| {layout} | {points} | {us:.2f} |")
    report = {"machine": processor(), "peak": most, "chain": rows, "working_sets": sets}
    options.output.write_text(json.dumps(report, indent=2) + "\n")


if __name__ == "__main__":
    main()
