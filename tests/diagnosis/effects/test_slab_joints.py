"""Where slabs are cut: each by itself, or all by one measure."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue import entries, slab_joints
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.observations import Observations
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.separability import places
from permway.model.segments import Segment
from searched import searched
from simulated_track import SPAN_M, campaign, viaduct
from simulated_train import measured, written


@settings(max_examples=100, deadline=None)
@given(length=st.floats(1.5, 26.0), offset=st.floats(-0.5, 0.5), stop=st.floats(10.0, 120.0))
def test_slabs_between_joints_are_alike_and_none_is_a_stub(length: float, offset: float, stop: float) -> None:
    places = slab_joints._joints(Segment("slab", "slab", 0.0, stop), {"length_m": length, "offset": offset})
    if not places:
        return
    pieces = np.diff([0.0, *places, stop])
    assert pieces[1:-1] == pytest.approx(length)
    assert min(pieces[0], pieces[-1]) > slab_joints.SHORT * length * (1.0 - 1e-9)
    assert max(pieces[0], pieces[-1]) <= (1.0 + slab_joints.SHORT) * length * (1.0 + 1e-9)


@settings(max_examples=100, deadline=None)
@given(
    length=st.floats(1.5, 12.0),
    offset=st.floats(-0.5, 0.5),
    start=st.floats(5.0, 60.0),
    extent=st.floats(10.0, 40.0),
)
def test_joints_by_one_measure_go_on_from_slab_to_slab(
    length: float, offset: float, start: float, extent: float
) -> None:
    """Counted from elsewhere each is a whole number of lengths away, and none is left out but next to ends."""
    slab = Segment("slab", "slab", start, start + extent)
    places = np.array(slab_joints._joints(slab, {"length_m": length, "offset": offset}, 0.0))
    counts = places / length - offset
    assert counts == pytest.approx(counts.round(), abs=1e-9)
    assert np.diff(places) == pytest.approx(length)
    ends = np.array([places[0] - start, start + extent - places[-1]]) if places.size else np.array([0.0])
    assert ends.max() <= (1.0 + slab_joints.SHORT) * length * (1.0 + 1e-9)


def observations_of(
    nominal_campaign: Campaign, amend: Callable[[Campaign], Campaign] = lambda campaign: campaign
) -> Observations:
    return gather(nominal_campaign, measured(nominal_campaign, 3, amend), threads=1)


def test_joints_that_go_on_from_slab_to_slab_are_no_pattern_of_each(tmp_path: Path) -> None:
    """Of two slabs cut every 4.8 m: 5.1 m from the start of the first, and 3 m from that of the second."""

    model = viaduct(2)
    model["line"]["bodies"]["slab"]["intervals_m"] = [[0.0, 11.7], [11.7, 2 * SPAN_M]]
    table = campaign(model)
    for one in table["sensors"]:
        one["body"] = one["body"].replace("slab[1]", "slab")
    nominal_campaign = written(tmp_path / "c", table, model)
    fit = recalibrate(observations_of(nominal_campaign))
    offered = entries()["slab_joints"].hypotheses(Situation(fit, tuple(places(fit))))
    inject = next(h.amend for h in offered if h.variant == "through" and len(h.free) == 2)
    changed = observations_of(nominal_campaign, lambda c: inject(c, {"length_m": 4.8, "offset": 0.0625}))
    found = searched(changed, "slab_joints")
    best = found.best()
    assert best is not None
    assert best.amendments[0].variant == "through"
    assert best.values(0)["length_m"] == pytest.approx(4.8, abs=0.05)
    others = [m for m in found.members if m.amendments and m.amendments[0].variant != "through"]
    assert all(found.gain(best) > found.gain(other) + 10.0 for other in others)


def test_a_cut_is_beside_the_sensor_that_it_meets(tmp_path: Path) -> None:
    """A beam has no place that belongs to two of its pieces: cuts are tried to either side of a sensor there."""
    model = viaduct(1)
    table = campaign(model)
    (sensor,) = [one for one in table["sensors"] if one["body"].startswith("slab")][:1]
    nominal_campaign = written(tmp_path / "c", table, model)
    fit = recalibrate(observations_of(nominal_campaign))
    (slab,) = [s for _, s in nominal_campaign.model.line.beams() if s.body == "slab"]
    (cut, *_) = [h for h in entries()["slab_joints"].hypotheses(Situation(fit, ())) if len(h.free) == 2]
    x = float(sensor["x_m"])
    ends = []
    for off in (-1e-4, 1e-4):
        values = {"length_m": 8.0, "offset": ((x + off - slab.start + 4.0) % 8.0 - 4.0) / 8.0}
        pieces = cut.amend(nominal_campaign, values).model.line.bodies["slab"].intervals_m
        near = [end for end, _ in pieces if abs(end - x) < 0.01]
        assert len(near) == 1
        ends += near
    assert ends == pytest.approx([x - slab_joints.ASIDE_M, x + slab_joints.ASIDE_M], abs=1e-9)
    # The evidence can be predicted with either.
    for off in (-1e-4, 1e-4):
        values = {"length_m": 8.0, "offset": ((x + off - slab.start + 4.0) % 8.0 - 4.0) / 8.0}
        fit.observations.predicted(cut.amend(nominal_campaign, values))
