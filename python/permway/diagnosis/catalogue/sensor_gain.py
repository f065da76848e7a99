"""A sensor reads too much or too little: a wrong calibration."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import with_chain
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, log_free

ID = "sensor_gain"
DOMAIN: Domain = "measurement"
FAMILY = "level"
SUMMARY = "What one sensor reads is a constant factor off."
PARAMETERS = {"gain": "1, 0.001 to 1000: read over true"}
SIGNATURE = "One row of all frequency responses, or one channel of all runs, by one factor at all frequencies."
CONFUSED_WITH = {
    "irregularity_level": "all channels of a run move together there",
    "sensor_mounting": "the factor grows with frequency",
}
FARTHEST = 17.0
"""Standard deviations: a factor of 1000."""

SOURCE = "ISO 16063-21; Bendat and Piersol, Random Data (2010), section 8.3"


def _at(name: str, _: Mapping[str, float]) -> Where:
    return Where(channels=(name,))


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each sensor."""
    for sensor in situation.campaign.stated.sensors:

        def amend(campaign: Campaign, values: Mapping[str, float], name: str = sensor.name) -> Campaign:
            chain = campaign.sensor(name).chain
            return with_chain(campaign, name, chain.model_copy(update={"gain": chain.gain * values["gain"]}))

        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            # A unit that is mistaken (g, mV) is far from what a calibration is off by.
            free=(replace(log_free("gain", "1", 1.0, 1.5), limits=(-FARTHEST, FARTHEST)),),
            amend=amend,
            locate=partial(_at, sensor.name),
            starts=((0.13,), (-0.13,)),
            law=lambda v: f"reads {v['gain']:.3f} of what is there",
            size="gain",
            none=1.0,
        )
