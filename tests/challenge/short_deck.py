"""A campaign on a short deck, for tests."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from permway.challenge.case import Case, Tier, draw, write, write_truth
from permway.challenge.effects import Site
from permway.challenge.layout import Layout, draw_tests
from permway.challenge.plan import Chain, Plan, plan_of
from permway.challenge.run import run
from permway.challenge.score import Scored, score
from permway.diagnosis.catalogue import entries

LAYOUT = Layout(spans=1, bays=26, spacing_m=0.64, approach_bays=14)
TWO_SPANS = Layout(spans=2, bays=41, spacing_m=0.64, approach_bays=14)


def small_case(seed: int = 7, tier: Tier = "null", *, clean: bool = False, layout: Layout = LAYOUT) -> Case:
    """A case of a seed, on a short deck, with lines 4 Hz apart and runs of 8 s."""
    case = draw(seed, tier)
    tests = draw_tests(np.random.default_rng(seed), layout, temperatures=len(case.tests.temperatures_C))
    tests = replace(tests, lines_Hz=(4.0, 400.0, 4.0), seconds=8.0)
    chain = Chain(clean=True) if clean else case.chain
    return replace(case, layout=layout, tests=tests, chain=chain)


def small_site(temperatures: tuple[float, ...] = (20.0, -15.0)) -> Site:
    """Its layout and tests."""
    case = small_case()
    return Site(case.layout, replace(case.tests, temperatures_C=temperatures))


def small_plan(site: Site) -> Plan:
    """Its plan, with nothing in it."""
    return plan_of(site.layout, small_case().true, site.tests, Chain(clean=True))


def scored(folder: Path, seed: int, tier: Tier) -> Scored:
    """A small case, made, diagnosed as a user would and scored."""
    case = small_case(seed, tier)
    write(case, folder / f"{tier}-{seed}")
    (folder / "truth").mkdir()
    write_truth(case, folder / "truth" / f"{tier}-{seed}.json")
    assert run(folder) == {"verdicts": 1, "failed": 0}, [p.read_text() for p in folder.rglob("failed.txt")]
    (one,) = score(folder, {name: entry.FAMILY for name, entry in entries().items()})
    return one
