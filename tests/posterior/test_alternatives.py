"""Other forms in place of an amendment, begun with its values."""

from __future__ import annotations

import numpy as np
import pytest
from permway.diagnosis.fit import free_parameters
from permway.diagnosis.gather import gather
from permway.posterior.alternatives import alternatives
from permway.posterior.beam import Member
from permway.posterior.cells import Cell, cells
from permway.posterior.covariance import Frame
from permway.posterior.fit import Fitter, Model, grown
from simulated import simulate

AT, BETWEEN = "at every fastener", "between any two fasteners"


@pytest.fixture(scope="module")
def absorbers(tmp_path_factory: pytest.TempPathFactory) -> tuple[Member, list[Cell]]:
    """Masses of an unusual size on springs at every fastener, and all starts."""
    campaign = simulate(tmp_path_factory.mktemp("c"), 3).campaign
    fitter = Fitter(Frame.of(gather(campaign, threads=1)))
    nominal = Model(campaign.with_values, free_parameters(campaign))
    fit = fitter.begin(nominal, np.zeros(len(nominal.free)), fitter.frame.first())
    starts = cells(fit, ())
    first = next(c for c in starts if c.hypothesis.entry == "rail_absorber" and c.hypothesis.form[2] == AT)
    model = grown(fit, first.hypothesis, "1.")
    z = np.concatenate([fit.z, first.z + 0.7])
    return Member((first.hypothesis,), fitter.begin(model, z, fit.hyper), (-1.0,)), starts


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
