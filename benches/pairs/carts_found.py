"""What thirty diagnoses of carts found, counted: `python benches/pairs/carts_found.py FOLDER`.

FOLDER is that of `run.py`. Prints a line a pair, damper and spring as found over true, and counts by kind of pair:
in the class (an effect that changes them is in one), within 8 % (as recalibrated or amended), named falsely
(by 0.9, what the cart does not have), and the force constant as a gain.
"""

from __future__ import annotations

import argparse
import tomllib
from itertools import permutations
from pathlib import Path

from oscillators import CART
from pair_folders import RECORDINGS
from permway.diagnosis.verdict import Verdict

NEAR = 0.08
OWN_SPRING, OWN_DAMPER = 761.0, 0.36
"""Of the rig, N/m and N s/m: as one fit to all files has them."""

DAMPERS, TRUE = ("layer_damping",), {"owner_value", "layer_damping", "sensor_gain"}
"""Names of a damper beside its stated value; names that are true of a cart."""


def true_values() -> dict[int, tuple[float, float]]:
    """Damper and spring of each file with the rig's own."""
    rows = (RECORDINGS / "cmu-cart" / "truth.csv").read_text("utf-8").split()[1:]
    cells = [row.split(",") for row in rows]
    return {int(c[0][4:-4]): (float(c[2]) + OWN_DAMPER, float(c[3]) + OWN_SPRING) for c in cells}


def main() -> None:
    """Read, print, count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    true, count = true_values(), dict[str, dict[str, int]]()
    for base, target in permutations(CART, 2):
        place = folder / f"cart-{base}-{target}"
        if not (place / "out" / "verdict.json").exists():
            continue
        verdict = Verdict.read(place / "out" / "verdict.json")
        law = tomllib.loads((place / "model.toml").read_text("utf-8"))["line"]["laws"]["joint"]
        moved = verdict.recalibrated.after or verdict.recalibrated.before
        found = moved["damper"].value * law["damping"], moved["spring"].value * law["stiffness"]
        ratios = [a / b for a, b in zip(found, true[target], strict=True)]
        classes = [{m.name for m in e.class_} | {e.place.body} for e in verdict.effects]
        wanted = [n for n, a, b in zip(("damper", "spring"), true[base], true[target], strict=True) if a != b]
        held = {
            "damper": any({"damper"} <= c or c & set(DAMPERS) for c in classes),
            "spring": any({"spring"} <= c for c in classes),
        }
        named = [e.name for e in verdict.effects if e.name]
        row = count.setdefault(
            " and ".join(wanted), dict.fromkeys(("pairs", "class", "near", "named", "false", "gain"), 0)
        )
        row["pairs"] += 1
        row["class"] += all(held[n] for n in wanted)
        row["near"] += all(abs(dict(zip(held, ratios, strict=True))[n] - 1.0) < NEAR for n in wanted)
        row["named"] += bool(named) and len(named) == len(verdict.effects)
        row["false"] += any(n not in TRUE for n in named)
        row["gain"] += any("sensor_gain" in c for c in classes)
        words = ", ".join(f"{n} {r:.2f}" for n, r in zip(held, ratios, strict=True))
        print(f"{base} {target} {verdict.status:13} {words}; {[sorted(map(str, c)) for c in classes]}")
    for kind, row in count.items():
        print(kind, row)


if __name__ == "__main__":
    main()
