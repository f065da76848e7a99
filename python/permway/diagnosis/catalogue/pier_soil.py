"""Bearings that stand on piers, which move on the soil, where the model has the ground."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import fixed_mass, fresh, with_line
from permway.diagnosis.catalogue._lines import coordinate
from permway.diagnosis.catalogue._roles import Layer, bearings, reaches
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, log_free
from permway.laws import Hysteretic, Parallel, Series, Springpot
from permway.laws.base import Law
from permway.model.bodies import Mass
from permway.model.joints import GROUND, Joints
from permway.model.line import Line
from permway.model.stations import Ends

ID = "pier_soil"
DOMAIN: Domain = "path"
FAMILY = "bearing and pier"
SUMMARY = "Below every bearing, or those of two girders together, a mass on a spring with loss: pier and soil."
PARAMETERS = {
    "compliance": "1, 0.002 to 120: of the soil's spring, over that of one bearing at 10 Hz",
    "frequency_Hz": "Hz, 1 to 2000: natural frequency of pier and foundation on the soil alone",
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
"""Ends of two girders no farther apart may stand on one pier."""

COMPLIANCE, PIER_HZ = (0.5, 3.0), (40.0, 2.5)
"""Usual, and the factor of one standard deviation: compliance of the soil over a bearing's, and natural frequency
of the pier on the soil alone. While that is kept, what a stiff soil changes is in proportion to its compliance."""

COMPLIANCES = (0.1, 0.4, 1.6)
"""Where starts are."""


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each layer of bearings to the ground, and one more where neighbouring girders may share piers."""
    model = situation.campaign.model
    for layer in bearings(model.line):
        if layer.lower == GROUND and not isinstance(layer.joints.at, str):
            bearing = _stiffness(model.line, layer, model.temperature_C)
            yield _below(layer, bearing)
            if isinstance(layer.joints.at, Ends) and len(reaches(model.line, layer.upper)) > 1:
                yield _below(layer, bearing, shared=True)


def _stiffness(line: Line, layer: Layer, temperature_C: float | None) -> float:
    """N/m, of one bearing."""
    return float(line.laws[layer.law].complex(np.array([AT_HZ]), temperature_C)[0].real)


def _soil(stiffness: float, loss_factor: float, radiation: float) -> Law:
    spring = Hysteretic(stiffness=stiffness, loss_factor=loss_factor)
    return Parallel(
        first=spring, second=Springpot(coefficient=radiation * stiffness / (2.0 * np.pi * AT_HZ), order=1.0)
    )


def _below(layer: Layer, stiffness: float, *, shared: bool = False) -> Hypothesis:
    free = (
        log_free("compliance", "1", *COMPLIANCE),
        log_free("frequency_Hz", "Hz", *PIER_HZ),
        log_free("loss_factor", "1", 0.15, 2.0),
        log_free("radiation", "1", 0.1, 3.0),
    )
    starts = tuple((coordinate(c, *COMPLIANCE), 0.0, 0.0, 0.0) for c in COMPLIANCES)
    whose = "under neighbouring girders' bearings together" if shared else "under each bearing"

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        if values["compliance"] == 0.0:
            return campaign
        bearing = _stiffness(campaign.model.line, layer, campaign.model.temperature_C)
        soil = _soil(bearing / values["compliance"], values["loss_factor"], values["radiation"])
        return (_on_shared if shared else _on_own)(campaign, layer, soil, mass_kg(bearing, values))

    def mass_kg(bearing: float, values: Mapping[str, float]) -> float:
        return bearing / (values["compliance"] * (2.0 * np.pi * values["frequency_Hz"]) ** 2)

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=free,
        amend=amend,
        locate=lambda _: Where(what=layer.law),
        starts=starts,
        law=lambda v: (
            f"{mass_kg(stiffness, v):.3g} kg {whose} on a spring of {1.0 / v['compliance']:.3g} times a "
            f"bearing's, loss factor {v['loss_factor']:.2g}, and {v['radiation']:.2g} more at {AT_HZ:g} Hz "
            f"by a dashpot"
        ),
        size="compliance",
        none=0.0,
        variant="shared" if shared else "",
    )


def _on_own(campaign: Campaign, layer: Layer, soil: Law, mass_kg: float) -> Campaign:
    """Each bearing in series with a pier of its own: a law, for no two of them meet."""
    line = campaign.model.line
    others = {own.law for i, own in enumerate(line.joints) if i != layer.index}
    name = fresh(layer.law, line.laws) if layer.law in others else layer.law
    below = Parallel(first=soil, second=fixed_mass(mass_kg))
    held = line.joints[layer.index].model_copy(update={"law": name})
    return with_line(
        campaign,
        joints=tuple(held if i == layer.index else own for i, own in enumerate(line.joints)),
        laws={**line.laws, name: Series(first=line.laws[layer.law], second=below)},
    )


def _on_shared(campaign: Campaign, layer: Layer, soil: Law, mass_kg: float) -> Campaign:
    """Bearings near each other on one pier: a mass between them and the ground."""
    line = campaign.model.line
    upper, at = layer.joints.between[0], layer.joints.at
    pier, name = fresh("pier", line.bodies), fresh("soil", line.laws)
    near = Ends(of=at.of, inset_m=at.inset_m, within_m=SHARED_M) if isinstance(at, Ends) else at
    held = line.joints[layer.index].model_copy(update={"between": (upper, pier), "at": near})
    return with_line(
        campaign,
        bodies={**line.bodies, pier: Mass(mass_kg=mass_kg, at=near)},
        joints=(
            *(held if i == layer.index else own for i, own in enumerate(line.joints)),
            Joints(between=(pier, GROUND), law=name, at=Ends(of=pier)),
        ),
        laws={**line.laws, name: soil},
    )
