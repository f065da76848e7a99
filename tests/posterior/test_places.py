"""Where the posterior mass lies, from sets whose evidence and places are given."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import Hypothesis, Where
from permway.posterior.answer import _bands
from permway.posterior.cells import Cell
from permway.posterior.masses import Masses
from permway.posterior.member import Member
from permway.posterior.places import weighed
from simulated import SPACING, simulate

PADS = np.arange(SPACING["from_m"], SPACING["to_m"] + 1e-9, SPACING["spacing_m"])
COUNT = 2000


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    return simulate(tmp_path_factory.mktemp("made") / "c", 1).campaign


Place = Callable[[float], Where]


def stretch(half: float) -> Place:
    return lambda x: Where("pad", (x - half, x + half))


def member(
    campaign: Campaign, *at: tuple[str, Place, float, float], nats: float = 0.0, novel: float = 0.0
) -> Member:
    """A set of amendments, each with name, place, x and its standard deviation."""

    def hypothesis(name: str, place: Place, x: float, sigma: float) -> Hypothesis:
        return Hypothesis(
            entry=name,
            domain="path",
            family=f"family of {name}",
            free=(Free("x_m", "m", lambda z: x + sigma * z, (-8.0, 8.0)),),
            amend=lambda c, _: c,
            locate=lambda v: place(v["x_m"]),
            starts=((0.0,),),
            law=lambda v: f"acts at {v['x_m']:.1f}",
        )

    fit = SimpleNamespace(
        z=np.zeros(len(at)),
        spread=np.eye(len(at)),
        log_evidence=nats,
        hyper=SimpleNamespace(novel=novel),
        state=SimpleNamespace(residuals=np.zeros(COUNT), solved=SimpleNamespace(campaign=campaign)),
        model=SimpleNamespace(free=range(len(at))),
    )
    return Member(tuple(hypothesis(*one) for one in at), cast(object, fit), (-6.0,) * len(at))  # type: ignore[arg-type]


def test_a_place_that_is_constrained_exactly_holds_all_of_its_probability(campaign: Campaign) -> None:
    lost = member(campaign, ("lost", stretch(0.7), 6.0, 1e-6), nats=90.0)
    found = weighed(Masses.of([member(campaign), lost]))
    (one,) = found.along
    assert (one.what, one.joints, one.family) == ("pad", True, "family of lost")
    assert one.x_m == pytest.approx(PADS)
    there = np.abs(PADS - 6.0) < 0.61
    assert there.sum() == 3
    assert one.probability == pytest.approx(np.where(there, 1.0, 0.0), abs=1e-3)
    assert found.aside == ()


def test_a_place_that_is_hardly_constrained_is_spread_as_the_normal_distribution(campaign: Campaign) -> None:
    point = member(campaign, ("attached", lambda x: Where("deck", (x, x)), 6.0, 1.5), nats=90.0)
    (one,) = weighed(Masses.of([member(campaign), point])).along
    assert not one.joints
    assert float(one.probability.sum()) == pytest.approx(1.0, abs=1e-3)
    assert float(one.probability @ one.x_m) == pytest.approx(6.0, abs=0.3)
    inside = np.abs(one.x_m - 6.0) < 1.645 * 1.5
    assert float(one.probability[inside].sum()) == pytest.approx(0.9, abs=0.07)


def test_all_probabilities_sum_to_one_and_what_has_no_place_is_reported_beside(campaign: Campaign) -> None:
    loud = member(campaign, ("gain", lambda _: Where(channels=("deck@3",)), 0.0, 1.0), nats=88.0, novel=0.2)
    lost = member(campaign, ("lost", stretch(0.6), 6.0, 1e-6), nats=90.0, novel=0.2)
    found = weighed(Masses.of([member(campaign), lost, loud]))
    assert sum(one.probability for one in found.rivals) + found.unknown == pytest.approx(1.0)
    assert found.unknown == pytest.approx(0.2, abs=1e-3)
    (aside,) = found.aside
    assert aside.channels == ("deck@3",)
    shares = {one.names: one.probability for one in found.rivals}
    assert aside.probability == pytest.approx(shares["gain",])
    assert shares["lost",] / shares["gain",] == pytest.approx(np.exp(1.0), rel=1e-6)
    assert [one.names for one in found.rivals] == [("lost",), ("gain",), ()]
    assert [one.behind_nats for one in found.rivals] == pytest.approx([0.0, 2.0, 84.0 - np.log(1.0)], abs=1e-9)


def test_where_nothing_is_missing_the_map_states_where_was_looked(campaign: Campaign) -> None:
    only = member(campaign)
    lost = member(campaign, ("lost", stretch(0.6), 6.0, 1.0), nats=-30.0)
    tried = [Cell(lost.amendments[0], np.array([z]), 0.0) for z in (-1.0, 0.0, 0.0, 2.0)]
    found = weighed(Masses.of([only, lost]), tried)
    assert found.along == ()
    assert found.nothing == pytest.approx(1.0, abs=1e-6)
    assert found.tried["pad"].tolist() == [5.0, 6.0, 8.0]


def test_the_map_is_the_same_each_time(campaign: Campaign) -> None:
    masses = Masses.of([member(campaign), member(campaign, ("lost", stretch(0.6), 6.0, 1.0), nats=90.0)])
    first, again = weighed(masses), weighed(masses)
    assert first.along[0].probability.tolist() == again.along[0].probability.tolist()


def test_the_best_of_a_size_far_behind_is_listed_and_counts_in_no_probability(campaign: Campaign) -> None:
    lost = ("lost", stretch(0.7), 6.0, 0.1)
    both = member(campaign, lost, ("crack", stretch(0.1), 7.2, 0.1), nats=300.0)
    near, far = member(campaign), replace(member(campaign, lost, nats=250.0), far_behind=True)
    found, without = (weighed(Masses.of(members)) for members in ([both, far, near], [both, near]))
    assert [one.names for one in found.rivals] == [("lost", "crack"), ("lost",), ()]
    assert found.rivals[1].behind_nats == pytest.approx(50.0 - 6.0)
    assert [one.probability for one in found.rivals] == [without.rivals[0].probability, 0.0, without.nothing]
    assert found.nothing == without.nothing


def test_bands_end_where_the_lines_do() -> None:
    lines = np.arange(10.0, 201.0)
    ((low, high),) = _bands(lines, np.where(lines > 170.0, 1.0, 0.0))
    assert [low, high] == pytest.approx([2.0 ** (22 / 3), 200.0])
    assert _bands(lines, np.where(lines < 12.0, 1.0, 0.0))[0][0] == 10.0
