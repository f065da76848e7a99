"""Seeds of a tier depend on its own name: another tier in the list, or another order, changes no campaign."""

from __future__ import annotations

import hashlib
import json
from typing import Any

import pytest
from permway.challenge import case as drawing
from permway.challenge import suite
from permway.challenge.case import TIERS, draw
from permway.challenge.suite import CASES, suite_of
from permway.challenge.tiers import HASHED, NUMBERS, number_of

SEED_7: dict[Any, tuple[str, str]] = {
    "null": (
        "680995530e2076bc924bbd9e3f9dec5e3e60e7e4c1526986722ddb3192664269",
        "2dcb807d5f728766c8161629b7572640ae21136a8d1a68849f12d7e77c60e0e3",
    ),
    "single": (
        "891941e2f1782fb5f2e308f3bc67e373af76528e4f74d59820009735aa65c553",
        "b921ab7af365a951ed28d86d7cbd5efc71cf91c7b05460b96b9826de5e589c6b",
    ),
    "twin": (
        "7a12afd87537c1f83366827cb2a42dac4b82ccc9772750b5780ae6bcfe280c6d",
        "86d01eb7b96918e70bb5733ef3320e68966e2d728060e44ab03f63666d4eb89e",
    ),
    "multiple": (
        "1a42aa6c3fd7be984e59490eb61cca235acb288e7e16453fe856a74b1e405e38",
        "aa46dab6010a4b294d5856cf88ecf28e1a57b189f0d9988f044e90f334a6f810",
    ),
    "outside": (
        "5ca0ce7e5d380eb0930b16d0ac5e3ef2d4038dfdbc7f84a7d476dc60d97370fb",
        "80ab62cddb32cc9c644d3acda730b04d2f149760f30d5a641fe17e9375eb2016",
    ),
    "nonlinear": (
        "14a80eaad74370ed6b286e296c7f6b7c07b36a5e098e5505018b367cedbe5258",
        "2233d3ab83b6688fdeb5d313efe121d4f8e603e14cf55835378f28a5fcd74bb7",
    ),
    "graded": (
        "c400d42dabb940b2c3e27dd5dc56bf9019189576177d4b94e725d4d8fe5a1fa4",
        "228541c6c4137a6df24b6a9701e9222c6b58e0b6714b5e508436585d059c0ce2",
    ),
    "sparse": (
        "c14105e2a5be8abc72cfb3d584fbc3f0f29b89e68924aa6887ad46eb416836e2",
        "f50de3eb655923e891a35d9a8aa1c5f2d54ba6133b776dbb8aac068e9e66a4b3",
    ),
    "running": (
        "d7a09e5014c90ecb69b329eb006af8da7f87ea41104aa842178e21ffb7db5edb",
        "4b2494df5680ae0c6f6830657328c766f26564b54251524499ea3a599ce5fc4a",
    ),
}
"""SHA-256 of `truth.json` and of `sheet.json` of seed 7, of each tier that has a number by hand."""

SUITE_700000 = "ea5e680bdaf08a2a39c7d9f2d39c8c8c9308ed744f47b0edcf245896aa000f15"
"""SHA-256 of the tiers and seeds of the suite 700000, in their order."""

FIRST_TIERS: tuple[Any, ...] = ("null", "single", "twin", "multiple", "outside", "nonlinear", "graded")


def hashed(content: Any) -> str:
    return hashlib.sha256((json.dumps(content, indent=1) + "\n").encode()).hexdigest()


@pytest.mark.parametrize("tier", SEED_7)
def test_a_seed_makes_the_campaign_that_it_made(tier: Any) -> None:
    made = draw(7, tier)
    assert (hashed(made.truth), hashed(made.sheet)) == SEED_7[tier]


def test_a_suite_has_the_seeds_that_it_had(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(suite, "CASES", {tier: CASES[tier] for tier in FIRST_TIERS})
    found = [(one.tier, one.seed) for one in suite_of(700000)]
    assert hashlib.sha256(repr(found).encode()).hexdigest() == SUITE_700000


def test_another_tier_or_another_order_changes_no_campaign(monkeypatch: pytest.MonkeyPatch) -> None:
    before = [draw(3, tier).truth for tier in SEED_7]
    monkeypatch.setattr(drawing, "TIERS", ("invented", *reversed(TIERS)))
    assert [draw(3, tier).truth for tier in SEED_7] == before


def test_another_tier_or_another_order_changes_no_seed_of_a_suite(monkeypatch: pytest.MonkeyPatch) -> None:
    before = suite_of(10)
    more: dict[Any, int] = {"invented": 50, **dict(reversed(CASES.items()))}
    monkeypatch.setattr(suite, "CASES", more)
    assert [one for one in suite_of(10) if one.tier in CASES] == before


def test_every_tier_has_a_number_of_its_own() -> None:
    numbers = [number_of(tier) for tier in TIERS]
    assert len(set(numbers)) == len(numbers)
    assert number_of("invented") == number_of("invented")
    assert HASHED[0] <= number_of("invented") < HASHED[1]
    assert max(NUMBERS.values()) < HASHED[0]
