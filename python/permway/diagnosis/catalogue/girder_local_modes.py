"""Parts of the girder's cross-section that move against it: flanges, deck plates, webs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._attached import spread_over
from permway.diagnosis.catalogue._change import attached_mass
from permway.diagnosis.catalogue._roles import girders
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, log_free
from permway.model.bodies import Beam

ID = "girder_local_modes"
DOMAIN: Domain = "path"
FAMILY = "girder"
SUMMARY = "A share of the girder's mass per metre once more, on springs of one frequency and loss, all along it."
PARAMETERS = {
    "mass_share": "1, 0.001 to 10: of the girder's own mass per metre",
    "frequency_Hz": "Hz, 2 to 1000: of the part, the girder held",
    "loss_factor": "1, 0.0024 to 1.5",
}
SIGNATURE = "A dip and a peak in responses of the girder and the track on it around one frequency, at all places."
CONFUSED_WITH = {
    "deck_attachment": "the effect is of one place there",
    "second_track": "a sensor on the other track",
}
SOURCE = "Ngai and Ng (2002), J. Sound and Vibration 255, 281-297: concrete box structure of a rail viaduct"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each row of girders."""
    for name in girders(situation.campaign.model.line):
        yield _of(name)


def _of(name: str) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        beam = campaign.model.line.bodies[name]
        assert isinstance(beam, Beam)
        mass = values["mass_share"] * beam.mass_kg_per_m
        law = attached_mass(mass, values["frequency_Hz"], values["loss_factor"])
        return spread_over(campaign, name, {f"{name}_part": law})

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            log_free("mass_share", "1", 0.1, 2.5),
            log_free("frequency_Hz", "Hz", 45.0, 1.9),
            log_free("loss_factor", "1", 0.06, 1.9),
        ),
        amend=amend,
        locate=lambda _: Where(what=name),
        starts=tuple((mass, float(z), 0.6) for z in np.arange(-2.1, 2.2, 0.35) for mass in (-1.0, 0.3)),
        law=lambda v: (
            f"{v['mass_share']:.2g} of the girder's mass on springs all along it, {v['frequency_Hz']:.3g} Hz, "
            f"loss factor {v['loss_factor']:.2g}"
        ),
        size="mass_share",
        none=0.0,
    )
