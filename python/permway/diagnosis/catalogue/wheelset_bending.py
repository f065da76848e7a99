"""The wheelsets bend: part of their mass moves on its own."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.diagnosis.catalogue._vehicle import loudest_Hz, sensors_on, vehicle_of, with_addition
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, log_free
from permway.model.vehicle_additions import FlexibleMode
from permway.recordings.campaign import Campaign

ID = "wheelset_bending"
DOMAIN: Domain = "vehicle"
FAMILY = "vehicle resonance"
SUMMARY = "A free bending mode of every wheelset: modal mass the wheelset's over r, antiresonant at f."
PARAMETERS = {
    "ratio": "1, 0.02 to 3: r, the wheelset's mass over the mode's; r / (1 + r) of the mass moves apart",
    "frequency_Hz": "Hz, 30 to 300: with the wheels held; free it is higher by the root of 1 + r",
    "loss_factor": "1, 0.003 to 0.3",
}
SIGNATURE = (
    "All axle boxes alike, a dip and a peak above it at frequencies that speed does not move; the mass at low "
    "frequency stays; no frequency response of the track."
)
CONFUSED_WITH = {
    "axlebox_absorber": "one wheelset only, and its mass is added at low frequency",
    "sensor_mounting": "one axle box only, a peak without a dip, no other channel moved",
    "wheel_polygon": "moves with speed",
}
SOURCE = "Popp, Kruse and Kaiser, Vehicle System Dynamics 31 (1999) 423-464"
CENTRE_HZ, FACTOR = 85.0, 1.7


def _amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
    vehicle, ratio = vehicle_of(campaign), values["ratio"]
    if vehicle is None or ratio == 0.0:
        return campaign
    mode = FlexibleMode(
        on="wheelsets",
        modal_mass_kg=vehicle.wheelset_mass_kg / ratio,
        frequency_Hz=values["frequency_Hz"] * float(np.sqrt(1.0 + ratio)),
        loss_factor=values["loss_factor"],
    )
    return with_addition(campaign, mode)


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One, of all wheelsets alike, if axle boxes are read."""
    read = sensors_on(situation.campaign, "wheelset")
    if vehicle_of(situation.campaign) is None or not read:
        return
    frequencies = loudest_Hz(situation, read, 20.0, 500.0, most=2)
    yield Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            log_free("ratio", "1", 0.25, 2.0),
            log_free("frequency_Hz", "Hz", CENTRE_HZ, FACTOR),
            log_free("loss_factor", "1", 0.04, 2.0),
        ),
        amend=_amend,
        locate=lambda _: Where(what="wheelsets"),
        starts=tuple(
            (size, float(np.log(f / CENTRE_HZ) / np.log(FACTOR)), 0.7) for f in frequencies for size in (-1.5, 0.0)
        ),
        law=lambda v: (
            f"{v['ratio'] / (1.0 + v['ratio']):.2f} of each wheelset's mass moves on a spring, "
            f"{v['frequency_Hz']:.3g} Hz, loss factor {v['loss_factor']:.2g}"
        ),
        size="ratio",
        none=0.0,
    )
