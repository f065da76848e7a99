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
        "056e09e468ab7c1db436d39dd49ccf929d2974a13c57bc84f9b2fe9bc2a6d67e",
        "b921ab7af365a951ed28d86d7cbd5efc71cf91c7b05460b96b9826de5e589c6b",
    ),
    "twin": (
        "0301371a5ab1a600a6cb2f665aae046f2f57b0603b1f18969346b444fd044c98",
        "86d01eb7b96918e70bb5733ef3320e68966e2d728060e44ab03f63666d4eb89e",
    ),
    "multiple": (
        "ada0e473d7b56c9bb62046ee60a5433e8b0d331ad584c4ce18dc99040d2268bd",
        "aa46dab6010a4b294d5856cf88ecf28e1a57b189f0d9988f044e90f334a6f810",
    ),
    "outside": (
        "e7521d41c584ccc11b3c02ded7281521d823b422bdf536c9ec360e50fa4abda9",
        "80ab62cddb32cc9c644d3acda730b04d2f149760f30d5a641fe17e9375eb2016",
    ),
    "nonlinear": (
        "eb5d2919fe59f7494defd2212e142c281bd4210f11a4d884a92b2fac88e3abad",
        "2233d3ab83b6688fdeb5d313efe121d4f8e603e14cf55835378f28a5fcd74bb7",
    ),
    "graded": (
        "284c39455b0df9c5f2e3e9cda58e7d759bf215b613746bc714fef906d40e8652",
        "228541c6c4137a6df24b6a9701e9222c6b58e0b6714b5e508436585d059c0ce2",
    ),
    "sparse": (
        "375b2f3d23d73aa0a2bd109c80bf163d514066e726b42677f4d28bd8492c65b0",
        "f50de3eb655923e891a35d9a8aa1c5f2d54ba6133b776dbb8aac068e9e66a4b3",
    ),
    "running": (
        "e013e9858e8fd1142be20e83fcadceec19bc66d3585a3e24365958f35bab6f40",
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
