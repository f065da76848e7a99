"""The wheelsets bend: what carries the boxes moves on what rolls."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._vehicle import loudest_Hz, sensors_on, vehicle_of, with_addition
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, linear_free, log_free
from permway.model.vehicle_additions import FlexibleMode

ID = "wheelset_bending"
DOMAIN: Domain = "vehicle"
FAMILY = "vehicle resonance"
SUMMARY = "A free bending mode of every wheelset, 1 at its axle boxes: its mass, and how the contact moves in it."
PARAMETERS = {
    "ratio": "1, 0.01 to 98: the wheelset's mass over the mode's",
    "contact": "1, -3 to 1: the mode at the contact; of boxes on springs to wheels -1 over the ratio",
    "frequency_Hz": "Hz, 8.5 to 1704: of the free wheelset",
    "loss_factor": "1, 0.00125 to 1.28",
}
SIGNATURE = (
    "All axle boxes alike, a peak, or a dip and a peak above it, at frequencies that speed does not move; the "
    "mass at low frequency stays; no frequency response of the track."
)
CONFUSED_WITH = {
    "axlebox_absorber": "one wheelset only, and its mass is added at low frequency",
    "sensor_mounting": "one axle box only, no other channel moved",
    "wheel_polygon": "moves with speed",
}
SOURCE = "Popp, Kruse and Kaiser, Vehicle System Dynamics 31 (1999) 423-464"
CENTRE_HZ, FACTOR = 120.0, 1.7
RATIO, TIMES, SIZES = 1.0, 2.5, (-2.0, 0.0, 1.0)
CONTACT, SPREAD, STIFF = 0.0, 0.5, 0.7
"""Centres and standard deviations of the priors; coordinates of the ratio, and the contact of a wheelset that
hardly parts, to begin at."""


def _amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
    vehicle, ratio = vehicle_of(campaign), values["ratio"]
    if vehicle is None or ratio == 0.0:
        return campaign
    mode = FlexibleMode(
        on="wheelsets",
        modal_mass_kg=vehicle.wheelset_mass_kg / ratio,
        frequency_Hz=values["frequency_Hz"],
        loss_factor=values["loss_factor"],
        shape=values["contact"],
    )
    return with_addition(campaign, mode)


def _starts(loudest_Hz: float, size: float) -> Iterator[tuple[float, float, float, float]]:
    """Of the free wheelset the frequency that is missed most, or of one with its wheels held."""
    ratio = RATIO * TIMES**size
    for free_Hz in (loudest_Hz, loudest_Hz * float(np.sqrt(1.0 + 1.0 / ratio))):
        for contact in (-1.0 / ratio, STIFF):
            yield (
                size,
                (max(contact, -1.5) - CONTACT) / SPREAD,
                float(np.log(free_Hz / CENTRE_HZ) / np.log(FACTOR)),
                -0.7,
            )


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One, of all wheelsets alike, if axle boxes are read."""
    if vehicle_of(situation.campaign) is None:
        return
    read = sensors_on(situation, "wheelset")
    if not read:
        return
    frequencies = loudest_Hz(situation, read, 20.0, 600.0, most=2)
    yield Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            log_free("ratio", "1", RATIO, TIMES),
            linear_free("contact", "1", CONTACT, SPREAD, -3.0, 1.0),
            log_free("frequency_Hz", "Hz", CENTRE_HZ, FACTOR),
            log_free("loss_factor", "1", 0.04, 2.0),
        ),
        amend=_amend,
        locate=lambda _: Where(what="wheelsets"),
        starts=tuple(start for f in frequencies for size in SIZES for start in _starts(f, size)),
        law=lambda v: (
            f"a mode at {v['frequency_Hz']:.3g} Hz (free), loss factor {v['loss_factor']:.2g}, of "
            f"{1.0 / v['ratio']:.2f} of each wheelset's mass, contact at {v['contact']:.2f} of the boxes' motion"
        ),
        size="ratio",
        none=0.0,
    )
