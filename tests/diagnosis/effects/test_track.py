"""Effects of track and bridge put into the tool's own small lines: unit tests of entries, and no proof of them."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.campaign.predict import predict
from permway.diagnosis.catalogue import entries
from permway.diagnosis.catalogue._interval import weakened
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Amend, Hypothesis, Situation
from permway.diagnosis.observations import Observations
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.separability import places
from permway.posterior.cells import offered
from searched import searched
from simulated_track import ballasted, campaign, embedded, viaduct
from simulated_train import blank, measured, written

LINES: dict[str, Callable[[], dict[str, Any]]] = {
    "viaduct": viaduct,
    "two spans": lambda: viaduct(2),
    "ballast": ballasted,
    "bed": embedded,
}
FOUND_ON: dict[str, tuple[str, ...]] = {
    "fastener_loss": ("viaduct", "two spans", "ballast", "bed"),
    "mortar_void": ("viaduct", "two spans", "ballast"),
    "girder_crack": ("viaduct", "two spans"),
    "bearing_stiffness": ("viaduct", "two spans"),
    "rail_absorber": ("viaduct", "two spans", "ballast"),
    "baseplate_mass": ("viaduct", "two spans", "ballast"),
    "slab_joints": ("viaduct", "two spans"),
    "layer_damping": ("viaduct", "two spans", "ballast", "bed"),
    "beam_damping": ("viaduct", "two spans"),
    "pier_soil": ("viaduct", "two spans"),
    "support_gradient": ("viaduct", "two spans", "ballast", "bed"),
    "support_scatter": ("viaduct", "two spans", "ballast", "bed"),
    "slab_warping": ("viaduct", "two spans"),
    "sliding_friction": ("viaduct", "two spans"),
    "ballast_frequency": ("ballast",),
    "discrete_support": ("bed",),
    "span_coupling": ("two spans",),
    "girder_local_modes": ("viaduct", "two spans"),
    "girder_shear": ("viaduct", "two spans"),
    "second_track": ("viaduct", "two spans"),
    "deck_attachment": ("viaduct", "two spans"),
    "pad_frequency": ("viaduct", "two spans", "ballast", "bed"),
}
"""What each line has a part for."""

Values = Mapping[str, float]


def strengths(size: str, weak: float, middle: float, strong: float, **others: float) -> list[Values]:
    """Three strengths of one effect."""
    return [{**others, size: value} for value in (weak, middle, strong)]


# Line, values at three strengths, and how near the strongest must come out: relative, or in m for places.
INJECTED: dict[str, tuple[str, list[Values], dict[str, float]]] = {
    "fastener_loss": (
        "viaduct",
        strengths("factor", 0.8, 0.5, 0.1, centre_m=6.9, length_m=0.6),
        {"centre_m": 0.4, "length_m": 0.7},
    ),
    "mortar_void": (
        "viaduct",
        strengths("factor", 0.5, 0.2, 0.03, centre_m=8.1, length_m=1.8),
        {"centre_m": 0.4, "length_m": 0.7},
    ),
    "girder_crack": (
        "viaduct",
        strengths("factor", 0.85, 0.6, 0.35, centre_m=5.0, length_m=1.2),
        {"centre_m": 0.5},
    ),
    "rail_absorber": (
        "viaduct",
        strengths("mass_kg", 0.5, 2.0, 8.0, frequency_Hz=110.0, loss_factor=0.1),
        {"mass_kg": 0.15, "frequency_Hz": 0.03, "loss_factor": 0.3},
    ),
    "baseplate_mass": ("viaduct", strengths("mass_kg", 2.0, 6.0, 15.0, share=0.6), {"mass_kg": 0.5, "share": 0.2}),
    "slab_joints": (
        "viaduct",
        strengths("flexibility_m", 0.3, 2.0, 30.0, length_m=5.0, offset=0.0),
        {"length_m": 0.05},
    ),
    "support_gradient": ("viaduct", strengths("ratio", 1.15, 1.4, 2.2), {"ratio": 0.1}),
    "slab_warping": (
        "viaduct",
        strengths("factor", 0.7, 0.4, 0.05, length_m=2.5, sharpness=1.5),
        {"length_m": 0.15},
    ),
    "girder_local_modes": (
        "viaduct",
        strengths("mass_share", 0.01, 0.04, 0.15, frequency_Hz=40.0, loss_factor=0.05),
        {"mass_share": 0.2, "frequency_Hz": 0.05},
    ),
    "girder_shear": ("viaduct", strengths("turning", 0.3, 0.7, 1.5, shear=2.0), {}),
    "deck_attachment": (
        "viaduct",
        strengths("mass_kg", 150.0, 500.0, 1500.0, x_m=5.0, frequency_Hz=25.0, loss_factor=0.05, dashpot=0.0),
        {"mass_kg": 0.2, "frequency_Hz": 0.03, "x_m": 0.7},
    ),
    "ballast_frequency": (
        "ballast",
        strengths("share", 0.1, 0.3, 0.6, stiffness_factor=1.0, order=0.5),
        {"order": 0.2},
    ),
    "discrete_support": (
        "bed",
        strengths("share", 0.3, 0.6, 0.95, spacing_m=0.6, offset=0.1),
        {"spacing_m": 0.02},
    ),
    "layer_damping": ("viaduct", strengths("share", 0.1, 0.4, 0.9, equal_at_Hz=60.0), {}),
    "beam_damping": ("viaduct", strengths("share", 0.1, 0.4, 0.9), {}),
    "support_scatter": (
        "viaduct",
        strengths("wave2", -0.1, -0.2, -0.4, wave1=0.05, wave3=0.05, wave4=0.1),
        {"wave2": 0.3},
    ),
    "sliding_friction": (
        "viaduct",
        strengths("stiffness_factor", 0.8, 0.5, 0.2, rubbing=0.6),
        {},
    ),
    "second_track": (
        "viaduct",
        strengths("mass_kg_per_m", 100.0, 300.0, 900.0, sprung=0.1, frequency_Hz=90.0, loss_factor=0.15),
        {"frequency_Hz": 0.1},
    ),
    "pier_soil": (
        "viaduct",
        strengths("compliance", 0.05, 0.2, 0.6, frequency_Hz=65.0, loss_factor=0.1, radiation=0.05),
        {"frequency_Hz": 0.15},
    ),
    "pad_frequency": (
        "viaduct",
        strengths("share", 0.1, 0.3, 0.6, order=0.4, stiffness_factor=1.0),
        {"order": 0.25},
    ),
    "span_coupling": ("two spans", strengths("stiffness", 2e7, 1e8, 5e8, loss_factor=0.1), {"stiffness": 0.2}),
}


@pytest.fixture(scope="module")
def situations(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], tuple[Situation, Campaign]]:
    """Of a line with nothing missing."""

    @cache
    def made(line: str) -> tuple[Situation, Campaign]:
        nominal_campaign = read(tmp_path_factory.mktemp("line"), line)
        fit = recalibrate(of(nominal_campaign, 7))
        return Situation(fit, tuple(places(fit))), fit.campaign

    return made


def read(folder: Path, line: str) -> Campaign:
    model = LINES[line]()
    return written(folder / "c", campaign(model), model)


def of(
    nominal_campaign: Campaign, seed: int, amend: Callable[[Campaign], Campaign] = lambda campaign: campaign
) -> Observations:
    return gather(nominal_campaign, measured(nominal_campaign, seed, amend), threads=1)


def _put(inject: Amend, values: Values, base: Campaign) -> Campaign:
    return inject(base, values)


def predicted(base: Campaign) -> np.ndarray:
    return np.concatenate([p["frf"].values.reshape(-1) for p in predict(base, blank(base), threads=1)])


def middle(hypothesis: Hypothesis, z: float = 0.4) -> dict[str, float]:
    return {f.name: f.value(z) for f in hypothesis.free}


@pytest.mark.parametrize("line", LINES)
def test_a_line_yields_what_it_has_a_part_for(
    line: str, situations: Callable[[str], tuple[Situation, Campaign]]
) -> None:
    situation, _ = situations(line)
    yielded = {name for name in FOUND_ON if list(entries()[name].hypotheses(situation))}
    assert yielded == {name for name, lines in FOUND_ON.items() if line in lines}


@pytest.mark.parametrize(("entry", "line"), [(name, lines[-1]) for name, lines in FOUND_ON.items()])
def test_no_effect_is_the_base_and_the_ends_of_ranges_can_be_solved(
    entry: str, line: str, situations: Callable[[str], tuple[Situation, Campaign]]
) -> None:
    situation, base = situations(line)
    right = predicted(base)
    for hypothesis in entries()[entry].hypotheses(situation):
        assert hypothesis.family
        values = middle(hypothesis)
        none = {**values, hypothesis.size: hypothesis.none} if hypothesis.size else dict.fromkeys(values, 0.0)
        np.testing.assert_allclose(predicted(hypothesis.amend(base, none)), right, rtol=1e-6)
        # Its values change the prediction.
        assert np.abs(predicted(hypothesis.amend(base, values)) / right - 1.0).max() > 1e-4
        for ends in itertools.product((0, 1), repeat=len(hypothesis.free)):
            extreme = {f.name: f.value(f.limits[end]) for f, end in zip(hypothesis.free, ends, strict=True)}
            assert np.isfinite(predicted(hypothesis.amend(base, extreme))).all()
        place = hypothesis.locate(values)
        assert place.what
        assert hypothesis.law(values)


@pytest.mark.injection
@pytest.mark.parametrize("entry", INJECTED)
def test_what_is_put_in_is_named_and_measured(
    entry: str, situations: Callable[[str], tuple[Situation, Campaign]], tmp_path: Path
) -> None:
    line, levels, near = INJECTED[entry]
    offered = entries()[entry].hypotheses(situations(line)[0])
    inject = next(h.amend for h in offered if set(levels[0]) <= {f.name for f in h.free})
    nominal_campaign, gains = read(tmp_path, line), []
    family = entries()[entry].FAMILY
    rivals = {*entries()[entry].CONFUSED_WITH, "fastener_loss", "pad_frequency", "deck_attachment", "sensor_gain"}
    rivals = {rival for rival in rivals & set(entries()) if family != entries()[rival].FAMILY}
    for values in levels:
        found = searched(of(nominal_campaign, 3, partial(_put, inject, values)), entry, *sorted(rivals))
        gains.append(found.gain(found.best(entry)))
    assert gains[0] < gains[1] < gains[2]
    best = found.best()
    assert best is not None
    assert best.names == (entry,)
    found_values = best.values(0)
    for name, share in near.items():
        in_metres = name in ("centre_m", "x_m") or (name == "length_m" and "centre_m" in values)
        assert abs(found_values[name] - values[name]) <= share * (1.0 if in_metres else abs(values[name])), (
            name,
            found_values,
        )


def test_absorbers_of_a_stretch_between_fasteners_are_distinguished_from_others(
    situations: Callable[[str], tuple[Situation, Campaign]], tmp_path: Path
) -> None:
    """Where they begin and end, and that they do not hang at the fasteners themselves."""
    offered = list(entries()["rail_absorber"].hypotheses(situations("viaduct")[0]))
    inject = next(h for h in offered if "between" in h.variant and "length_m" in {f.name for f in h.free}).amend
    values = {"mass_kg": 6.0, "frequency_Hz": 110.0, "loss_factor": 0.1, "centre_m": 6.3, "length_m": 4.8}
    found = searched(of(read(tmp_path, "viaduct"), 3, partial(_put, inject, values)), "rail_absorber")
    best = found.best()
    assert best is not None
    assert "between" in best.amendments[0].variant
    for other in found.members:
        if len(other.amendments) == 1 and other.amendments[0].form != best.amendments[0].form:
            assert found.gain(best) > found.gain(other) + 4.5
    found_values = best.values(0)
    for end in (-0.5, 0.5):
        fitted, true = (v["centre_m"] + end * v["length_m"] for v in (found_values, values))
        assert abs(fitted - true) < 0.35


@pytest.mark.injection
def test_slabs_cut_at_fasteners_are_distinguished_by_their_length(
    situations: Callable[[str], tuple[Situation, Campaign]], tmp_path: Path
) -> None:
    """The fastener over a cut holds both ends by halves: no cut beside it does the same."""
    offered = list(entries()["slab_joints"].hypotheses(situations("viaduct")[0]))
    shared = [h for h in offered if "dowels_N_per_m" in {f.name for f in h.free}]
    lengths = [next(f for f in h.free if f.name == "length_m").value(0.0) for h in shared]
    assert len(shared) > 2
    for index in (0, len(shared) - 1):
        values = {"length_m": lengths[index], "dowels_N_per_m": 1e5}
        observations = of(read(tmp_path / str(index), "viaduct"), 3, partial(_put, shared[index].amend, values))
        best = searched(observations, "slab_joints").best()
        assert best is not None
        found_values = best.values(0)
        assert found_values.keys() == values.keys()
        assert found_values["length_m"] == pytest.approx(lengths[index])
        assert found_values["dowels_N_per_m"] < 1e8


def test_no_stiffness_is_lost_or_won_where_a_fastener_holds_two_ends(
    situations: Callable[[str], tuple[Situation, Campaign]],
) -> None:
    situation, base = situations("viaduct")
    whole = base.model.line.joint_table()
    for hypothesis in entries()["slab_joints"].hypotheses(situation):
        values = middle(hypothesis, 0.0)
        if "dowels_N_per_m" not in values:
            continue
        line = hypothesis.amend(base, values).model.line
        table = line.joint_table()
        for index, law in enumerate(base.model.line.laws):
            assert list(line.laws)[index] == law
            assert table.scale[table.law == index].sum() == pytest.approx(whole.scale[whole.law == index].sum())


@pytest.mark.injection
@pytest.mark.parametrize("variant", ["", "shared"])
@pytest.mark.parametrize(("compliance", "frequency_Hz"), [(0.28, 75.0), (0.08, 87.0), (1.0, 19.5)])
def test_piers_of_one_girder_and_of_two_are_distinguished(
    variant: str,
    compliance: float,
    frequency_Hz: float,
    situations: Callable[[str], tuple[Situation, Campaign]],
    tmp_path: Path,
) -> None:
    """Heavy or light, on rock or on soil: found from afar, and named before a girder's own modes."""
    inject = next(h for h in entries()["pier_soil"].hypotheses(situations("two spans")[0]) if h.variant == variant)
    values = {"compliance": compliance, "frequency_Hz": frequency_Hz, "loss_factor": 0.1, "radiation": 0.03}
    observations = of(read(tmp_path, "two spans"), 3, partial(_put, inject.amend, values))
    best = searched(observations, "pier_soil", "girder_local_modes").best()
    assert best is not None
    found = best.values(0)
    assert found["frequency_Hz"] == pytest.approx(frequency_Hz, rel=0.08)
    assert found["compliance"] == pytest.approx(compliance, rel=0.15)


