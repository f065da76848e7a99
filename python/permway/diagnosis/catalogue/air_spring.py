"""The secondary springs are of air: stiffer in motion than at rest."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._vehicle import vehicle_of, with_addition
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, log_free
from permway.model.vehicle_additions import AirSpring

ID = "air_spring"
DOMAIN: Domain = "vehicle"
FAMILY = "suspension law"
SUMMARY = "The secondary stiffness k becomes k (1 + r i f / (f0 + i f)): bellows, orifice and reservoir."
PARAMETERS = {
    "rise": "1, 0.05 to 5: growth of the stiffness from rest to fast motion",
    "transition_Hz": "Hz, 0.2 to 40: where half of it is reached",
}
SIGNATURE = (
    "Car body, less so bogies, about f0 and above; the same at all speeds; no frequency response of the track."
)
CONFUSED_WITH = {
    "damper_series_stiffness": "there the secondary stiffness at rest holds on below the dampers' corner",
    "body_bending": "a resonance of the car body, narrow",
}
SOURCE = "Berg, Vehicle System Dynamics 33 (1999) supplement 528-539, with Nishimura's model"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One, of a vehicle whose secondary springs are not of air already."""
    vehicle = vehicle_of(situation.campaign)
    if vehicle is None or any(isinstance(a, AirSpring) for a in vehicle.additions):
        return

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        return with_addition(campaign, AirSpring(rise=values["rise"], transition_Hz=values["transition_Hz"]))

    yield Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(log_free("rise", "1", 0.6, 2.0), log_free("transition_Hz", "Hz", 3.0, 2.0)),
        amend=amend,
        locate=lambda _: Where(what="secondary springs"),
        starts=((0.0, 0.0), (0.0, 1.5)),
        law=lambda v: f"{1.0 + v['rise']:.2f} times as stiff above {v['transition_Hz']:.3g} Hz as at rest",
        size="rise",
        none=0.0,
    )
