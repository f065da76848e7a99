"""Other forms in place of an amendment, begun with its values."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from permway.diagnosis.fit import free_parameters
from permway.diagnosis.gather import gather
from permway.posterior.alternatives import alternatives, rivals
from permway.posterior.cells import Cell, cells
from permway.posterior.covariance import Frame
from permway.posterior.fit import Fit, Model, grown
from permway.posterior.fitter import Fitter
from permway.posterior.member import Member
from simulated import simulate

AT, BETWEEN = "at every fastener", "between any two fasteners"


@pytest.fixture(scope="module")
def begun(tmp_path_factory: pytest.TempPathFactory) -> tuple[Fitter, Fit, list[Cell]]:
    """A campaign's empty set, not fitted, and all starts."""
    campaign = simulate(tmp_path_factory.mktemp("c"), 3).campaign
    fitter = Fitter(Frame.of(gather(campaign, threads=1)))
    nominal = Model(campaign.with_values, free_parameters(campaign))
    fit = fitter.begin(nominal, np.zeros(len(nominal.free)), fitter.frame.first())
    return fitter, fit, cells(fit, ())


def with_one(begun: tuple[Fitter, Fit, list[Cell]], cell: Cell, log_prior: float = -1.0) -> Member:
    """A set of one amendment at the values of a cell."""
    fitter, fit, _ = begun
    model = grown(fit, cell.hypothesis, "1.")
    made = fitter.begin(model, np.concatenate([fit.z, cell.z]), fit.hyper)
    return Member((cell.hypothesis,), made, (log_prior,))


@pytest.fixture(scope="module")
def absorbers(begun: tuple[Fitter, Fit, list[Cell]]) -> tuple[Member, list[Cell]]:
    """Masses of an unusual size on springs at every fastener, and all starts."""
    starts = begun[2]
    first = next(c for c in starts if c.hypothesis.entry == "rail_absorber" and c.hypothesis.form[2] == AT)
    return with_one(begun, replace(first, z=first.z + 0.7)), starts


def test_with_its_size_a_form_that_has_the_same_is_begun_once(absorbers: tuple[Member, list[Cell]]) -> None:
    member, starts = absorbers
    values = member.values(0)
    found = alternatives(member, 0, starts, sized=True)
    assert all(cell.hypothesis.size == member.amendments[0].size for cell in found)
    same = [c for c in found if c.hypothesis.form[2] == BETWEEN and set(c.values) == set(values)]
    assert len(same) == 1
    assert same[0].values == pytest.approx(values)


def test_without_its_size_every_start_keeps_its_own(absorbers: tuple[Member, list[Cell]]) -> None:
    member, starts = absorbers
    values = member.values(0)
    found = alternatives(member, 0, starts)
    same = [c for c in found if c.hypothesis.form[2] == BETWEEN]
    assert len(same) > 1
    for cell in same:
        assert cell.values["frequency_Hz"] == pytest.approx(values["frequency_Hz"])
        assert cell.values["mass_kg"] != pytest.approx(values["mass_kg"])


def test_what_lost_before_is_tried_again_the_best_of_each_effect(
    begun: tuple[Fitter, Fit, list[Cell]], absorbers: tuple[Member, list[Cell]]
) -> None:
    leader, starts = absorbers
    lost = [c for c in starts if c.hypothesis.entry == "fastener_loss"][:2]
    gain = next(c for c in starts if c.hypothesis.entry == "sensor_gain")
    # A prior of one in e^100,000 puts a set behind any other.
    tried = [with_one(begun, lost[0], -1e5), with_one(begun, lost[1]), with_one(begun, gain, -2e5), leader]
    found = rivals(leader, tried)
    assert [cell.hypothesis for cell in found] == [lost[1].hypothesis, gain.hypothesis]
    assert found[0].values == pytest.approx(lost[1].values)
    assert [cell.log_prior for cell in found] == [-1.0, -2e5]


def test_of_a_whole_law_all_its_other_forms_are_begun(begun: tuple[Fitter, Fit, list[Cell]]) -> None:
    """Though they share no parameter; those of another law, or of a part of it, are not."""
    starts = begun[2]
    first = next(c for c in starts if c.hypothesis.entry == "layer_damping")
    part = first.hypothesis.locate(first.values)
    found = alternatives(with_one(begun, first), 0, starts)
    places = {(c.hypothesis.entry, c.hypothesis.locate(c.values)) for c in starts}
    expected = {entry for entry, place in places if place == part} - {"layer_damping"}
    assert "pad_frequency" in expected
    assert {c.hypothesis.entry for c in found if c.hypothesis.locate(c.values) == part} == expected
    assert not any(c.hypothesis.entry == "fastener_loss" for c in found)
