"""Mechanisms of no catalogue, put into the tool's own model by a joint of a law that it can solve."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from permway.campaign.campaign import Campaign
from permway.challenge.small.concealed import Concealed
from permway.challenge.small.draws import log_between
from permway.challenge.small.layouts import Layout
from permway.diagnosis.catalogue._change import fixed_mass, with_joints
from permway.laws import Hysteretic, Springpot
from permway.laws.base import Law
from permway.model.joints import GROUND, Joints

BODIES = {"deck": ("rail", "deck"), "slab": ("slab", "girder"), "ballast": ("rail",), "beam": ("beam",)}
"""Bodies on which something may act that nobody knows of."""


def outside(random: np.random.Generator, campaign: Campaign, layout: Layout) -> Concealed | None:
    """An inerter, a springpot or a negative spring between two bodies, or a body and the ground, at one place."""
    if layout.name not in BODIES:
        return None
    body = str(random.choice(BODIES[layout.name]))
    x = round(float(random.uniform(0.1, 0.9)) * layout.length_m, 2)
    kind = str(random.choice(["inerter", "springpot", "negative spring"]))
    lower, at = GROUND, x
    if kind == "inerter":
        # Between a body and the ground it would be a mass.
        uppers = {"deck": ("rail", "deck"), "slab": ("slab", "girder")}
        if layout.name not in uppers:
            return None
        body, lower = uppers[layout.name]
    make, unit = _LAWS[kind](random, body)
    words = {"inerter": ("inertance",), "springpot": ("springpot",), "negative spring": ("spring of -",)}[kind]

    def change(found: Campaign, share: float) -> Campaign:
        joint = Joints(between=(body, lower), law="outside", at=(at,))
        return with_joints(found, joint, laws={"outside": make(share)})

    return Concealed(
        id=None,
        kind=kind,
        family="outside",
        domain="path",
        change=change,
        parameters=lambda share: {"share": share},
        place=lambda _: {"body": body, "x_m": [x, x]},
        words=words,
        mechanical=f"{kind} of up to {unit} from {body} to {lower} at {x:g} m",
    )


def _inerter(random: np.random.Generator, body: str) -> tuple[Callable[[float], Law], str]:
    mass = log_between(random, 50.0, 500.0) * (1.0 if body == "rail" else 10.0)
    return lambda share: fixed_mass(mass * share), f"{mass:g} kg"


def _springpot(random: np.random.Generator, body: str) -> tuple[Callable[[float], Law], str]:
    size = log_between(random, 3.0e7, 1.0e9)
    order = round(float(random.uniform(0.4, 0.9)), 2)
    # Stiffness at 20 Hz: coefficient (2 pi 20)^order.
    coefficient = size / (2.0 * np.pi * 20.0) ** order
    return lambda share: Springpot(coefficient=coefficient * share, order=order), f"{size:g} N/m at 20 Hz"


def _negative(random: np.random.Generator, body: str) -> tuple[Callable[[float], Law], str]:
    size = log_between(random, 3.0e6, 1.0e8)
    return lambda share: Hysteretic(stiffness=-size * share, loss_factor=0.0), f"-{size:g} N/m"


_LAWS = {"inerter": _inerter, "springpot": _springpot, "negative spring": _negative}
