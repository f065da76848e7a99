"""Gates on speed that no other work on the machine disturbs: instructions counted by valgrind.

    python benches/gates.py            # compares with instructions.json; exit status 1 if one grew by over 2 %
    python benches/gates.py --write    # writes instructions.json

Every case runs as two sweeps of different size; the difference is what one more of its unit costs: a frequency
without the set-up, or a support in the set-up and the first eight frequencies, which on a long line must cost what
it does on a short one.
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
# Arguments of `instructions`, where N is the size; the two sizes; the spans of the layout; what is counted.
CASES = {
    "rail, 241 supports, chain": ("rail chain N", (16, 48), 1, "frequency"),
    "rail on sleepers, chain": ("sleepers chain N", (16, 48), 1, "frequency"),
    "viaduct, 1 span, chain": ("viaduct-1 chain N", (16, 48), 1, "frequency"),
    "viaduct, 10 spans, chain": ("viaduct-10 chain N", (8, 24), 10, "frequency"),
    "viaduct, 100 spans, chain": ("viaduct-100 chain N", (8, 16), 100, "frequency"),
    "regular supports, 4000 and 8000, chain": ("regular-N chain 8", (4000, 8000), 1, "support"),
    "irregular supports, 4000 and 8000, chain": ("irregular-N chain 8", (4000, 8000), 1, "support"),
    "irregular supports, 16,000 and 32,000, chain": ("irregular-N chain 8", (16000, 32000), 1, "support"),
    "rail, 241 supports, receptance": ("rail receptance N", (2, 4), 1, "frequency"),
    "viaduct, 1 span, receptance": ("viaduct-1 receptance N", (2, 4), 1, "frequency"),
    "viaduct, 60 modes, receptance": ("viaduct-modes receptance N", (2, 4), 1, "frequency"),
    "dense solve, n = 200": ("dense 200 N", (2, 4), 1, "solve"),
}


def count(binary: Path, *words: object) -> int:
    """Instructions of one run."""
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", binary, *words]
    done = subprocess.run([str(word) for word in command], stderr=subprocess.PIPE, text=True)
    found = re.search(r"Collected : (\d+)", done.stderr)
    if done.returncode or not found:
        raise SystemExit(f"{' '.join(map(str, words))}: valgrind failed\n{done.stderr}")
    return int(found[1])


def each(binary: Path, words: str, sizes: tuple[int, int]) -> float:
    """Instructions of one more of the unit."""
    few, many = (count(binary, *words.replace("N", str(n)).split()) for n in sizes)
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
    print(f"{'case':46} {'per':9} {'instructions':>14} {'per span':>12} {'growth':>8}")
    for name, (words, sizes, spans, unit) in CASES.items():
        now = each(binary, words, sizes)
        rows[name] = {
            "command": f"{COMMAND} {words}",
            "sizes": sizes,
            "unit": unit,
            "per_unit": round(now, 1),
            "per_unit_and_span": round(now / spans, 1),
        }
        growth = now / before["counts"][name]["per_unit"] - 1.0 if before else 0.0
        worst = max(worst, growth)
        print(f"{name:46} {unit:9} {now:14,.0f} {now / spans:12,.0f} {growth:8.2%}", flush=True)
    if options.write:
        text = {"made_by": "python benches/gates.py --write", "path": "AVX2", "tools": tools(), "counts": rows}
        COUNTS.write_text(json.dumps(text, indent=2) + "\n")
    elif worst > GROWTH:
        sys.exit(f"a count grew by {worst:.1%}; {GROWTH:.0%} is allowed")


if __name__ == "__main__":
    main()
