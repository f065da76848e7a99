"""The dampers' mounts and oil give way: at speed a damper is a spring."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from typing import Literal

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._vehicle import vehicle_of, with_addition
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, log_free
from permway.model.vehicle_additions import DamperSeries, Slider

ID = "damper_series_stiffness"
DOMAIN: Domain = "vehicle"
FAMILY = "suspension law"
SUMMARY = "A spring in series with each damper of a suspension: i w c / (1 + i w t) for i w c, t = c / stiffness."
PARAMETERS = {"relaxation_time_s": "s, 0.0002 to 0.1: damping over the stiffness in series; 0 for a rigid mount"}
SIGNATURE = (
    "Bogies (primary) or car body (secondary) above 1/(2 pi t), less transmitted and stiffer; the same at all "
    "speeds; no frequency response of the track."
)
CONFUSED_WITH = {
    "air_spring": "below 5 Hz, where an air spring already stiffens",
    "bogie_modes": "a dashpot that gives way has no resonance",
}
SOURCE = (
    "Eickhoff, Evans and Minnis, Vehicle System Dynamics 24 (1995) 469-496; Bruni and others, 49 (2011) 1021-1072"
)

Suspension = Literal["primary", "secondary"]
SUSPENSIONS: tuple[Suspension, ...] = ("primary", "secondary")


def damping_of(campaign: Campaign, suspension: Suspension) -> float:
    """Of a vehicle's dampers of a kind, N s/m; 0 where none passes."""
    vehicle = vehicle_of(campaign)
    if vehicle is None:
        return 0.0
    return vehicle.primary_damping_Ns_per_m if suspension == "primary" else vehicle.secondary_damping_Ns_per_m


def _amend(suspension: Suspension, campaign: Campaign, values: Mapping[str, float]) -> Campaign:
    time, damping = values["relaxation_time_s"], damping_of(campaign, suspension)
    if time == 0.0 or damping == 0.0:
        return campaign
    return with_addition(campaign, DamperSeries(suspension=suspension, stiffness_N_per_m=damping / time))


def _at(suspension: Suspension, _: Mapping[str, float]) -> Where:
    return Where(what=f"{suspension} dampers")


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each suspension that has dampers, and none in series with them yet."""
    vehicle = vehicle_of(situation.campaign)
    for suspension in SUSPENSIONS:
        if vehicle is None or damping_of(situation.campaign, suspension) == 0.0:
            continue
        if any(isinstance(a, DamperSeries | Slider) and a.suspension == suspension for a in vehicle.additions):
            continue
        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            free=(log_free("relaxation_time_s", "s", 0.004, 3.0),),
            amend=partial(_amend, suspension),
            locate=partial(_at, suspension),
            starts=((0.0,), (-1.5,)),
            law=lambda v: f"the dampers are springs above {0.159 / max(v['relaxation_time_s'], 1e-9):.3g} Hz",
            size="relaxation_time_s",
            none=0.0,
        )
