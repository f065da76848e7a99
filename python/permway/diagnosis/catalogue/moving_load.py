"""Constant wheel loads deflect every span that they pass."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.campaign.campaign import Campaign
from permway.campaign.excitation import TrackLines
from permway.diagnosis.catalogue._excite import spans, stays, with_irregularity
from permway.diagnosis.catalogue._runs import excesses
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, log_free
from permway.model.bodies import Beam

ID = "moving_load"
DOMAIN: Domain = "irregularity"
FAMILY = "tied to speed over length"
SUMMARY = (
    "Lines at multiples n of V / L of amplitude c P L^3 / (pi^4 E I n^4): what a beam on two bearings gives way "
    "under a bogie's load P that moves along it. Wheelbase, the other bogie and the beam's inertia are left out "
    "and stand in c."
)
PARAMETERS = {"factor": "1, 0.07 to 14: c; 1 is the beam's own law"}
SIGNATURE = "Lines at V / L and 2 V / L of all on-board channels, the car body's first."
CONFUSED_WITH = {
    "span_camber": "nothing on board at one axle load: the two differ by how fast lines fall (n^-4 here); a run "
    "with another load, or a gauge under the span, separates them",
    "rail_joint": "lines reach far up there",
}
SOURCE = "Fryba, Vibration of Solids and Structures under Moving Loads (1999), chapter 1"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """For the first span; all are taken to be alike."""
    model = situation.campaign.model
    if not excesses(situation) or model.train is None:
        return
    for name, start, stop in spans(model.line, model.train.body)[:1]:
        body = name.split("[")[0]

        def amend(
            campaign: Campaign, values: Mapping[str, float], body: str = body, length: float = stop - start
        ) -> Campaign:
            added = TrackLines(
                length_m=length, amplitude_m=values["factor"] * _first(campaign, body, length), decay=4.0
            )
            return with_irregularity(campaign, series=(*campaign.stated.irregularity.series, added))

        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            free=(log_free("factor", "1", 1.0, 1.7),),
            amend=amend,
            locate=stays(name, (start, stop)),
            starts=((0.0,), (2.0,)),
            law=lambda v: f"{v['factor']:.3g} times the deflection under a bogie that crosses the span",
            size="factor",
            power=2.0,
        )


def _first(campaign: Campaign, body: str, length: float) -> float:
    """Amplitude of the first line, m: x^2 (1 - x)^2 has the lines 3 / (pi n)^4."""
    model = campaign.model
    beam = model.line.bodies[body]
    assert model.train is not None
    assert isinstance(beam, Beam)
    vehicle = model.train.vehicle
    load = 2.0 * 2.0 * vehicle.share * vehicle.static_wheel_load_N
    return load * length**3 / (np.pi**4 * beam.bending_Nm2.real)
