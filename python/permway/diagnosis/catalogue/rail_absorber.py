"""Tuned absorbers on the rail, one at every fastener."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from permway.diagnosis.catalogue._change import fresh, hung_mass, with_joints
from permway.diagnosis.catalogue._roles import Layer, fasteners
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, log_free
from permway.model.joints import GROUND
from permway.recordings.campaign import Campaign

ID = "rail_absorber"
DOMAIN: Domain = "path"
FAMILY = "resonator"
SUMMARY = "A mass m on a spring of loss factor eta, resonant at f0, hung on the rail at every fastener."
PARAMETERS = {
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


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """At all fasteners; and at those on the structure only, where others stand on the ground."""
    found = fasteners(situation.campaign.model.line)
    on_structure = [layer for layer in found if layer.lower != GROUND]
    if found:
        yield _hypothesis(found)
    if on_structure and len(on_structure) < len(found):
        yield _hypothesis(on_structure)


def _hypothesis(carried: Sequence[Layer]) -> Hypothesis:
    rail = carried[0].joints.between[0]
    reach = min(float(layer.x.min()) for layer in carried), max(float(layer.x.max()) for layer in carried)

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        name = fresh("rail_absorber", campaign.model.line.laws)
        law = hung_mass(values["mass_kg"], values["frequency_Hz"], values["loss_factor"])
        hung = [
            layer.joints.model_copy(
                update={
                    "between": (layer.joints.between[0], GROUND),
                    "law": name,
                    "stiffness_is": "each",
                    "layer_m": None,
                    "scale": 1.0,
                    "changes": (),
                    "scatter": None,
                }
            )
            for layer in carried
        ]
        return with_joints(campaign, *hung, laws={name: law})

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
            f"{v['mass_kg']:.3g} kg on a spring at every fastener, {v['frequency_Hz']:.3g} Hz, "
            f"loss factor {v['loss_factor']:.2g}"
        ),
        size="mass_kg",
        none=0.0,
    )
