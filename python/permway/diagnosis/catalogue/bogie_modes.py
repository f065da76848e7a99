"""The bogie frames bend."""

from __future__ import annotations

from collections.abc import Iterator

from permway.diagnosis.catalogue._bending import bending
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation

ID = "bogie_modes"
DOMAIN: Domain = "vehicle"
FAMILY = "vehicle resonance"
SUMMARY = "A symmetric bending mode of both bogie frames, read in their middle, driven by the primary springs."
PARAMETERS = {
    "participation": "1, -4 to 4: frame's mass times the mode at the primary springs over its modal mass; "
    "the mode is 1 in the middle",
    "frequency_Hz": "Hz, 15 to 150: of the free frame",
    "loss_factor": "1, 0.005 to 0.4",
}
SIGNATURE = "Bogie channels, narrow, at a frequency that speed does not move; axle boxes and track hardly."
CONFUSED_WITH = {
    "damper_series_stiffness": "a resonance is narrow",
    "sensor_mounting": "the other bogie's channel, or the car body's",
}
SOURCE = "Claus and Schiehlen, Vehicle System Dynamics 29 (1998) supplement 538-552"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One, if a bogie frame is read."""
    yield from bending(
        situation,
        entry=ID,
        family=FAMILY,
        on="bogies",
        shape=1.0,
        centre_Hz=45.0,
        factor=1.6,
        range_Hz=(12.0, 250.0),
    )
