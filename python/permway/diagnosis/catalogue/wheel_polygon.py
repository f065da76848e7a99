"""A wheel that is no circle: it is rough at one order of its turn."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.campaign.campaign import Campaign
from permway.campaign.excitation import WheelLines
from permway.diagnosis.catalogue._excite import stays, with_irregularity
from permway.diagnosis.catalogue._lines import coordinate
from permway.diagnosis.catalogue._runs import combs, excesses, on_board, suspects
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, log_free

ID = "wheel_polygon"
DOMAIN: Domain = "irregularity"
FAMILY = "tonal roughness"
SUMMARY = "A line of amplitude a in the roughness of one wheel, or of every wheel for itself, at n V / (2 pi R)."
PARAMETERS = {
    "order": "1, 1 to 60: n, waves per turn; no whole number where the wheel is worn below its radius on paper",
    "amplitude_m": "m, 2.1e-8 to 1.2e-3: of the wave",
}
SIGNATURE = "One line of axle boxes that goes with the speed, incoherent between wheelsets; no frequency response."
CONFUSED_WITH = {
    "rail_corrugation": "another wheel's diameter, or coherence between wheelsets at their lag",
    "wheel_flat": "further orders of the turn",
    "parametric_support": "a stretch with another spacing of fasteners",
}
SOURCE = "Nielsen and Johansson, Out-of-round railway wheels: a literature survey (2000)"
ORDERS = range(1, 61)
CENTRE, FACTOR, AMPLITUDE_M = 15.0, 2.0, 5e-6


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """Of every wheel, and of the four whose axle boxes fit worst."""
    runs = excesses(situation)
    if not runs:
        return
    around = 2.0 * np.pi * situation.campaign.stated.irregularity.wheel_radius_m
    free = (
        log_free("order", "1", CENTRE, FACTOR, lowest=0.5),
        log_free("amplitude_m", "m", AMPLITUDE_M, 3.0),
    )
    for wheel, channels in candidates(situation):
        orders = [n / around for n in ORDERS]
        found = combs(runs, orders, harmonics=1, decay=0.0, most=3, channel=channels[0] if channels else "")

        def amend(campaign: Campaign, values: Mapping[str, float], wheel: int | None = wheel) -> Campaign:
            added = WheelLines(
                order=values["order"], wheel=wheel, amplitude_m=values["amplitude_m"], harmonics=1, decay=0.0
            )
            return with_irregularity(campaign, wheels=(*campaign.stated.irregularity.wheels, added))

        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            free=free,
            amend=amend,
            locate=stays(named(wheel), channels=channels),
            starts=tuple(
                (coordinate(c.per_speed * around, CENTRE, FACTOR), coordinate(size, AMPLITUDE_M, 3.0))
                for c in found
                for size in (c.amplitude_m, 0.4 * c.amplitude_m)
            ),
            law=lambda v: f"{v['order']:.3g} waves of {1e6 * v['amplitude_m']:.3g} um per turn",
            size="amplitude_m",
            power=2.0,
        )


def candidates(
    situation: Situation, *, every: bool = True, most: int = 4
) -> list[tuple[int | None, tuple[str, ...]]]:
    """Wheels to try, from 1, with the channels on them; None for all wheels."""
    train = situation.campaign.model.train
    if train is None:
        return []
    wheel_of = {
        sensor.name: train.vehicle.wheel_indices.index(train.vehicle.degrees.index(str(sensor.degree))) + 1
        for sensor in on_board(situation)
        if train.vehicle.degrees.index(str(sensor.degree)) in train.vehicle.wheel_indices
    }
    found: list[tuple[int | None, tuple[str, ...]]] = [(None, ())] if every else []
    return found + [(wheel_of[name], (name,)) for name in suspects(situation, wheel_of, most)]


def named(wheel: int | None) -> str:
    """For people."""
    return "wheels" if wheel is None else f"wheelset {wheel}"
