"""A fastener of two stages: a base plate with a mass between two springs, where the model has one spring."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import fresh, with_line
from permway.diagnosis.catalogue._roles import fasteners, laws_of
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, between_free, log_free
from permway.model.bodies import Mass

ID = "baseplate_mass"
DOMAIN: Domain = "path"
FAMILY = "two-stage fastener"
SUMMARY = "The pad as two springs in series with a mass m between them, the same stiffness at rest."
PARAMETERS = {
    "mass_kg": "kg, 0.2 to 190: of each plate",
    "share": "1, 0.03 to 0.97: part of the flexibility that lies above the plate",
}
SIGNATURE = (
    "All channels from the rail, all fasteners alike, from half the plate's resonance up; the stiffness falls "
    "towards it, and what passes to the slab falls beyond."
)
CONFUSED_WITH = {
    "rail_absorber": "a sensor on the base plate; the slab moves no less there",
    "pad_frequency": "the stiffness rises with frequency there",
}
SOURCE = "Thompson, Railway Noise and Vibration (2009), chapter 3; Vincent and Thompson (1995)"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each law of pads."""
    line = situation.campaign.model.line
    for law in laws_of([layer for layer in fasteners(line) if not isinstance(layer.joints.at, str)]):
        yield _hypothesis(law)


def _hypothesis(law: str) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        mass, share = values["mass_kg"], values["share"]
        line = campaign.model.line
        if mass == 0.0:
            return campaign
        bodies, joints = dict(line.bodies), []
        for layer in line.joints:
            if layer.law != law or isinstance(layer.at, str):
                joints.append(layer)
                continue
            plate = fresh("plate", bodies)
            bodies[plate] = Mass(mass_kg=mass, at=layer.at)
            upper, lower = layer.between
            # Both stages keep the law by its name, so its parameters still act.
            stages = {(upper, plate): 1.0 / share, (plate, lower): 1.0 / (1.0 - share)}
            for between, scale in stages.items():
                joints.append(layer.model_copy(update={"between": between, "scale": layer.scale * scale}))
        return with_line(campaign, bodies=bodies, joints=tuple(joints))

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(log_free("mass_kg", "kg", 6.0, 2.0), between_free("share", "1", 0.03, 0.97)),
        amend=amend,
        locate=lambda _: Where(what=law),
        starts=((0.0, 0.0), (0.3, -0.9), (0.3, 0.9)),
        law=lambda v: f"{v['mass_kg']:.3g} kg between two springs, {v['share']:.2f} of the flexibility above it",
        size="mass_kg",
        none=0.0,
    )
