"""What a name is credited with: little, where its model does not fit."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import pytest
from permway.diagnosis.decide import members
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.search import standing
from permway.diagnosis.speak import _credit, _explains_little, _with_its_form
from permway.diagnosis.verdict import Effect, Estimate
from permway.diagnosis.verdict_parts import Mechanics, Place
from simulated import simulate


@pytest.fixture(scope="module")
def fit(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    return recalibrate(gather(simulate(tmp_path_factory.mktemp("one") / "c", 4).campaign, threads=1))


@pytest.mark.parametrize(("heat", "credit"), [(1.0, 1.0), (1.1, 1.0), (1.43, 1.1 / 1.43), (30.0, 1.1 / 30.0)])
def test_a_name_is_credited_as_far_as_its_model_fits(fit: Fit, heat: float, credit: float) -> None:
    assert _credit(replace(fit, heat=heat)) == pytest.approx(credit)


@pytest.mark.parametrize(
    ("before", "after", "little"),
    [
        (1.0, 1.0, False),
        (1.2, 1.19, False),
        (1.49, 1.48, True),
        (1.49, 1.4, False),
        (9.0, 5.0, True),
        (9.0, 1.4, False),
    ],
)
def test_what_leaves_a_misfit_as_it_was_explains_little(before: float, after: float, little: bool) -> None:
    assert _explains_little(before, after) is little


ROD = Effect(
    domain="path",
    place=Place(joint="pad", x=(25.83, 27.09)),
    bands=((161.0, 256.0),),
    law=Mechanics(words="a rod that waves cross"),
    parameters={"delay_s": Estimate(value=3.1e-5, unit="s", low=3.1e-5, high=3.2e-2)},
)


def test_a_description_that_does_not_fit_is_a_place() -> None:
    """Of a fastener that keeps half, beside a wrong first effect, a rod was told that left a misfit of 39."""
    assert _with_its_form("described", (ROD,), True) == ("described", (ROD,))
    status, (one,) = _with_its_form("described", (ROD,), False)
    assert (status, one.place, one.bands) == ("located", ROD.place, ROD.bands)
    assert not one.parameters
    assert not one.law.words
    assert _with_its_form("named", (ROD,), False) == ("named", (ROD,))


def test_what_was_found_beside_an_effect_is_no_rival_of_it(fit: Fit) -> None:
    def finalist(entry: str) -> Any:
        quick = SimpleNamespace(gain=50.0, hypothesis=SimpleNamespace(entry=entry, free=()))
        return SimpleNamespace(fit=fit, rough=fit, hypothesis=quick.hypothesis, quick=quick, correction=0.0)

    found = cast(Any, SimpleNamespace(finalists=(finalist("a"), finalist("b")), followed=(), ring=None))
    assert {m.name: m.probability for m in members(found, explained=1.0)} == pytest.approx(
        {"a": 0.475, "b": 0.475, "novel": 0.05}
    )
    # It was found itself, in another round.
    assert {m.name: m.probability for m in members(found, explained=1.0, beside=("a", "b"))} == pytest.approx(
        {"a": 0.95, "novel": 0.05}
    )


def test_where_no_finalist_fits_the_blunted_responses_tell_which_does_better(fit: Fit) -> None:
    """Two effects are missing: what the second leaves on sharp responses is no word about the first."""

    def finalist(entry: str, heat: float, sharp: float, blunted: float) -> Any:
        at = replace(fit, heat=heat, chi2=sharp)
        quick = SimpleNamespace(gain=50.0, hypothesis=SimpleNamespace(entry=entry, free=()))
        rough = replace(fit, chi2=blunted)
        return SimpleNamespace(fit=at, rough=rough, hypothesis=quick.hypothesis, quick=quick, correction=0.0)

    def order(heat: float) -> list[str]:
        rivals = [finalist("right", heat, 1040.0, 100.0), finalist("wrong", heat + 0.1, 1000.0, 140.0)]
        return [f.hypothesis.entry for f in sorted(rivals, key=lambda f: -standing(f, rivals))]

    assert order(16.0) == ["right", "wrong"]
    assert order(1.0) == ["wrong", "right"]
    rivals = [finalist("right", 16.0, 1040.0, 100.0), finalist("wrong", 16.1, 1000.0, 140.0)]
    found = cast(Any, SimpleNamespace(finalists=tuple(rivals), followed=(), ring=None))
    assert {m.name: m.probability for m in members(found, explained=1.0)} == pytest.approx(
        {"right": 0.95, "novel": 0.05}
    )


@pytest.mark.parametrize(("fitted", "share"), [((), 0.475), (("b",), None)])
def test_a_rival_that_was_fitted_counts_by_its_fit_alone(
    fit: Fit, fitted: tuple[str, ...], share: float | None
) -> None:
    """It gained more when it was followed, and fell behind when all parameters moved."""
    quick, rival = (
        SimpleNamespace(gain=gain, hypothesis=SimpleNamespace(entry=entry, free=()))
        for entry, gain in (("a", 4575.0), ("b", 13879.0))
    )
    best = SimpleNamespace(fit=fit, rough=fit, hypothesis=quick.hypothesis, quick=quick, correction=0.0)
    found = SimpleNamespace(
        finalists=(best,), followed=(rival, quick), fitted=frozenset(fitted), ring=SimpleNamespace(fit=fit)
    )
    told = {m.name: m.probability for m in members(cast(Any, found), explained=1.0)}
    assert told.get("b") == (None if share is None else pytest.approx(share))
    assert told["a"] == pytest.approx(0.95 if share is None else share)
