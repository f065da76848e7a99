"""A sensor's record comes late, or early: a filter, a second recorder, a wrong time stamp."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

from permway.diagnosis.catalogue._change import with_chain
from permway.diagnosis.catalogue._excite import chain_with
from permway.diagnosis.catalogue._runs import likely
from permway.diagnosis.catalogue.sensor_mounting import at_sensor
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, linear_free
from permway.recordings.campaign import Campaign

ID = "sensor_delay"
DOMAIN: Domain = "measurement"
FAMILY = "sensor dynamics"
SUMMARY = "What one sensor reads comes tau later: a phase of -2 pi f tau."
PARAMETERS = {"delay_s": "s, -0.02 to 0.02: tau"}
SIGNATURE = "Phase of one row of all frequency responses, or of one channel against the others, straight over f."
CONFUSED_WITH = {
    "sensor_mounting": "amplitudes change there",
    "sensor_polarity": "half a turn at all frequencies",
}
SOURCE = "Bendat and Piersol, Random Data (2010), chapters 5 and 9"
SIGMA_S = 2e-3


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each of the sensors that fit worst."""
    for name in likely(situation):

        def amend(campaign: Campaign, values: Mapping[str, float], name: str = name) -> Campaign:
            chain = campaign.sensor(name).chain
            return with_chain(campaign, name, chain_with(chain, delay_s=chain.delay_s + values["delay_s"]))

        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            free=(linear_free("delay_s", "s", 0.0, SIGMA_S, -0.02, 0.02),),
            amend=amend,
            locate=partial(at_sensor, name),
            # Past half a turn at the top of the band a start no longer finds its way.
            starts=tuple((sign * z,) for z in (0.04, 0.15, 0.4, 1.0) for sign in (1.0, -1.0)),
            law=lambda v: f"reads {1e3 * v['delay_s']:+.3g} ms late",
            size="delay_s",
        )