@pytest.mark.injection
@pytest.mark.parametrize("factor", [0.3, 3.0])
def test_a_bearing_apart_is_found(
    factor: float, situations: Callable[[str], tuple[Situation, Campaign]], tmp_path: Path
) -> None:
    hypotheses = entries()["bearing_stiffness"].hypotheses
    inject = {h.locate({}).x_m: h for h in hypotheses(situations("viaduct")[0])}[(15.0, 15.0)].amend
    observations = of(read(tmp_path, "viaduct"), 3, lambda base: inject(base, {"factor": factor}))
    rivals = ("girder_crack", "girder_local_modes", "fastener_loss", "deck_attachment")
    best = searched(observations, "bearing_stiffness", *rivals).best()
    assert best is not None
    assert best.names == ("bearing_stiffness",)
    # One bearing softer or the other stiffer: which of the two, the prior's tolerance decides.
    line = best.fit.state.solved.campaign.model.line
    table = line.joint_table()
    left, right = table.scale[table.law == list(line.laws).index("bearing")]
    assert right / left == pytest.approx(factor, rel=0.15)


@pytest.mark.injection
@pytest.mark.parametrize("factor", [0.4, 2.5])
def test_of_two_girders_that_meet_one_may_have_the_other_bearing(
    factor: float, situations: Callable[[str], tuple[Situation, Campaign]], tmp_path: Path
) -> None:
    hypotheses = entries()["bearing_stiffness"].hypotheses
    own = [h for h in hypotheses(situations("two spans")[0]) if h.variant == "one girder"]
    assert len(own) == 2
    observations = of(read(tmp_path, "two spans"), 3, lambda base: own[1].amend(base, {"factor": factor}))
    best = searched(observations, "bearing_stiffness").best()
    assert best is not None
    values = {"factor": factor}
    assert best.amendments[0].law(values) == own[1].law(values)
    assert best.values(0)["factor"] == pytest.approx(factor, rel=0.15)


