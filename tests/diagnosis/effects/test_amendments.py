"""What amendments do to a line, held against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from permway.campaign.campaign import Campaign
from permway.campaign.factors import model_under
from permway.diagnosis.catalogue import support_gradient
from permway.diagnosis.catalogue._pads import STIFFNESS, factors, keys_of
from permway.diagnosis.catalogue._relaxing import REFERENCE_HZ, relaxing, relaxing_once
from permway.diagnosis.hypothesis import Hypothesis, Where, between_free, log_free
from permway.laws import Hysteretic, Scaled
from permway.laws.checks import check_law
from permway.posterior.cells import Cell, resized
from simulated import simulate

FREQUENCY = np.geomspace(1.0, 1000.0, 200)


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    return simulate(tmp_path_factory.mktemp("pads"), 1).campaign


def constant(campaign: Campaign) -> Hysteretic:
    law = campaign.model.line.laws["pad"]
    assert isinstance(law, Hysteretic)
    return law


@settings(max_examples=30, deadline=None)
@given(
    factor=st.floats(0.4, 2.5), order=st.floats(0.02, 0.8), share=st.floats(0.02, 0.97), rest=st.floats(0.0, 1.0)
)
def test_a_springpot_takes_over_stiffness_and_loss(
    campaign: Campaign, factor: float, order: float, share: float, rest: float
) -> None:
    before = constant(campaign)
    after = relaxing(campaign, "pad", stiffness_factor=factor, order=order, share=share, rest=rest)
    law = after.model.line.laws["pad"]
    k = before.stiffness * factor
    # What stays of the constant loss is a loss of all of it; of what hardly relaxes, all stays.
    lossy = 1.0 + 1j * (1.0 - (1.0 - rest) * min(10.0 * share, 1.0)) * before.eta
    (at,) = law.complex(np.array([REFERENCE_HZ]), None) / lossy
    assert at.real == pytest.approx(k)
    assert at.imag == pytest.approx(k * share * np.tan(0.5 * np.pi * order))
    # Its part grows with frequency by the order, and the constant part stays.
    high, low = law.complex(np.array([10.0 * REFERENCE_HZ, 0.0 * REFERENCE_HZ + 1e-9]), None) / lossy
    assert (high.real - k * (1.0 - share)) / (k * share) == pytest.approx(10.0**order)
    assert low.real >= k * (1.0 - share) * (1.0 - 1e-9)
    assert check_law(law, (1.0, 1000.0)).passive


@settings(max_examples=30, deadline=None)
@given(
    factor=st.floats(0.4, 2.5), rise=st.floats(0.02, 10.0), hertz=st.floats(4.0, 1000.0), rest=st.floats(0.0, 1.0)
)
def test_a_relaxation_rises_by_what_it_states(
    campaign: Campaign, factor: float, rise: float, hertz: float, rest: float
) -> None:
    before = constant(campaign)
    after = relaxing_once(campaign, "pad", stiffness_factor=factor, rise=rise, relaxation_Hz=hertz, rest=rest)
    law = after.model.line.laws["pad"]
    k = before.stiffness * factor
    lossy = 1.0 + 1j * (1.0 - (1.0 - rest) * min(10.0 * rise, 1.0)) * before.eta
    at, low, middle, high = law.complex(np.array([REFERENCE_HZ, 1e-6, hertz, 1e9]), None) / lossy
    assert at.real == pytest.approx(k)
    assert high.real / low.real == pytest.approx(1.0 + rise, rel=1e-6)
    assert middle.real == pytest.approx(0.5 * (low.real + high.real), rel=1e-6)
    # Debye's peak: half the step.
    assert middle.imag == pytest.approx(0.5 * (high.real - low.real), rel=1e-6)
    assert check_law(law, (1.0, 1000.0)).passive


def test_a_law_of_two_parts_scales_with_both(campaign: Campaign) -> None:
    after = relaxing(campaign, "pad", stiffness_factor=1.0, order=0.2, share=0.5, rest=0.5)
    before = after.model.line.laws["pad"]
    assert isinstance(before, Scaled)
    assert keys_of(before.law, STIFFNESS) == ("first.stiffness", "second.coefficient")
    stiffer = model_under(after.model, tuple(factors(after.model.line, "pad", 1.3, 0.5).items()))
    at = np.array([REFERENCE_HZ])
    law = stiffer.line.laws["pad"]
    # Its springpot is half of what it was, and so is the loss of all.
    inner = before.law.complex(at) - 0.5 * constant(campaign).stiffness
    expected = 0.5 * constant(campaign).stiffness + 0.5 * inner
    assert law.complex(at) == pytest.approx(1.3 * (1.0 + 0.5j * before.eta) * expected)


def sized(none: float, *, size: str = "size") -> Hypothesis:
    return Hypothesis(
        entry="rail_absorber",
        domain="path",
        family="resonator",
        free=(log_free("size", "kg", 5.0, 2.5), between_free("place", "1", 0.0, 1.0)),
        amend=lambda campaign, _values: campaign,
        locate=lambda _values: Where(what="rail"),
        starts=((0.0, 0.3),),
        law=lambda _values: "",
        size=size,
        none=none,
    )


def test_a_start_is_made_weaker_in_its_size_alone() -> None:
    start = np.array([0.0, 0.3])
    half = resized(Cell(sized(0.0), start, 0.0), 0.5).z
    assert sized(0.0).free[0].value(float(half[0])) == pytest.approx(2.5)
    assert half[1] == start[1]
    # Where none is a number to be divided by, on the way there.
    nearer = resized(Cell(sized(1.0), start, 0.0), 0.25).z
    assert sized(1.0).free[0].value(float(nearer[0])) == pytest.approx(2.0)


@pytest.mark.parametrize("hypothesis", [sized(np.inf), sized(0.0, size="")])
def test_what_has_no_size_is_left_as_it_is(hypothesis: Hypothesis) -> None:
    start = np.array([0.0, 0.3])
    assert (resized(Cell(hypothesis, start, 0.0), 0.5).z == start).all()


@pytest.mark.parametrize("beyond", [True, False])
def test_a_gradient_goes_on_beyond_the_structure_or_does_not(campaign: Campaign, beyond: bool) -> None:
    line = campaign.model.line
    x = line.joint_table().x[[line.joints[i].law == "pad" for i in line.joint_table().layer]]
    low, high = np.quantile(x, [0.3, 0.7], method="nearest")
    changed = support_gradient._of("pad", float(low), float(high), beyond=beyond).amend(campaign, {"ratio": 1.5})
    table = changed.model.line.joint_table()
    scale = table.scale[[changed.model.line.joints[i].law == "pad" for i in table.layer]]
    assert scale[x == high][0] / scale[x == low][0] == pytest.approx(1.5)
    assert scale[x == x.min()][0] == pytest.approx(0.8 if beyond else 1.0)
    assert scale[x == x.max()][0] == pytest.approx(1.2 if beyond else 1.0)
