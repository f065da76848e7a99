"""Where all effects together fail a condition, those before the last may pass."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from permway.diagnosis import prove as module
from permway.diagnosis.prove import _placebo, proven


def finalist(name: str, *fitted_with: str) -> Any:
    """An effect of one parameter, fitted together with others."""
    free = [SimpleNamespace(name=n) for n in ("pad.k", *fitted_with, f"{name}.size")]
    campaign = SimpleNamespace(parameters=SimpleNamespace(known={"pad.k": None}))
    fit = SimpleNamespace(free=free, evidence=SimpleNamespace(campaign=campaign))
    return SimpleNamespace(name=name, own=[f"{name}.size"], fit=fit)


@pytest.mark.parametrize(
    ("passing", "kept"),
    [({"123"}, "123"), ({"12", "1"}, "12"), ({"1"}, "1"), (set(), "123")],
)
def test_the_first_effects_that_pass_are_kept(
    monkeypatch: pytest.MonkeyPatch, passing: set[str], kept: str
) -> None:
    def prove(base: object, fit: object, rounds: object, accepted: list[Any], *_: object, **__: object) -> Any:
        return SimpleNamespace(conditions=SimpleNamespace(hold="".join(one.name for one in accepted) in passing))

    monkeypatch.setattr(module, "prove", prove)
    accepted = [finalist("1"), finalist("2", "1.size"), finalist("3", "1.size", "2.size")]
    none = cast(Any, None)
    found, proof = proven(none, [], cast(Any, accepted), none, others=none)
    assert "".join(cast(Any, one).name for one in found) == kept
    assert proof.conditions.hold is (kept in passing)


def test_an_effect_that_was_fitted_beside_one_that_is_gone_does_not_stand_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def prove(base: object, fit: object, rounds: object, accepted: list[Any], *_: object, **__: object) -> Any:
        return SimpleNamespace(conditions=SimpleNamespace(hold=len(accepted) == 1))

    monkeypatch.setattr(module, "prove", prove)
    accepted = [finalist("2", "1.size"), finalist("3", "2.size")]
    none = cast(Any, None)
    found, _ = proven(none, [], cast(Any, accepted), none, others=none)
    assert len(found) == 2


def test_a_placebo_stands_elsewhere_if_anything_does() -> None:
    def quick(family: str, gain: float, x_m: tuple[float, float] | None) -> Any:
        where = SimpleNamespace(x_m=x_m)
        hypothesis = SimpleNamespace(family=family, free=(0, 0), locate=lambda _: where)
        return SimpleNamespace(hypothesis=hypothesis, gain=gain, values={})

    best = quick("loss", np.inf, (6.0, 8.0))
    here, there, everywhere = (
        quick("hung", 90.0, (5.0, 6.5)),
        quick("crack", 5.0, (1.0, 2.0)),
        quick("law", 7.0, None),
    )
    chosen = _placebo(cast(Any, SimpleNamespace(screened=(here, there, everywhere))), best)
    assert chosen is everywhere
    assert _placebo(cast(Any, SimpleNamespace(screened=(here,))), best) is here
    assert _placebo(cast(Any, SimpleNamespace(screened=(best,))), best) is None
