"""The contact patch averages short waves of the roughness."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._excite import stays, with_irregularity
from permway.diagnosis.catalogue._runs import excesses
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, log_free

ID = "contact_filter"
DOMAIN: Domain = "irregularity"
FAMILY = "contact"
SUMMARY = "The profile's density over 1 + pi/4 (k a)^3, k the wavenumber and a half the patch's length."
PARAMETERS = {"half_length_m": "m, 0.001 to 0.3: a; 5 to 8 mm of steel on steel"}
SIGNATURE = (
    "All on-board channels fall at high frequencies, the sooner the slower the train; no frequency response."
)
CONFUSED_WITH = {
    "contact_nonlinear": "a shift of the resonance on the contact spring, the same at all speeds",
    "irregularity_level": "a slope over all wavelengths",
    "sensor_mounting": "one channel, and no speed",
}
SOURCE = "Remington, Wheel/rail noise, part IV: rolling noise (1976); Thompson, Railway Noise and Vibration (2009)"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One, where a train meets an irregularity."""
    if not excesses(situation):
        return

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        return with_irregularity(
            campaign, contact_patch_m=campaign.stated.irregularity.contact_patch_m + values["half_length_m"]
        )

    yield Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(log_free("half_length_m", "m", 0.02, 2.0),),
        amend=amend,
        locate=stays("contact"),
        starts=((0.0,), (1.5,)),
        law=lambda v: f"averages over {2e3 * v['half_length_m']:.3g} mm",
        size="half_length_m",
        power=3.0,
    )
