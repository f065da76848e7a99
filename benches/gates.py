"""Gates on speed that no other work on the machine disturbs: instructions counted by valgrind.

    python benches/gates.py            # compares with instructions.json; exit status 1 if one grew by over 2 %
    python benches/gates.py --write    # writes instructions.json

Every case runs as two sweeps of different size; the difference is what a frequency costs, without the set-up.
Valgrind knows no AVX-512, so what it counts on x86-64 is the AVX2 code, of the chain and of faer.
"""

import argparse
import json
import platform
import re
import subprocess
import sys
from pathlib import Path

from common import HERE, build, rustc

COUNTS = HERE / "instructions.json"
COMMAND = "valgrind --tool=callgrind --callgrind-out-file=/dev/null instructions"
GROWTH = 0.02
# Arguments of `instructions`, the two sizes, and the spans of the layout.
CASES = {
    "rail, 241 supports, chain": (("rail", "chain"), (16, 48), 1),
    "rail on sleepers, chain": (("sleepers", "chain"), (16, 48), 1),
    "viaduct, 1 span, chain": (("viaduct-1", "chain"), (16, 48), 1),
    "viaduct, 10 spans, chain": (("viaduct-10", "chain"), (8, 24), 10),
    "viaduct, 100 spans, chain": (("viaduct-100", "chain"), (8, 16), 100),
    "rail, 241 supports, receptance": (("rail", "receptance"), (2, 4), 1),
    "viaduct, 1 span, receptance": (("viaduct-1", "receptance"), (2, 4), 1),
    "viaduct, 60 modes, receptance": (("viaduct-modes", "receptance"), (2, 4), 1),
    "dense solve, n = 200": (("dense", "200"), (2, 4), 1),
}


def count(binary: Path, *words: object) -> int:
    """Instructions of one run."""
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", binary, *words]
    done = subprocess.run([str(word) for word in command], stderr=subprocess.PIPE, text=True)
    found = re.search(r"Collected : (\d+)", done.stderr)
    if done.returncode or not found:
        raise SystemExit(f"{' '.join(map(str, words))}: valgrind failed\n{done.stderr}")
    return int(found[1])


def per_frequency(binary: Path, words: tuple[str, ...], sizes: tuple[int, int]) -> float:
    """Instructions of one frequency (or of one dense solve)."""
    few, many = (count(binary, *words, n) for n in sizes)
    return (many - few) / (sizes[1] - sizes[0])


def tools() -> dict[str, str]:
    """What else decides the counts."""
    valgrind = subprocess.run(["valgrind", "--version"], check=True, stdout=subprocess.PIPE, text=True).stdout
    return {"rustc": rustc(), "valgrind": valgrind.strip(), "architecture": platform.machine()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="write the counts instead of comparing")
    parser.add_argument("--binary", type=Path, help="the counted program, if already built")
    options = parser.parse_args()
    binary = options.binary or build("instructions")
    before = {} if options.write else json.loads(COUNTS.read_text())
    if before and before["tools"] != tools():
        print(f"note: the counts were made with {before['tools']}, here is {tools()}")
    rows, worst = {}, 0.0
    print(f"{'case':34} {'per frequency':>14} {'per span':>12} {'growth':>8}")
    for name, (words, sizes, spans) in CASES.items():
        now = per_frequency(binary, words, sizes)
        rows[name] = {
            "command": f"{COMMAND} {' '.join(words)} N",
            "sizes": sizes,
            "per_frequency": round(now, 1),
            "per_frequency_and_span": round(now / spans, 1),
        }
        growth = now / before["counts"][name]["per_frequency"] - 1.0 if before else 0.0
        worst = max(worst, growth)
        print(f"{name:34} {now:14,.0f} {now / spans:12,.0f} {growth:8.2%}", flush=True)
    if options.write:
        text = {"made_by": "python benches/gates.py --write", "path": "AVX2", "tools": tools(), "counts": rows}
        COUNTS.write_text(json.dumps(text, indent=2) + "\n")
    elif worst > GROWTH:
        sys.exit(f"a count grew by {worst:.1%}; {GROWTH:.0%} is allowed")


if __name__ == "__main__":
    main()
