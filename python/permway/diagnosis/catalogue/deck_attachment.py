"""Something on the deck: a mass on a spring, tuned or not."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import attached_mass, fresh, with_joints
from permway.diagnosis.catalogue._roles import girders
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, linear_free, log_free
from permway.diagnosis.location import step_m
from permway.model.bodies import Beam
from permway.model.joints import GROUND, Joints

ID = "deck_attachment"
DOMAIN: Domain = "path"
FAMILY = "resonator"
SUMMARY = "A mass m on a spring of loss factor eta at its resonance f0, attached to the girder at x."
PARAMETERS = {
    "x_m": "m: where it stands",
    "mass_kg": "kg, 0.0005 to 0.15 of the girder's mass",
    "frequency_Hz": "Hz, 2 to 300: of the mass on its spring, the girder held",
    "loss_factor": "1, 0.005 to 0.5: at that frequency; of a dashpot twice its damping ratio",
    "dashpot": "1, 0 to 1: share of the loss that is a dashpot's, which grows with frequency",
}
SIGNATURE = "A dip and a peak in all responses of the deck around one frequency that no speed and no load moves."
CONFUSED_WITH = {
    "girder_local_modes": "the effect is the same all along the girder",
    "rail_absorber": "the effect is the same at every fastener",
    "span_coupling": "a hammer test on the neighbouring span",
}
SOURCE = "Den Hartog, Mechanical Vibrations (1956), chapter 3"

TYPICAL, SPAN_M = 0.01, 40.0
"""Of the girder's mass, of so many metres at most, for what stands on a longer one is no heavier: the middle of
its prior. Half and twice of either are a fifth of its standard deviation."""


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """At a place of the girder, at frequencies over the records' range."""
    for body in girders(situation.campaign.model.line):
        yield from resonators(situation, body, ID)


def resonators(situation: Situation, body: str, entry: str) -> Iterator[Hypothesis]:
    """On any beam, at the first place that is looked at."""
    best = situation.bodies(body, most=1)
    if not best:
        return
    centre, name = best[0].x_m, best[0].name
    segment = next(s for s in situation.campaign.model.line.segments() if s.name == name)
    span = segment.stop - segment.start
    sigma = 3.0 * step_m(span)
    beam = situation.campaign.model.line.bodies[body]
    assert isinstance(beam, Beam)
    typical = TYPICAL * beam.mass_kg_per_m * min(span, SPAN_M)
    low, high = max(segment.start, centre - 4.0 * sigma), min(segment.stop, centre + 4.0 * sigma)

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        law = fresh("attachment", campaign.model.line.laws)
        hung = attached_mass(*(values[key] for key in ("mass_kg", "frequency_Hz", "loss_factor", "dashpot")))
        return with_joints(
            campaign,
            Joints(between=(name, GROUND), law=law, at=(values["x_m"],)),
            laws={law: hung},
        )

    # The likeliest first.
    octaves = sorted((np.log(np.geomspace(4.0, 150.0, 12) / 25.0) / np.log(2.5)).tolist(), key=abs)
    yield Hypothesis(
        entry=entry,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            linear_free("x_m", "m", centre, sigma, low, high),
            log_free("mass_kg", "kg", typical, 2.5),
            log_free("frequency_Hz", "Hz", 25.0, 2.5),
            log_free("loss_factor", "1", 0.05, 2.0),
            linear_free("dashpot", "1", 0.5, 0.5, 0.0, 1.0),
        ),
        amend=amend,
        locate=lambda v: Where(what=name, x_m=(v["x_m"], v["x_m"])),
        starts=tuple((0.0, 0.0, z, 0.3, 0.0) for z in octaves),
        law=lambda v: (
            f"{v['mass_kg']:.3g} kg on a spring, {v['frequency_Hz']:.3g} Hz, loss factor {v['loss_factor']:.2g}"
        ),
        size="mass_kg",
        none=0.0,
    )
