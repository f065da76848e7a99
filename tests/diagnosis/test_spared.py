"""Rivals that a search spares itself, for one of more constants explains what blunted responses leave."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from permway.diagnosis import search


def quick(name: str, gain: float) -> Any:
    return SimpleNamespace(name=name, gain=gain, hypothesis=SimpleNamespace(entry=name, domain="path"))


def fit(objective: float, heat: float) -> Any:
    evidence = SimpleNamespace(forget=lambda: None)
    return SimpleNamespace(objective=objective, heat=heat, log_evidence=-objective, evidence=evidence)


ATTACHMENT, BEARING = quick("deck_attachment", 33797.0), quick("bearing_stiffness", 28110.0)
"""Of a bearing at one end of the only span: a mass on a spring at the other end did more at first sight."""


def found(monkeypatch: pytest.MonkeyPatch, sharp: dict[str, Any]) -> tuple[list[str], list[str]]:
    """Finalists, the best first, and what was fitted in full; `sharp` are fits to responses as they are."""
    blunted = {"deck_attachment": fit(28695.0, 1.0), "bearing_stiffness": fit(16759.0, 1.0)}
    tried: list[str] = []

    def in_full(ring: object, quicks: list[Any], **_: object) -> list[tuple[Any, Any]]:
        tried.extend(one.name for one in quicks)
        return [(one, blunted[one.name]) for one in quicks]

    def learnt(ring: object, near: list[tuple[Any, Any]], *_: object) -> list[tuple[Any, Any, Any]]:
        return [(one, rough, sharp[one.name]) for one, rough in near]

    for name, value in {
        "Ring": lambda _: None,
        "current": lambda: None,
        "looked": lambda *_: ([], [ATTACHMENT, BEARING]),
        "finalists_of": lambda followed, *_: list(followed),
        "elsewhere": lambda *_: [],
        "penalty": lambda *_: 0.0,
        "gained": lambda base, amended: base.objective - amended.objective,
        "moved": lambda *_: np.inf,
        "fitted_in_full": in_full,
        "_learnt": learnt,
    }.items():
        monkeypatch.setattr(search, name, value)
    base = SimpleNamespace(objective=131712.0, heat=2.1, z=np.zeros(1))
    result = search.search(
        cast(Any, base),
        [],
        learnt_base=fit(1369568.0, 22.0),
        prefix="1.",
        threshold=lambda *_: 10.0,
        progress=lambda *_: None,
    )
    return [one.hypothesis.entry for one in result.finalists], tried


@pytest.mark.parametrize("left", [1.7, 1.07])
def test_they_are_tried_where_it_does_not_explain_responses_as_they_are(
    left: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    sharp = {"deck_attachment": fit(110650.0, left), "bearing_stiffness": fit(16759.0, 1.0)}
    names, tried = found(monkeypatch, sharp)
    assert tried == ["deck_attachment", "bearing_stiffness"]
    assert names == ["bearing_stiffness", "deck_attachment"]


def test_they_stay_spared_where_it_does(monkeypatch: pytest.MonkeyPatch) -> None:
    names, tried = found(monkeypatch, {"deck_attachment": fit(16900.0, 1.0)})
    assert tried == names == ["deck_attachment"]
