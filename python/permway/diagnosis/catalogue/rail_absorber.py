"""Tuned absorbers on the rail: at fasteners or between them, all along or over a stretch."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import attached_mass, fresh, with_factors, with_joints
from permway.diagnosis.catalogue._roles import Layer, fasteners, spacing
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, linear_free, log_free
from permway.model.joints import GROUND, Joints

ID = "rail_absorber"
DOMAIN: Domain = "path"
FAMILY = "resonator"
SUMMARY = (
    "A mass m on a spring of loss factor eta, resonant at f0, attached to the rail at every fastener or in the "
    "middle of every bay, all along or over a stretch."
)
PARAMETERS = {
    "centre_m": "m: middle of the stretch",
    "length_m": "m: from its first mass to its last",
    "mass_kg": "kg, 0.05 to 500: of each",
    "frequency_Hz": "Hz, 6 to 3000: of the mass on its spring, the rail held",
    "loss_factor": "1, 0.005 to 5",
}
SIGNATURE = (
    "A dip and a peak in all responses of the rail, at all places alike, around one frequency that no speed and "
    "no load moves; decay along the rail rises there."
)
CONFUSED_WITH = {
    "deck_attachment": "the effect is of one place",
    "baseplate_mass": "a sensor on the base plate",
    "pad_frequency": "no dip and peak there: stiffness and loss change over octaves",
}
SOURCE = "Thompson and others (2007), Applied Acoustics 68, 43-57: a tuned damping device for railway track"


FEWEST = 8
"""Fasteners from which a stretch of them is distinguished from all."""

STRETCHES = ((0.0, 0.9), (0.0, -0.3), (-0.9, -0.5), (0.9, -0.5))
"""Middle and length that a stretch begins with, in standard deviations: most of it, its middle, either end."""


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """At all fasteners, those on the structure where others stand on the ground, or a stretch's; or between."""
    found = fasteners(situation.campaign.model.line)
    on_structure = [layer for layer in found if layer.lower != GROUND]
    if not found:
        return
    rail = found[0].joints.between[0]
    everywhere = _places(found)
    yield _everywhere(rail, everywhere, "at every fastener")
    if len(on_structure) in range(1, len(found)):
        yield _everywhere(rail, _places(on_structure), "at every fastener")
    bays = _between(everywhere)
    if bays.size:
        yield _everywhere(rail, bays, "between any two fasteners")
    few = _places(on_structure or found)
    if few.size >= FEWEST:
        yield _over_a_stretch(rail, few, "at every fastener")
        yield _over_a_stretch(rail, _between(few), "between any two fasteners")


def _places(carried: Sequence[Layer]) -> Reals:
    return np.unique(np.concatenate([layer.x for layer in carried]))


def _between(x: Reals) -> Reals:
    """The middle of every bay."""
    return np.asarray(0.5 * (x[1:] + x[:-1])[np.diff(x) < 1.5 * spacing(x)])


def _everywhere(rail: str, x: Reals, where: str) -> Hypothesis:
    reach = float(x.min()), float(x.max())

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        return _attached(campaign, rail, x, values)[0]

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            log_free("mass_kg", "kg", 5.0, 2.5),
            log_free("frequency_Hz", "Hz", 140.0, 1.9),
            log_free("loss_factor", "1", 0.15, 2.0),
        ),
        amend=amend,
        locate=lambda _: Where(what=rail, x_m=reach),
        starts=tuple((-0.3, float(z), 0.0) for z in np.arange(-2.1, 1.9, 0.4)),
        law=lambda v: (
            f"{v['mass_kg']:.3g} kg on a spring {where}, {v['frequency_Hz']:.3g} Hz, "
            f"loss factor {v['loss_factor']:.2g}"
        ),
        size="mass_kg",
        none=0.0,
        variant=where,
    )


def _over_a_stretch(rail: str, x: Reals, where: str) -> Hypothesis:
    """The same over a stretch only."""
    whole = _everywhere(rail, x, where)
    low, high = float(x.min()), float(x.max())
    middle, length = 0.5 * (low + high), high - low

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        amended, law = _attached(campaign, rail, x, values)

        def within(at: Reals) -> Reals:
            # Fading over one spacing, and flat nowhere beside: slopes show where the ends should go.
            beyond = (np.abs(at - values["centre_m"]) - 0.5 * values["length_m"]) / spacing(x)
            return np.asarray(np.clip(1.0 - beyond, 0.0, 1.0).round(12))

        return with_factors(amended, law, within)

    def locate(values: Mapping[str, float]) -> Where:
        half = 0.5 * values["length_m"]
        return Where(what=rail, x_m=(values["centre_m"] - half, values["centre_m"] + half))

    return replace(
        whole,
        free=(
            *whole.free,
            linear_free("centre_m", "m", middle, 0.25 * length, low, high),
            linear_free("length_m", "m", 0.6 * length, 0.3 * length, 0.0, length),
        ),
        amend=amend,
        locate=locate,
        starts=tuple((*start, *stretch) for stretch in STRETCHES for start in whole.starts),
    )


def _attached(campaign: Campaign, rail: str, x: Reals, values: Mapping[str, float]) -> tuple[Campaign, str]:
    """Masses on springs at some places of a rail, and the name of their law."""
    name = fresh("rail_absorber", campaign.model.line.laws)
    law = attached_mass(values["mass_kg"], values["frequency_Hz"], values["loss_factor"])
    masses = Joints(between=(rail, GROUND), law=name, at=tuple(float(one) for one in x))
    return with_joints(campaign, masses, laws={name: law}), name
