"""Smaller sets of a set's amendments: each left out, and one stretch over two of one form."""

from __future__ import annotations

import numpy as np
import pytest
from permway.diagnosis.fit import free_parameters
from permway.diagnosis.gather import gather
from permway.posterior.cells import Cell, cells
from permway.posterior.covariance import Frame
from permway.posterior.fit import Model, grown
from permway.posterior.fitter import Fitter
from permway.posterior.member import Member
from permway.posterior.ordering import _smaller, _worth_keeping
from simulated import simulate


@pytest.fixture(scope="module")
def member(tmp_path_factory: pytest.TempPathFactory) -> Member:
    """Two losses of fasteners apart, and something else."""
    campaign = simulate(tmp_path_factory.mktemp("c"), 3).campaign
    fitter = Fitter(Frame.of(gather(campaign, threads=1)))
    nominal = Model(campaign.with_values, free_parameters(campaign))
    fit = fitter.begin(nominal, np.zeros(len(nominal.free)), fitter.frame.first())
    every = cells(fit, ())
    losses = [c for c in every if c.hypothesis.entry == "fastener_loss" and c.values.get("length_m", 9.0) < 1.0]
    beside = next(c for c in losses if 0.0 < abs(c.values["centre_m"] - losses[0].values["centre_m"]) < 3.0)
    other = next(c for c in every if c.hypothesis.entry != "fastener_loss" and c.hypothesis.free)
    chosen: list[Cell] = [losses[0], other, beside]
    z, amendments = fit.z, []
    for number, cell in enumerate(chosen, start=1):
        model = grown(fit, cell.hypothesis, f"{number}.")
        z = np.concatenate([z, cell.z])
        fit = fitter.begin(model, z, fit.hyper)
        amendments.append(cell.hypothesis)
    return Member(tuple(amendments), fit, (-1.0, -1.0, -1.0))


def test_each_is_left_out_and_two_stretches_become_one(member: Member) -> None:
    found = list(_smaller(member))
    assert sorted(kept for kept, _ in found) == [[0, 1], [0, 1], [0, 2], [1, 2]]
    own = [member.fit.z[member.own(index)] for index in range(3)]
    for kept, z in found:
        assert np.array_equal(z[1], own[kept[1]])
    first, last = member.values(0), member.values(2)
    over = [z[0] for kept, z in found if kept == [0, 1] and not np.array_equal(z[0], own[0])]
    assert len(over) == 1
    values = {f.name: f.value(float(v)) for f, v in zip(member.amendments[0].free, over[0], strict=True)}
    ends = [v["centre_m"] + s * 0.5 * v["length_m"] for v in (first, last) for s in (-1.0, 1.0)]
    assert values["centre_m"] - 0.5 * values["length_m"] == pytest.approx(min(ends))
    assert values["centre_m"] + 0.5 * values["length_m"] == pytest.approx(max(ends))
    assert values["factor"] == pytest.approx(first["factor"])


def test_the_best_set_of_each_size_is_kept_however_far_behind(member: Member) -> None:
    def of(count: int, nats: float) -> Member:
        return Member(member.amendments[:count], member.fit, (nats / max(count, 1),) * count)

    every = [of(3, -1.0), of(3, -5.0), of(2, -50.0), of(3, -60.0), of(1, -70.0), of(2, -80.0), of(0, 0.0)]
    kept = _worth_keeping(every)
    assert [(len(m.amendments), m.log_priors, m.far_behind) for m in kept] == [
        (len(every[i].amendments), every[i].log_priors, i in (2, 4)) for i in (0, 1, 2, 4, 6)
    ]
