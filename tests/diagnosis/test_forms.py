"""Which hypotheses are fitted in full: of several effects, and of several forms of one."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
from permway.diagnosis.choose import BEYOND, elsewhere, finalists_of
from permway.diagnosis.hypothesis import Hypothesis, Where, linear_free
from permway.diagnosis.quick import Quick

RING = cast(Any, SimpleNamespace(fit=SimpleNamespace(deviations=np.zeros(2000))))


def quick(entry: str, gain: float, *names: str, at_m: float = 0.0) -> Quick:
    free = tuple(linear_free(name, "1", 0.0, 1.0, -5.0, 5.0) for name in names)
    hypothesis = Hypothesis(
        entry=entry,
        domain="path",
        family=f"family of {entry}",
        free=free,
        amend=lambda campaign, _: campaign,
        locate=lambda _: Where(x_m=(at_m, at_m)),
        starts=((0.0,) * len(free),),
    )
    return Quick(hypothesis, np.zeros(len(free)), np.zeros(0), gain)


def said(*followed: Quick) -> list[tuple[str, float]]:
    return [(q.hypothesis.entry, q.gain) for q in finalists_of(followed, RING, 10.0)]


def test_of_one_form_the_best_and_of_a_second_form_what_does_nearly_as_well() -> None:
    bend, cut = ("pitch_m", "stiffness"), ("pitch_m",)
    found = said(quick("joints", 900.0, *bend), quick("joints", 880.0, *bend), quick("joints", 800.0, *cut))
    assert found == [("joints", 900.0), ("joints", 800.0)]
    # A form that does much worse at once will hardly do better in the end.
    assert said(quick("joints", 900.0, *bend), quick("joints", 500.0, *cut)) == [("joints", 900.0)]


def test_three_effects_at_most_and_none_far_behind_or_below_the_threshold() -> None:
    names = ["a", "b", "c", "d"]
    assert said(*(quick(n, 900.0 - i, "size") for i, n in enumerate(names))) == [
        ("a", 900.0),
        ("b", 899.0),
        ("c", 898.0),
    ]
    assert said(quick("a", 900.0, "size"), quick("b", 200.0, "size")) == [("a", 900.0)]
    assert said(quick("a", 15.0, "size")) == []


def fitted(z: float, name: str = "bearing.k") -> Any:
    parameters = SimpleNamespace(known={"bearing.k": None})
    evidence = SimpleNamespace(campaign=SimpleNamespace(parameters=parameters))
    return SimpleNamespace(free=(SimpleNamespace(name=name),), z=np.array([z]), evidence=evidence)


def test_another_place_is_fitted_where_the_place_is_no_constant() -> None:
    first, other = quick("bearing", 900.0, "factor"), quick("bearing", 700.0, "factor", at_m=32.0)
    third = quick("bearing", 600.0, "factor", at_m=64.0)
    followed = [first, quick("bearing", 880.0, "factor"), quick("crack", 800.0, "factor", at_m=9.0), other, third]
    assert elsewhere([(first, fitted(0.0))], followed) == [other]
    assert elsewhere([(first, fitted(0.0)), (other, fitted(0.0))], followed) == [third]
    assert elsewhere([], followed) == []


def test_where_it_is_one_another_is_fitted_if_the_first_asks_for_what_nobody_would_believe() -> None:
    first, other = quick("hung", 900.0, "x_m"), quick("hung", 700.0, "x_m", at_m=32.0)
    assert elsewhere([(first, fitted(-BEYOND - 1.0))], [first, other]) == [other]
    assert elsewhere([(first, fitted(BEYOND - 1.0))], [first, other]) == []
    # The effect's own size may be what it likes.
    assert elsewhere([(first, fitted(9.0, "1.mass_kg"))], [first, other]) == []


def test_another_place_that_does_as_well_is_fitted_too() -> None:
    """Absorbers all along the rail, and on the deck alone: a step from the base does not tell which."""
    deck, rail = quick("absorber", 9000.0, "mass_kg"), quick("absorber", 8990.0, "mass_kg", at_m=9.0)
    between = quick("absorber", 8950.0, "mass_kg", "share")
    found = finalists_of([deck, rail, between], RING, 10.0)
    assert [id(q) for q in found] == [id(deck), id(between), id(rail)]
    assert said(deck, quick("absorber", 8800.0, "mass_kg", at_m=9.0)) == [("absorber", 9000.0)]
    # Where the place is free the best one reaches the other.
    hung = quick("hung", 900.0, "mass_kg", "x_m"), quick("hung", 899.0, "mass_kg", "x_m", at_m=2.0)
    assert said(*hung) == [("hung", 900.0)]


def test_elements_are_rivals_of_each_other_however_far_behind_after_a_quick_look() -> None:
    """A relaxation that the quick look put at 742, beside a resonator's 1251, explained everything in full."""
    resonator, maxwell = quick("novel", 1251.0, "mass_kg", "frequency_Hz"), quick("novel", 742.0, "stiffness")
    assert said(resonator, maxwell, quick("novel", 300.0, "order")) == [("novel", 1251.0), ("novel", 742.0)]
