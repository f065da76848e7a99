"""Something resonant hangs on an axle box: an absorber, a bracket, a generator, an antenna."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from typing import cast

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._vehicle import loudest_Hz, rows_of, sensors_on, vehicle_of, with_addition
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, log_free
from permway.model.vehicle_additions import Part, Resonator

ID = "axlebox_absorber"
DOMAIN: Domain = "vehicle"
FAMILY = "vehicle resonance"
SUMMARY = "A mass m on a spring of loss factor eta, resonant at f, added to one wheelset or to each."
PARAMETERS = {
    "mass_kg": "kg, 2 to 500: of one, for the whole wheelset",
    "frequency_Hz": "Hz, 15 to 300: with the wheelset held",
    "loss_factor": "1, 0.01 to 1",
}
SIGNATURE = (
    "The axle box that carries it, a dip at f and a peak beside it, at all speeds; its bogie follows; other axle "
    "boxes hardly; no frequency response of the track."
)
CONFUSED_WITH = {
    "wheelset_bending": "all wheelsets, whose mass at low frequency stays what it was",
    "sensor_mounting": "a peak without a dip, and no other channel moved",
}
SOURCE = "Den Hartog, Mechanical Vibrations (1956), chapter 3"
CENTRE_HZ, FACTOR = 60.0, 1.8
MOST = 3
"""Wheelsets that are each held to carry it alone."""


def _amend(part: Part, campaign: Campaign, values: Mapping[str, float]) -> Campaign:
    if values["mass_kg"] == 0.0:
        return campaign
    return with_addition(campaign, Resonator(on=part, **values))


def _at(part: Part, channels: tuple[str, ...], _: Mapping[str, float]) -> Where:
    return Where(what=part, channels=channels)


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for all wheelsets, and for those whose axle boxes deviate most one each."""
    campaign = situation.campaign
    if vehicle_of(campaign) is None or not sensors_on(situation, "wheelset"):
        return
    places: list[tuple[Part, tuple[str, ...]]] = [("wheelsets", tuple(sensors_on(situation, "wheelset")))]
    for number in (1, 2, 3, 4):
        read = sensors_on(situation, f"wheelset{number}")
        if read:
            places.append((cast(Part, f"wheelset{number}"), tuple(read)))
    single = sorted(places[1:], key=lambda place: -_deviating(situation, place[1]))[:MOST]
    for part, channels in (*places[:1], *single):
        alone = channels if part != "wheelsets" else ()
        frequencies = loudest_Hz(situation, channels, 15.0, 500.0, most=2)
        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            free=(
                log_free("mass_kg", "kg", 60.0, 2.2),
                log_free("frequency_Hz", "Hz", CENTRE_HZ, FACTOR),
                log_free("loss_factor", "1", 0.08, 2.0),
            ),
            amend=partial(_amend, part),
            locate=partial(_at, part, alone),
            starts=tuple(
                (size, float(np.log(f / CENTRE_HZ) / np.log(FACTOR)), 0.3)
                for f in frequencies
                for size in (-1.5, 0.0)
            ),
            law=lambda v: (
                f"{v['mass_kg']:.3g} kg on a spring, {v['frequency_Hz']:.3g} Hz, "
                f"loss factor {v['loss_factor']:.2g}"
            ),
            size="mass_kg",
            none=0.0,
        )


def _deviating(situation: Situation, sensors: tuple[str, ...]) -> float:
    """Mean square of what is left in a wheelset's channels."""
    mine = rows_of(situation, sensors)
    return float((situation.fit.residuals[mine] ** 2).mean()) if mine.any() else 0.0
