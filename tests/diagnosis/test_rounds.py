"""Effects one after another: what mends the first is passed over, and other domains are searched."""

from __future__ import annotations

from collections.abc import Iterable
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from permway.diagnosis import rounds
from permway.diagnosis.hypothesis import Where
from permway.diagnosis.search import Round

FITS = SimpleNamespace(heat=1.0, prior=0.0, free=())
EVERY = [SimpleNamespace(domain=domain) for domain in ("path", "vehicle", "irregularity")]


def finalist(name: str, domain: str) -> Any:
    return SimpleNamespace(name=name, hypothesis=SimpleNamespace(domain=domain), fit=FITS, rough=FITS)


def run(
    monkeypatch: pytest.MonkeyPatch, best: dict[tuple[str, ...], list[Any]], needless: tuple[str, str] = ("", "")
) -> tuple[list[str], list[int], Any]:
    """Searches by what they were offered give what they have left; small track effects mend the first."""
    offered: list[int] = []

    def search(start: object, among: Iterable[Any], **_: object) -> Round:
        domains = tuple(h.domain for h in among)
        offered.append(len(domains))
        left = best.get(domains, [])
        return Round(
            cast(Any, None),
            cast(Any, domains),
            (),
            tuple(left[:1]) if not left else (left.pop(0),),
            frozenset(),
            10.0,
        )

    monkeypatch.setattr(rounds, "search", search)
    monkeypatch.setattr(rounds, "Situation", lambda *_: None)
    monkeypatch.setattr(rounds, "hypotheses", lambda *_: EVERY)
    monkeypatch.setattr(rounds, "_of_the_owners", lambda base, every, fit: list(every))
    monkeypatch.setattr(rounds, "_mends", lambda base, accepted, last: last.name == "small")
    monkeypatch.setattr(rounds, "_stands", lambda *_: True)

    def without(base: object, accepted: list[Any], *_: object) -> list[Any]:
        """The first of two names goes when the second comes."""
        goes, comes = needless
        return [one for one in accepted if one.name != goes or accepted[-1].name != comes]

    monkeypatch.setattr(rounds, "_without_needless", without)
    description = SimpleNamespace(instead=lambda result: False, left=lambda fit: ())
    base = cast(Any, FITS)
    every, accepted = rounds.effects(base, base, (), 0, cast(Any, lambda *_: None), cast(Any, description))
    return [cast(Any, one).name for one in accepted], offered, every


ALL, ELSEWHERE = ("path", "vehicle", "irregularity"), ("vehicle", "irregularity")


def test_what_mends_the_first_effect_hides_none_of_another_domain(monkeypatch: pytest.MonkeyPatch) -> None:
    large, small, other = finalist("large", "path"), finalist("small", "path"), finalist("other", "irregularity")
    names, offered, every = run(monkeypatch, {ALL: [large, small], ELSEWHERE: [other]})
    assert names == ["large", "other"]
    assert offered == [3, 3, 2, 3]
    # Sizes that would have been seen are told of all that was tried.
    assert all(one.screened == ALL for one in every)


def test_without_another_the_search_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    large, small = finalist("large", "path"), finalist("small", "path")
    names, offered, every = run(monkeypatch, {ALL: [large, small]})
    assert names == ["large"]
    assert offered == [3, 3, 2]
    assert every[-1].finalists == (small,)


def test_what_mends_it_elsewhere_is_no_effect_either(monkeypatch: pytest.MonkeyPatch) -> None:
    large, small, also = finalist("large", "path"), finalist("small", "path"), finalist("small", "vehicle")
    names, offered, _ = run(monkeypatch, {ALL: [large, small], ELSEWHERE: [also]})
    assert names == ["large"]
    assert offered == [3, 3, 2]


def test_what_was_dropped_may_be_met_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fitted while others were missing it was another than it is; three effects are all that is sought."""
    bent, large, other, right, fourth = (
        finalist(name, domain)
        for name, domain in [
            ("bent", "vehicle"),
            ("large", "path"),
            ("other", "path"),
            ("right", "vehicle"),
            ("fourth", "vehicle"),
        ]
    )
    names, offered, _ = run(monkeypatch, {ALL: [bent, large, other, right, fourth]}, needless=("bent", "other"))
    assert names == ["large", "other", "right"]
    assert offered == [3, 3, 3, 3]


@pytest.mark.parametrize(
    ("entry", "places", "mends"),
    [
        ("mortar_void", ("mortar", "rail"), True),
        ("speed_error", ("speed", "rail"), False),
        ("speed_error", ("speed", "speed"), True),
    ],
)
def test_nothing_mends_what_is_a_number_of_the_recording(
    monkeypatch: pytest.MonkeyPatch, entry: str, places: tuple[str, str], mends: bool
) -> None:
    """A small effect beside a large one, in the same records and octaves."""

    def stand_in(entry: str, what: str) -> Any:
        fit = SimpleNamespace(heat=1.0, prior=0.0, free=(), z=())
        hypothesis = SimpleNamespace(entry=entry, domain="path", locate=lambda _: Where(what))
        return SimpleNamespace(hypothesis=hypothesis, fit=fit, values={})

    monkeypatch.setattr(rounds, "gain_by_cell", lambda before, *_: np.array([[1.0 if before is FITS else 0.001]]))
    first, last = (stand_in(*pair) for pair in zip((entry, "pad_frequency"), places, strict=True))
    assert rounds._mends(cast(Any, FITS), [first], last) is mends
