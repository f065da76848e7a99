"""One symmetric bending mode of the car body or of the bogie frames."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Literal

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._vehicle import loudest_Hz, sensors_on, vehicle_of, with_addition
from permway.diagnosis.hypothesis import Hypothesis, Situation, Where, linear_free, log_free
from permway.model.vehicle_additions import FlexibleMode


def bending(
    situation: Situation,
    *,
    entry: str,
    family: str,
    on: Literal["bogies", "body"],
    shape: float,
    centre_Hz: float,
    factor: float,
    range_Hz: tuple[float, float],
) -> Iterator[Hypothesis]:
    """The mode of a part that is read in its middle.

    What a sensor in the middle shows of the mode goes with its shape at the springs over its modal mass. So that
    ratio, times the part's mass, is the `participation`; of either sign, and 0 without an effect. The shape's
    modulus at the springs is given: it says how much the mode weighs on the springs, which hardly shows.
    """
    if vehicle_of(situation.campaign) is None:
        return
    read = sensors_on(situation, on.removesuffix("s"))
    if not read:
        return

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        vehicle, participation = vehicle_of(campaign), values["participation"]
        if vehicle is None or participation == 0.0:
            return campaign
        mass = vehicle.car_body_mass_kg if on == "body" else vehicle.bogie_mass_kg
        mode = FlexibleMode(
            on=on,
            modal_mass_kg=mass * shape / abs(participation),
            frequency_Hz=values["frequency_Hz"],
            loss_factor=values["loss_factor"],
            shape=float(np.copysign(shape, participation)),
        )
        return with_addition(campaign, mode)

    octaves = [
        float(np.log(f / centre_Hz) / np.log(factor)) for f in loudest_Hz(situation, read, *range_Hz, most=2)
    ]
    yield Hypothesis(
        entry=entry,
        domain="vehicle",
        family=family,
        free=(
            linear_free("participation", "1", 0.0, 0.6, -4.0, 4.0),
            log_free("frequency_Hz", "Hz", centre_Hz, factor),
            log_free("loss_factor", "1", 0.04, 2.0),
        ),
        amend=amend,
        locate=lambda _: Where(what=on),
        starts=tuple((size, z, 0.7) for z in octaves for size in (-0.25, 0.25, -1.2, 1.2)),
        law=lambda v: (
            f"a mode at {v['frequency_Hz']:.3g} Hz, loss factor {v['loss_factor']:.2g}, whose middle moves "
            f"{'with' if v['participation'] > 0.0 else 'against'} the springs"
        ),
        size="participation",
        none=0.0,
    )
