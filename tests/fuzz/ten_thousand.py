"""Ten thousand random files by the usual writers: `python tests/fuzz/ten_thousand.py [COUNT] [FIRST_SEED]`.

Prints for each format how many were right, refused and wrong, every wrong one with its seed, and ends with 1 if
there is one. The tests of the readers run some hundreds of the same.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "recordings"))

from drawn import outcome
from permway.recordings.readers import hdf5, mat_objects, mat_objects_child
from test_readers_drawn import WRITERS


def main(count: int, first: int) -> int:
    """Run so many files in all, seeds from the first on; the number of wrong ones."""
    began, wrong = time.perf_counter(), 0
    # None of these files is damaged: that libraries come to an end on them need not be tried in a process.
    hdf5.check_sound = lambda _: None
    mat_objects._extract = lambda source, target: mat_objects_child.main(str(source), str(target))
    totals: dict[str, Counter[str]] = {kind: Counter() for kind in WRITERS}
    reasons: Counter[str] = Counter()
    for index in range(count):
        kind = list(WRITERS)[index % len(WRITERS)]
        seed = first + index
        with tempfile.TemporaryDirectory() as folder:
            path, meaning = WRITERS[kind](np.random.default_rng(seed), Path(folder))
            found = outcome(meaning, path)
        result, _, why = found.partition(": ")
        totals[kind][result] += 1
        if result == "wrong":
            wrong += 1
            print(f"{kind}, seed {seed}: {why}", flush=True)
        elif result == "refused":
            reasons[f"{kind}: {why.replace(str(path), '')[:110]}"] += 1
        if (index + 1) % 1000 == 0:
            print(f"{index + 1} files, {wrong} wrong, {time.perf_counter() - began:.0f} s", flush=True)
    for kind, total in totals.items():
        print(f"{kind:<14} right {total['right']:5d}  refused {total['refused']:5d}  wrong {total['wrong']:5d}")
    for reason, times in reasons.most_common(25):
        print(f"{times:5d}  {reason}")
    print(f"{count} files, {wrong} wrong, {time.perf_counter() - began:.0f} s")
    return int(wrong > 0)


if __name__ == "__main__":
    numbers = [int(text) for text in sys.argv[1:]]
    sys.exit(main(*(numbers + [10_000, 0][len(numbers) :])))
