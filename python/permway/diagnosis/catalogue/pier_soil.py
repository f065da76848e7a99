"""Bearings that stand on piers, which move on the soil, where the model has the ground."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.diagnosis.catalogue._change import fresh, with_line
from permway.diagnosis.catalogue._roles import Layer, bearings, reaches
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, log_free
from permway.laws import Hysteretic, Parallel, Springpot
from permway.laws.base import Law
from permway.model.bodies import Mass
from permway.model.joints import GROUND, Joints
from permway.model.line import Line
from permway.model.stations import Ends
from permway.recordings.campaign import Campaign

ID = "pier_soil"
DOMAIN: Domain = "path"
FAMILY = "bearing and pier"
SUMMARY = "Below every bearing a mass on a spring with loss: pier and soil."
PARAMETERS = {
    "compliance": "1, 0.002 to 120: of the soil's spring, over that of one bearing at 10 Hz",
    "mass_kg": "kg, 1e3 to 1e7: of pier and foundation, the model's share",
    "loss_factor": "1, 0.005 to 5: of the soil's spring",
    "radiation": "1, 0 to 25: loss factor at 10 Hz of the dashpot that radiation into the soil is",
}
SIGNATURE = (
    "Responses of the girder at its ends and its rigid and first bending motions, at all supports alike; the "
    "support softens towards the pier's own frequency and stiffens beyond."
)
CONFUSED_WITH = {
    "bearing_stiffness": "one support only, and the same at all frequencies",
    "span_coupling": "a hammer test on the pier or on the neighbouring span",
}
SOURCE = "Gazetas (1991), J. Geotechnical Engineering 117, 1363-1381; Wolf (1994), simple physical models"
AT_HZ = 10.0
"""Where the dashpot's loss is counted."""

SHARED_M = 1.5
"""Ends of two girders no farther apart stand on one pier."""


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each layer of bearings to the ground."""
    line = situation.campaign.model.line
    for layer in bearings(line):
        if layer.lower == GROUND and not isinstance(layer.joints.at, str):
            yield _below(layer, _shared(line, layer))


def _shared(line: Line, layer: Layer) -> float:
    several = isinstance(layer.joints.at, Ends) and len(reaches(line, layer.upper)) > 1
    return SHARED_M if several else 0.0


def _soil(stiffness: float, loss_factor: float, radiation: float) -> Law:
    spring = Hysteretic(stiffness=stiffness, loss_factor=loss_factor)
    return Parallel(
        first=spring, second=Springpot(coefficient=radiation * stiffness / (2.0 * np.pi * AT_HZ), order=1.0)
    )


def _below(layer: Layer, within: float) -> Hypothesis:
    upper = layer.joints.between[0]

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        if values["compliance"] == 0.0:
            return campaign
        line = campaign.model.line
        pier, soil = fresh("pier", line.bodies), fresh("soil", line.laws)
        bearing = float(line.laws[layer.law].complex(np.array([10.0]), campaign.model.temperature_C)[0].real)
        at = layer.joints.at
        if isinstance(at, Ends):
            at = Ends(of=at.of, inset_m=at.inset_m, within_m=within)
        held = line.joints[layer.index].model_copy(update={"between": (upper, pier), "at": at})
        return with_line(
            campaign,
            bodies={**line.bodies, pier: Mass(mass_kg=values["mass_kg"], at=at)},
            joints=(
                *(held if i == layer.index else own for i, own in enumerate(line.joints)),
                Joints(between=(pier, GROUND), law=soil, at=Ends(of=pier)),
            ),
            laws={
                **line.laws,
                soil: _soil(bearing / values["compliance"], values["loss_factor"], values["radiation"]),
            },
        )

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            log_free("compliance", "1", 0.5, 3.0),
            log_free("mass_kg", "kg", 1e5, 2.5),
            log_free("loss_factor", "1", 0.15, 2.0),
            log_free("radiation", "1", 0.1, 3.0),
        ),
        amend=amend,
        locate=lambda _: Where(what=layer.law),
        starts=((0.0, 0.0, 0.0, 0.0), (1.0, -1.0, 0.0, 0.0), (1.0, 1.0, 0.0, 0.0)),
        law=lambda v: (
            f"{v['mass_kg']:.3g} kg on a spring of {1.0 / v['compliance']:.3g} times a bearing's stiffness, "
            f"loss factor {v['loss_factor']:.2g}, and {v['radiation']:.2g} more at {AT_HZ:g} Hz by a dashpot"
        ),
        size="compliance",
        none=0.0,
    )
