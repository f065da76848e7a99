"""A sensor mounted, or wired, the wrong way round."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import with_chain
from permway.diagnosis.catalogue._excite import chain_with
from permway.diagnosis.catalogue._runs import likely
from permway.diagnosis.catalogue.sensor_mounting import at_sensor
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, linear_free

ID = "sensor_polarity"
DOMAIN: Domain = "measurement"
FAMILY = "level"
SUMMARY = "What one sensor reads has the other sign, and nearly the right size."
PARAMETERS = {"sign": "1, -1.3 to -0.7: read over true; the power of a channel alone does not know its sign"}
SIGNATURE = "Phase of one row of all frequency responses, or of one channel against the others, by half a turn."
CONFUSED_WITH = {"sensor_delay": "a phase that grows with frequency"}
SOURCE = "ISO 5347 and ISO 16063-21: calibration of transducers"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each of the sensors that fit worst."""
    for name in likely(situation):

        def amend(campaign: Campaign, values: Mapping[str, float], name: str = name) -> Campaign:
            chain, sign = campaign.sensor(name).chain, values["sign"]
            polarity = -chain.polarity if sign < 0.0 else chain.polarity
            return with_chain(campaign, name, chain_with(chain, gain=chain.gain * abs(sign), polarity=polarity))

        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            free=(linear_free("sign", "1", -1.0, 0.05, -1.3, -0.7),),
            amend=amend,
            locate=partial(at_sensor, name),
            starts=((0.0,),),
            law=lambda v: f"reads {v['sign']:.3f} of what is there",
            size="sign",
            none=1.0,
        )
