"""A sensor's record comes late, or early: a filter, a wrong time stamp, a recorder whose clock runs apart."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import with_chain
from permway.diagnosis.catalogue._excite import chain_with
from permway.diagnosis.catalogue._runs import likely
from permway.diagnosis.catalogue.sensor_mounting import at_sensor
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, linear_free

ID = "sensor_delay"
DOMAIN: Domain = "measurement"
FAMILY = "sensor dynamics"
SUMMARY = "What one sensor reads comes tau late, a phase of -2 pi f tau; or ever later, as its clock is slow by e."
PARAMETERS = {
    "delay_s": "s, -0.02 to 0.02: tau",
    "clock_slow": "1, -5e-4 to 5e-4: e; over a run of length T cross spectra lose sin(pi f e T) / (pi f e T)",
}
SIGNATURE = (
    "Phase of one row of all frequency responses, or of one channel against the others, straight over f; if the "
    "clock runs apart, less coherence the higher the frequency, and no power more or less."
)
CONFUSED_WITH = {
    "sensor_mounting": "amplitudes change there",
    "sensor_polarity": "half a turn at all frequencies",
    "second_source": "of a clock that runs apart: there power is more where coherence is less",
}
SOURCE = "Bendat and Piersol, Random Data (2010), chapters 5 and 9"
SIGMA_S, SIGMA_SLOW = 2e-3, 5e-5


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each of the sensors that fit worst; on board with a clock of its own, too."""
    for name in likely(situation):
        if situation.campaign.sensor(name).degree is not None:
            yield _clock(name)

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


def _clock(name: str) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        chain = campaign.sensor(name).chain
        return with_chain(campaign, name, chain_with(chain, clock_slow=chain.clock_slow + values["clock_slow"]))

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(linear_free("clock_slow", "1", 0.0, SIGMA_SLOW, -5e-4, 5e-4),),
        amend=amend,
        locate=partial(at_sensor, name),
        starts=tuple((sign * z,) for z in (0.03, 0.12, 0.4, 1.2) for sign in (1.0, -1.0)),
        law=lambda v: f"its clock is slow by {1e6 * v['clock_slow']:.3g} in a million",
        size="clock_slow",
    )
