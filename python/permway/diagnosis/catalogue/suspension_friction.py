"""A suspension rubs, or its dampers blow off: a force that grows no further with velocity."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._vehicle import vehicle_of, with_addition
from permway.diagnosis.catalogue.damper_series_stiffness import SUSPENSIONS, Suspension, damping_of
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, log_free
from permway.model.vehicle_additions import DamperSeries, Slider

ID = "suspension_friction"
DOMAIN: Domain = "vehicle"
FAMILY = "friction"
SUMMARY = (
    "F erf(v / (sqrt(2) v0)) along each suspension of a kind, beside its damper or in its place: the dashpot that "
    "does the same work at each speed, and the random force that it leaves over."
)
PARAMETERS = {
    "force_N": "N, 4 to 2e5: F, of both sides",
    "velocity_m_per_s": "m/s, 3e-4 to 0.3: v0; of dampers that blow off F over their damping says it",
}
SIGNATURE = (
    "Bogies (primary) or car body (secondary): damped otherwise at each speed, and shaken beyond what the wheels "
    "hand up, incoherent with them, most where they isolate; no frequency response of the track."
)
CONFUSED_WITH = {
    "noise_floor": "one channel alone, and no other damping",
    "second_source": "one force at all speeds, and no other damping",
    "damper_series_stiffness": "coherent with the wheels, and alike at all speeds",
}
SOURCE = (
    "Booton, IRE Transactions on Circuit Theory 1 (1954) 9-18; Roberts and Spanos, Random Vibration and "
    "Statistical Linearization (1990); Bruni and others, Vehicle System Dynamics 49 (2011) 1021-1072"
)
AT_M_PER_S = 0.05
"""Velocity at which a linear damper gives the force that is sought first."""


def _beside(suspension: Suspension, campaign: Campaign, values: Mapping[str, float]) -> Campaign:
    force, v0 = values["force_N"], values["velocity_m_per_s"]
    if force == 0.0:
        return campaign
    return with_addition(campaign, Slider(suspension=suspension, force_N=force, velocity_m_per_s=v0))


def _instead(suspension: Suspension, campaign: Campaign, values: Mapping[str, float]) -> Campaign:
    force = values["force_N"]
    if np.isinf(force):
        return campaign
    # At rest it is the damper that is stated.
    v0 = force * np.sqrt(2.0 / np.pi) / damping_of(campaign, suspension)
    slider = Slider(suspension=suspension, force_N=force, velocity_m_per_s=float(v0), alone=True)
    return with_addition(campaign, slider)


def _at(suspension: Suspension, _: Mapping[str, float]) -> Where:
    return Where(what=f"{suspension} suspension")


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """Two for each suspension: friction beside its dampers, and dampers that blow off."""
    vehicle = vehicle_of(situation.campaign)
    for suspension in SUSPENSIONS:
        if vehicle is None:
            continue
        taken = [a for a in vehicle.additions if isinstance(a, DamperSeries | Slider)]
        taken = [a for a in taken if a.suspension == suspension]
        damping = damping_of(situation.campaign, suspension)
        force = log_free("force_N", "N", 800.0, 3.0)
        z = np.log(max(damping, 1.0) * AT_M_PER_S / 800.0) / np.log(3.0)
        start = float(np.clip(z, -3.0, 3.0))
        if not any(isinstance(a, Slider) for a in taken):
            yield Hypothesis(
                entry=ID,
                domain=DOMAIN,
                family=FAMILY,
                free=(force, log_free("velocity_m_per_s", "m/s", 0.01, 2.0)),
                amend=partial(_beside, suspension),
                locate=partial(_at, suspension),
                starts=((start - 0.5, 0.0), (start - 1.5, 0.0)),
                law=lambda v: (
                    f"dry friction of {v['force_N']:.3g} N, rounded below {v['velocity_m_per_s']:.2g} m/s"
                ),
                size="force_N",
                none=0.0,
            )
        if damping > 0.0 and not taken:
            yield Hypothesis(
                entry=ID,
                domain=DOMAIN,
                family=FAMILY,
                free=(force,),
                amend=partial(_instead, suspension),
                locate=partial(_at, suspension),
                starts=((start,), (start - 1.0,)),
                law=lambda v: f"dampers that blow off at {v['force_N']:.3g} N",
                size="force_N",
                none=np.inf,
                variant="blow-off",
            )
