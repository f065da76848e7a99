"""A flat spot on a wheel: a blow every turn."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.campaign.campaign import Campaign
from permway.campaign.excitation import WheelLines
from permway.diagnosis.catalogue._excite import stays, with_irregularity
from permway.diagnosis.catalogue._lines import coordinate
from permway.diagnosis.catalogue._runs import combs, excesses
from permway.diagnosis.catalogue.wheel_polygon import candidates, named
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, between_free, log_free

ID = "wheel_flat"
DOMAIN: Domain = "irregularity"
FAMILY = "tonal roughness"
SUMMARY = "Lines a n^-p at all multiples n of one wheel's turn, V / (2 pi R)."
PARAMETERS = {
    "amplitude_m": "m, 8.2e-9 to 4.9e-4: a, of the first line; of a dip d deep, l long about d l / (2 pi R)",
    "decay": "1, 0 to 2: p; 0 for a dip much shorter than the wavelengths on record",
}
SIGNATURE = "A comb of lines of one axle box that goes with the speed, far up in frequency; no frequency response."
CONFUSED_WITH = {
    "wheel_polygon": "one order stands alone there",
    "rail_joint": "all wheelsets, one after the other, and another base length",
}
SOURCE = "Wu and Thompson, A hybrid model for the noise generation due to railway wheel flats (2002)"
CENTRE_M, FACTOR = 2e-6, 3.0


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """On the two wheels whose axle boxes fit worst."""
    runs = excesses(situation)
    if not runs:
        return
    around = 2.0 * np.pi * situation.campaign.stated.irregularity.wheel_radius_m
    for wheel, channels in candidates(situation, every=False, most=4):
        (found,) = combs(runs, [1.0 / around], harmonics=None, decay=0.3, most=1, channel=channels[0])
        first = coordinate(found.amplitude_m, CENTRE_M, FACTOR)

        def amend(campaign: Campaign, values: Mapping[str, float], wheel: int | None = wheel) -> Campaign:
            added = WheelLines(wheel=wheel, amplitude_m=values["amplitude_m"], decay=values["decay"])
            return with_irregularity(campaign, wheels=(*campaign.stated.irregularity.wheels, added))

        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            free=(log_free("amplitude_m", "m", CENTRE_M, FACTOR), between_free("decay", "1", 0.0, 2.0)),
            amend=amend,
            locate=stays(named(wheel), channels=channels),
            starts=((first, -1.0), (first - 1.0, -1.0)),
            law=lambda v: f"{1e6 * v['amplitude_m']:.3g} um at every turn, order n lower by n^-{v['decay']:.2f}",
            size="amplitude_m",
            power=2.0,
        )
