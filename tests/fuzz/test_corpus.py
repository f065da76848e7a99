"""Inputs that once broke the law of fuzzing, and a few of each target that never did."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.extend([str(Path(__file__).parent), str(Path(__file__).parents[1] / "recordings")])

from run import attempt
from targets import TARGETS

CORPUS = sorted((Path(__file__).parent / "corpus").iterdir())


@pytest.mark.parametrize("path", CORPUS, ids=lambda path: path.name)
def test_what_once_broke_the_law_keeps_it(path: Path, tmp_path: Path) -> None:
    target, _, name = path.name.split("-", 2)
    outcome, stated = attempt(target, name, path.read_bytes(), tmp_path)
    assert outcome in ("read", "refused"), stated


def test_every_target_reads_its_own_undamaged_seed(tmp_path: Path) -> None:
    """Or else all that is fuzzed is the first check."""
    from damage import toml
    from targets import DMA, LAW, Campaigns, seed_file, tables

    seeds = {
        "readers": ("a.uff", seed_file("a.uff")),
        "hdf5": ("a.h5", seed_file("a.h5")),
        "tables": ("dma.csv", DMA),
        "model": ("model.toml", toml(tables()[1])),
        "campaign": ("campaign.toml", toml(Campaigns._seed()[0])),
        "core": ("core.txt", b"0"),
    }
    assert set(seeds) <= set(TARGETS)
    for target, (name, content) in seeds.items():
        place = tmp_path / target
        place.mkdir()
        expected = ("read", "refused") if target == "core" else ("read",)
        outcome, stated = attempt(target, name, content, place)
        assert outcome in expected, f"{target}: {stated}"
    (tmp_path / "law.toml").write_bytes(LAW)
