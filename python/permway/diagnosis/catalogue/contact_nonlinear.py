"""The contact is no linear spring: on rough rail it acts softer or stiffer than about the static load."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._excite import stays
from permway.diagnosis.catalogue._runs import excesses
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, log_free
from permway.model.contact import GivenContact

ID = "contact_nonlinear"
DOMAIN: Domain = "irregularity"
FAMILY = "contact"
SUMMARY = (
    "Equivalent linear: the contact stiffness times a factor. What a non-linear contact adds at sums and "
    "differences of frequencies, and any loss of contact, is left out."
)
PARAMETERS = {"factor": "1, 0.13 to 7.6: stiffness at work over that about the static load"}
SIGNATURE = "Axle boxes near the resonance of wheelset and rail on the contact, coherent; no frequency response."
CONFUSED_WITH = {
    "contact_filter": "what shifts with the speed",
    "wheelset_bending": "a run with another axle load moves the contact only",
}
SOURCE = "Wu and Thompson, Theoretical investigation of wheel/rail non-linear interaction (2000)"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One, where a train meets an irregularity."""
    if not excesses(situation):
        return

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        train = campaign.model.train
        assert train is not None
        contact = GivenContact(stiffness_N_per_m=train.contact.wheel_stiffness() * values["factor"])
        changed = train.model_copy(update={"contact": contact})
        return campaign.with_model(campaign.model.model_copy(update={"train": changed}))

    yield Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(log_free("factor", "1", 1.0, 1.5),),
        amend=amend,
        locate=stays("contact"),
        starts=((-0.5,), (0.5,)),
        law=lambda v: f"{v['factor']:.3g} of the stiffness about the static load",
        size="factor",
        none=1.0,
    )