def test_the_search_is_offered_the_bearings_of_both_girders_that_meet(
    situations: Callable[[str], tuple[Situation, Campaign]],
) -> None:
    situation, _ = situations("two spans")
    found = offered(entries()["bearing_stiffness"], [situation, situation])
    assert len({h.law({"factor": 0.5}) for h in found if h.variant == "one girder"}) == 2
    assert len(found) == len({(h.variant, h.law({"factor": 0.5}), h.locate({"factor": 0.5})) for h in found})


def test_a_stretch_changes_whole_joints_and_fades_between(
    situations: Callable[[str], tuple[Situation, Campaign]],
) -> None:
    _, base = situations("viaduct")

    def factors(centre: float, length: float) -> dict[float, float]:
        changed = weakened(base, "pad", centre, length, 0.2).model.line.joint_table()
        ratio = changed.scale / base.model.line.joint_table().scale
        return {round(float(x), 6): round(float(r), 6) for x, r in zip(changed.x, ratio, strict=True) if r != 1.0}

    whole = {6.6: 0.2, 7.2: 0.2, 7.8: 0.2}
    assert factors(7.2, 1.2) == whole
    # Up to a quarter of a spacing, 0.15 m, at either end changes nothing; half a spacing takes half a joint more.
    assert factors(7.3, 1.2) == whole
    assert factors(7.2, 1.8) == {6.0: 0.6, **whole, 8.4: 0.6}


def test_layer_damping_goes_both_ways(situations: Callable[[str], tuple[Situation, Campaign]]) -> None:
    situation, base = situations("viaduct")
    by_law = {h.locate({}).what: h for h in entries()["layer_damping"].hypotheses(situation)}
    assert by_law["pad"].family == "pad law"
    assert by_law["mortar"].family == "damping law"
    values = {"share": 1.0, "equal_at_Hz": 60.0}
    line = by_law["pad"].amend(base, values).model.line
    before = base.model.line.stiffness([30.0, 60.0, 120.0])[:, 0]
    laws = list(line.laws)
    after = line.stiffness([30.0, 60.0, 120.0])
    total = after[:, laws.index("pad")] + after[:, laws.index("pad_loss")]
    np.testing.assert_allclose(total.real, before.real)
    np.testing.assert_allclose(total.imag, before.imag * [0.5, 1.0, 2.0])
