"""Hum of the mains in the measuring chain."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import with_chain
from permway.diagnosis.catalogue._excite import chain_with, stays
from permway.diagnosis.catalogue._runs import LINE_WIDTH, Excess, excesses, measured_psd, on_board
from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, between_free, linear_free, log_free
from permway.recordings.channel import Mains

ID = "mains_lines"
DOMAIN: Domain = "measurement"
FAMILY = "noise"
SUMMARY = (
    "Lines at multiples n of the mains' frequency, a n^-p or each of its own, in one channel, or alike in all "
    "channels on board."
)
PARAMETERS = {
    "frequency_Hz": "Hz, within 0.6 of 50, 60 or 16.7",
    "amplitude": "unit of the channel: a, of the first line",
    "decay": "1, 0 to 3: p",
    **dict.fromkeys(("second", "third", "fourth", "fifth"), "1, 0 to 10: of the first line"),
}
SIGNATURE = "Lines that no speed moves, in one channel, or coherent in several whatever their bodies do."
CONFUSED_WITH = {
    "noise_floor": "no lines",
    "wheel_polygon": "a line that goes with the speed",
}
SOURCE = "EN 50160: the supply's frequency; Bendat and Piersol, Random Data (2010), chapter 10"
MAINS_HZ = (50.0, 60.0, 50.0 / 3.0)
FACTOR = 5.0
OTHERS = ("second", "third", "fourth", "fifth")
SHARE = 0.1
"""Of the first line, that another has before anything is known."""


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """At the supply's frequency that stands out most: in all channels, and in the two that show it most.

    Lines that fall with their number, as of a rectifier's pulses, or each for itself: iron makes odd ones.
    """
    runs, sensors = excesses(situation), on_board(situation)
    if not runs or not sensors:
        return
    supply = max(MAINS_HZ, key=lambda f: _score(runs, f))
    names = [sensor.name for sensor in sensors]
    alone = [(name,) for name in sorted(names, key=lambda name: -_shown(runs, supply, name))[:2]]
    for group in [tuple(names), *alone] if len(names) > 1 else alone:
        size = min(_amplitude(situation, name, supply) for name in group)
        first = (
            linear_free("frequency_Hz", "Hz", supply, 0.05, supply - 0.6, supply + 0.6),
            log_free("amplitude", situation.campaign.sensor(group[0]).unit, 0.3 * size, FACTOR),
        )
        falling = (*first, between_free("decay", "1", 0.0, 3.0))
        own = (*first, *(log_free(name, "1", SHARE, FACTOR) for name in OTHERS))
        for free in (falling, own):
            yield _of(group, free)


def _of(group: tuple[str, ...], free: tuple[Free, ...]) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        for name in group:
            chain = campaign.sensor(name).chain
            campaign = with_chain(campaign, name, chain_with(chain, mains=_mains(values)))
        return campaign

    rest = (-0.4,) if len(free) == 3 else (0.0,) * len(OTHERS)
    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=free,
        amend=amend,
        locate=stays(channels=group),
        starts=((0.0, 0.6, *rest), (0.0, -0.6, *rest)),
        law=lambda v: f"a line of {v['amplitude']:.3g} at {v['frequency_Hz']:.4g} Hz and its multiples",
        size="amplitude",
        power=2.0,
    )


def _mains(values: Mapping[str, float]) -> Mains:
    shares = None if "decay" in values else tuple(values[name] for name in OTHERS)
    return Mains(
        frequency_Hz=values["frequency_Hz"],
        amplitude=values["amplitude"],
        decay=values.get("decay", 1.0),
        shares=shares,
    )


def _score(runs: list[Excess], supply: float) -> float:
    at = supply * np.arange(1.0, 9.0)
    # A record may end below the first line: it shows none.
    return float(sum(np.nansum(run.score_at(at)) / max(1, np.sum(at < run.frequency_Hz[-1])) for run in runs))


def _shown(runs: list[Excess], supply: float, name: str) -> float:
    at = supply * np.arange(1.0, 5.0)
    return float(sum(np.nansum(run.neper_at(at, name)) for run in runs))


def _amplitude(situation: Situation, name: str, supply: float) -> float:
    """Of a line with as much power as the channel has there, in its unit."""
    sensor = situation.campaign.sensor(name)
    powers = [float(np.interp(supply, f, power)) for f, power in measured_psd(situation, name)]
    segment = min(b.dataset.record.segment_s for b in situation.fit.observations.blocks if "psd" in b.dataset.data)
    return float(np.sqrt(2.0 * max(min(powers), 1e-30) * LINE_WIDTH / segment)) / sensor.to_SI
