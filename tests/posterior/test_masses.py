"""Posterior masses of names, from sets whose evidence is given."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from permway.posterior.masses import ALIKE, Masses
from permway.posterior.member import IDEALISED, Member, tempered

PRIOR, COUNT = -6.0, 2000
POWER, OF_MISSING = 1.0 / (1.0 + COUNT / ALIKE), 1.0 / (1.0 + COUNT / IDEALISED)


def member(*names: str, nats: float, novel: float = 0.0) -> Member:
    """A set with so much more evidence than the empty one; each amendment has the same prior."""
    amendments = tuple(SimpleNamespace(entry=name) for name in names)
    prior = PRIOR * len(names)
    found = SimpleNamespace(
        amendments=amendments,
        names=tuple(sorted(names)),
        fit=SimpleNamespace(
            log_evidence=nats,
            hyper=SimpleNamespace(novel=novel),
            state=SimpleNamespace(residuals=np.zeros(COUNT)),
        ),
        far_behind=False,
        log_prior=prior,
        log_mass=prior + tempered(nats, COUNT),
    )
    return cast(Member, found)


def logistic(x: float) -> float:
    return 1.0 / (1.0 + 2.718281828459045**-x)


def test_a_weak_effect_is_as_probable_as_its_odds_against_nothing() -> None:
    masses = Masses.of([member(nats=0.0), member("crack", nats=8.0)])
    assert masses.nothing == pytest.approx(1.0 - logistic(8.0 * OF_MISSING + PRIOR))
    assert masses.names(0) == [("crack", pytest.approx(logistic(8.0 * OF_MISSING + PRIOR)))]


def test_a_second_amendment_needs_evidence_in_the_coarsened_posterior() -> None:
    first, weak, strong = (member(*n, nats=v) for n, v in (("c", 90.0), (("c", "n"), 98.0), (("c", "n"), 110.0)))
    assert Masses.of([member(nats=0.0), first, weak]).best is first
    both = Masses.of([member(nats=0.0), first, strong])
    assert both.best is strong
    assert both.names(1) == [("n", pytest.approx(1.0))]


def test_names_share_the_coarsened_mass() -> None:
    masses = Masses.of([member(nats=0.0), member("crack", nats=50.0), member("joint", nats=46.0)])
    names = dict(masses.names(0))
    assert names["crack"] == pytest.approx(logistic(4.0 * POWER))
    assert names["joint"] == pytest.approx(1.0 - logistic(4.0 * POWER))


def test_what_fits_badly_may_be_of_no_catalogue() -> None:
    masses = Masses.of([member(nats=0.0, novel=1.0), member("crack", nats=50.0, novel=0.3)])
    assert dict(masses.names(0)) == {"crack": pytest.approx(0.7), "novel": pytest.approx(0.3)}
    assert masses.nothing == pytest.approx(0.0, abs=1e-12)
