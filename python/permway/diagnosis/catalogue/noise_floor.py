"""A channel is noisier than stated."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.blocks_noise import NoiseBlock
from permway.diagnosis.catalogue._change import with_chain
from permway.diagnosis.catalogue._excite import chain_with
from permway.diagnosis.catalogue._runs import measured_psd, on_board, suspects
from permway.diagnosis.catalogue.sensor_mounting import at_sensor
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, between_free, log_free

ID = "noise_floor"
DOMAIN: Domain = "measurement"
FAMILY = "noise"
SUMMARY = "Noise of density e N ((1 - s) + s 10 Hz / f) on top of one channel's noise floor, N as stated."
PARAMETERS = {
    "extra": "1, 1.3e-3 to 7.8e4: e",
    "flicker": "1, 0 to 1: s, the share that falls with frequency",
    "noise_ratio": "1, 1.3e-3 to 7.8e4: in hammer tests, power of its noise, as coherence states it, over others'",
}
SIGNATURE = "Power of one channel where it is low, and its coherence with the others; the same at all speeds."
CONFUSED_WITH = {
    "second_source": "what a force does follows the vehicle's resonances",
    "mains_lines": "lines",
}
SOURCE = "Bendat and Piersol, Random Data (2010), chapters 6 and 9: noise at the output"
NOISIEST = 2
"""Sensors of hammer tests that are tried."""

LOWEST = 1e-6
"""Share of a channel's least power that stands for a noise floor nobody states."""


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each of the four channels on board that fit worst, and for the noisiest of hammer tests."""
    yield from _on_board(situation)
    yield from _of_hammer_tests(situation)


def _of_hammer_tests(situation: Situation) -> Iterator[Hypothesis]:
    """The sensors whose noise differs most from that of the others."""
    own: dict[str, float] = {}
    for block in situation.fit.observations.blocks:
        if isinstance(block, NoiseBlock):
            for name, value in zip(block.names, block.own, strict=True):
                own[str(name)] = max(own.get(str(name), -np.inf), float(value))
    for name in sorted(own, key=lambda n: -own[n])[:NOISIEST]:

        def amend(campaign: Campaign, values: Mapping[str, float], name: str = name) -> Campaign:
            chain = campaign.sensor(name).chain
            return with_chain(
                campaign, name, chain_with(chain, noise_factor=chain.noise_factor * values["noise_ratio"])
            )

        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            free=(log_free("noise_ratio", "1", 10.0, 6.0),),
            amend=amend,
            locate=partial(at_sensor, name),
            starts=(((own[name] - np.log(10.0)) / np.log(6.0),),),
            law=lambda v: f"{v['noise_ratio']:.3g} times the noise of the other sensors, in power",
            size="noise_ratio",
            none=1.0,
        )


def _on_board(situation: Situation) -> Iterator[Hypothesis]:
    names = [sensor.name for sensor in on_board(situation)]
    for name in suspects(situation, names, 4):
        sensor = situation.campaign.sensor(name)
        least = min(float(np.min(power)) for _, power in measured_psd(situation, name))
        # The stated floor, not where the base's was driven to.
        stated = situation.fit.observations.campaign.sensor(name).chain.noise_floor
        unit = stated or max(LOWEST * least / sensor.to_SI**2, 1e-30)
        # As much as the least power on record, where that is more than what is stated.
        seen = float(np.log(max(least / sensor.to_SI**2 / unit, 1.0) / 10.0) / np.log(6.0))

        def amend(
            campaign: Campaign, values: Mapping[str, float], name: str = name, unit: float = unit
        ) -> Campaign:
            chain = campaign.sensor(name).chain
            added = values["extra"] * unit
            noisy = chain_with(
                chain,
                noise_floor=chain.noise_floor + added * (1.0 - values["flicker"]),
                noise_flicker=chain.noise_flicker + 10.0 * added * values["flicker"],
            )
            return with_chain(campaign, name, noisy)

        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            free=(log_free("extra", "1", 10.0, 6.0), between_free("flicker", "1", 0.0, 1.0)),
            amend=amend,
            locate=partial(at_sensor, name),
            starts=((0.0, -0.8), (min(seen, 4.5), -0.8)),
            law=lambda v: (
                f"{v['extra']:.3g} times the noise floor more, {100 * v['flicker']:.0f} % of it falling with f"
            ),
            size="extra",
        )
