"""The car body bends."""

from __future__ import annotations

from collections.abc import Iterator

from permway.diagnosis.catalogue._bending import bending
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation

ID = "body_bending"
DOMAIN: Domain = "vehicle"
FAMILY = "vehicle resonance"
SUMMARY = "A symmetric bending mode of the car body, read in its middle, driven by the secondary suspension."
PARAMETERS = {
    "participation": "1, -4 to 4: body's mass times the mode at the bogies over its modal mass; the mode is 1 in "
    "the middle. Of a free uniform beam about -0.7",
    "frequency_Hz": "Hz, 4 to 40: of the free body",
    "loss_factor": "1, 0.005 to 0.4",
}
SIGNATURE = (
    "Car body's channel, narrow, 6 to 20 Hz, at a frequency that speed does not move, though bogie spacing over "
    "wavelength makes it come and go with speed; other channels and track hardly."
)
CONFUSED_WITH = {
    "air_spring": "a resonance is narrow",
    "damper_series_stiffness": "a resonance is narrow",
    "noise_floor": "a floor does not fall with the speed",
}
SOURCE = "Zhou, Goodall, Ren and Zhang, Journal of Rail and Rapid Transit 223 (2009) 461-471"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One, if the car body is read."""
    yield from bending(
        situation,
        entry=ID,
        family=FAMILY,
        on="body",
        shape=0.5,
        centre_Hz=10.0,
        factor=1.5,
        range_Hz=(3.0, 60.0),
    )
