"""Fuzzing guided by coverage, with atheris: `python tests/fuzz/guided.py --target readers --inputs 10000`.

The same targets and the same law as :mod:`run`, from the same seeds; stops at the first input that breaks the law.
The file's name, which states its format, follows from the input's first byte.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import warnings
from pathlib import Path

import atheris

sys.path.extend([str(Path(__file__).parent), str(Path(__file__).parents[1] / "recordings")])

with atheris.instrument_imports(include=["permway"]):
    import permway.recordings.readers  # noqa: F401
    from run import attempt
    from targets import HDF5, PLAIN, Campaigns, Tables, seed_file, tables, toml


def seeds(target: str) -> dict[str, bytes]:
    """Valid files of a target, by name."""
    if target == "readers":
        return {name: seed_file(name) for name in PLAIN if name not in HDF5}
    if target == "tables":
        return dict(Tables.files)
    table = Campaigns._seed()[0] if target == "campaign" else tables()[1]
    return {f"{target}.toml": toml(table)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--target", choices=["readers", "tables", "model", "campaign"], default="readers")
    parser.add_argument("--inputs", type=int, default=10_000)
    given = parser.parse_args()
    known = seeds(given.target)
    names = sorted(known)
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory(prefix="permway-fuzz-") as place:
        corpus = Path(place) / "seeds"
        corpus.mkdir()
        for index, name in enumerate(names):
            (corpus / name).write_bytes(bytes([index]) + known[name])

        def one(data: bytes) -> None:
            if not data:
                return
            outcome, stated = attempt(given.target, names[data[0] % len(names)], data[1:], Path(place))
            if outcome == "broken":
                raise AssertionError(stated)

        limits = [f"-runs={given.inputs}", "-timeout=30", "-rss_limit_mb=3000", "-max_len=20000"]
        atheris.Setup([sys.argv[0], *limits, str(corpus)], one)
        atheris.Fuzz()


if __name__ == "__main__":
    main()
