"""What thirty diagnoses of carts found, counted: `python benches/pairs/carts_found.py FOLDER`.

FOLDER is that of `run.py`. Prints a line a pair, damper and spring as found over true, and counts by kind of pair:
in the class (an effect that changes them is in one), right (that, or recalibrated within 8 %), named falsely
(by 0.9, what the cart does not have), and the force constant as a gain.
"""

from __future__ import annotations

import argparse
import tomllib
from itertools import permutations
from pathlib import Path

from oscillators import CART
from permway.diagnosis.verdict import Verdict

NEAR = 0.08

DAMPERS, TRUE = ("layer_damping",), {"owner_value", "layer_damping", "sensor_gain"}
"""Names of a damper beside its stated value; names that are true of a cart."""


def true_values(folder: Path) -> dict[int, tuple[float, float]]:
    """Damper and spring of each file, as its own record has them with the force constant free."""
    found = {}
    for number in CART:
        other = next(n for n in CART if n != number)
        law = stated(folder / f"cart-{number}-{other}")
        found[number] = law["damping"], law["stiffness"]
    return found


def stated(place: Path) -> dict[str, float]:
    """The joint of a pair's model."""
    law: dict[str, float] = tomllib.loads((place / "model.toml").read_text("utf-8"))["line"]["laws"]["joint"]
    return law


def changed(base: int, target: int) -> list[str]:
    """What differs: file 7 has another spring; dampers are as its table has them."""
    damper = {1: 1, 2: 2, 3: 8, 4: 15, 5: 35, 7: 2}
    found = ["damper"] if damper[base] != damper[target] else []
    return found + (["spring"] if (base == 7) != (target == 7) else [])


def main() -> None:
    """Read, print, count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    true, count = true_values(folder), dict[str, dict[str, int]]()
    for base, target in permutations(CART, 2):
        place = folder / f"cart-{base}-{target}"
        if not (place / "out" / "verdict.json").exists():
            continue
        verdict = Verdict.read(place / "out" / "verdict.json")
        law, wanted = stated(place), changed(base, target)
        moved = verdict.recalibrated.after or verdict.recalibrated.before
        found = moved["damper"].value * law["damping"], moved["spring"].value * law["stiffness"]
        ratios = [a / b for a, b in zip(found, true[target], strict=True)]
        classes = [{m.name for m in e.class_} | {str(e.place.body)} for e in verdict.effects]
        held = {
            "damper": any({"damper"} <= c or c & set(DAMPERS) for c in classes),
            "spring": any({"spring"} <= c for c in classes),
        }
        named = [e.name for e in verdict.effects if e.name]
        row = count.setdefault(
            " and ".join(wanted), dict.fromkeys(("pairs", "class", "right", "named", "false", "gain"), 0)
        )
        row["pairs"] += 1
        near = {n: abs(r - 1.0) < NEAR for n, r in zip(held, ratios, strict=True)}
        row["class"] += all(held[n] for n in wanted)
        row["right"] += all(held[n] or near[n] for n in wanted)
        row["named"] += bool(named) and len(named) == len(verdict.effects)
        row["false"] += any(n not in TRUE for n in named)
        row["gain"] += any("sensor_gain" in c for c in classes)
        words = ", ".join(f"{n} {r:.2f}" for n, r in zip(held, ratios, strict=True))
        print(f"{base} {target} {verdict.status:13} {words}; {[sorted(map(str, c)) for c in classes]}")
    for kind, row in count.items():
        print(kind, row)


if __name__ == "__main__":
    main()
