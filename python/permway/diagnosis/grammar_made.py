"""How an element becomes a hypothesis: where it is begun, at one place or over a stretch."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import fresh, with_joints
from permway.diagnosis.catalogue._interval import shares, spacing_of, span_of, stations_of
from permway.diagnosis.elements import Element, Values
from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import Amend, Hypothesis, Situation, Where, linear_free
from permway.diagnosis.spot import Found
from permway.diagnosis.verdict import NOVEL
from permway.model.changes import Change
from permway.model.joints import Joints

RESONANCES_HZ = np.geomspace(4.0, 150.0, 12)
"""Where resonances are looked for, beside where the free stiffness is best known."""

STRETCHES = (3.0, 9.0)
"""Usual lengths, in spacings, that a stretch is looked for with."""

CENTRES = (0.0, -4.0, 4.0, -8.0, 8.0)
"""Of those, in spacings from the most telling place: where much is missing that may be at an end of it."""

SPREAD, REACH = 4.0, 12.0
"""How well a stretch's centre is known beforehand, one standard deviation, and how far it may lie, in spacings."""

LONGEST, MOST = 24.0, 0.8
"""Of a stretch, in spacings, if its body is shorter; and the share of it that a long one is looked for with."""


def typical(found: Found) -> tuple[float, float]:
    """Size of the free stiffness where it is best known, and at which frequency."""
    known = np.abs(found.stiffness_N_per_m) / np.maximum(found.sigma_N_per_m, 1e-300)
    weight = known * np.maximum(found.by_band, 0.0)
    best = int(np.argmax(weight))
    return float(max(np.abs(found.stiffness_N_per_m[best]), 1.0)), float(found.frequency_Hz[best])


def hypothesis_of(element: Element, place: str, free: tuple[Free, ...], where: Where, amend: Amend) -> Hypothesis:
    """Of an element, which is added as `amend` says, begun with either sign, and with any resonance.

    Parameters
    ----------
    element : Element
    place : str
        In words.
    free : tuple of Free
        Its constants, what tells its size first.
    where : Where
    amend : callable
    """
    starts = [tuple(0.5 if i == 0 else 0.0 for i in range(len(free)))]
    if element.ground:
        # A resonance is met from close by only.
        centre = free[1].value(0.0)
        rest = (0.0,) * (len(free) - 2)
        starts += [(0.0, float(np.log2(f / centre)), *rest) for f in RESONANCES_HZ]
    if free[0].limits[0] < 0.0 and not element.ground:
        starts.append(tuple(-0.5 if i == 0 else 0.0 for i in range(len(free))))
    return Hypothesis(
        entry=NOVEL,
        domain="path",
        family=f"{element.name} {place}",
        free=free,
        amend=amend,
        locate=lambda _: where,
        starts=tuple(starts),
        law=lambda v: f"{element.words(v)}, {place}",
        size=free[0].name,
        none=0.0,
    )


def over_stretch(
    element: Element,
    found: Found,
    between: tuple[str, str],
    x: Reals,
    step: float,
    place: str,
    own: tuple[Free, ...] | None = None,
) -> Hypothesis:
    """An element at each of some stations about the most telling place."""
    stiffness, frequency = typical(found)
    centre, longest = found.spot.x_m[0], max(LONGEST * step, float(np.ptp(x)))
    own = own or element.free(stiffness / STRETCHES[0], frequency)
    free = (
        *own,
        linear_free("centre_m", "m", centre, SPREAD * step, centre - REACH * step, centre + REACH * step),
        linear_free("length_m", "m", STRETCHES[0] * step, 3.0 * step, 0.0, longest),
    )

    def amend(campaign: Campaign, values: Values) -> Campaign:
        name = fresh(NOVEL, campaign.model.line.laws)
        share = shares(x, values["centre_m"], values["length_m"], step)
        kept = np.flatnonzero(share > 0.0)
        changes = tuple(
            Change(from_m=float(x[i]) - 1e-6, to_m=float(x[i]) + 1e-6, factor=float(share[i]))
            for i in kept
            if share[i] < 1.0
        )
        joints = Joints(between=between, law=name, at=tuple(x[kept].tolist()), changes=changes)
        return with_joints(campaign, joints, laws={name: element.law(values)})

    def locate(values: Values) -> Where:
        return Where(found.spot.name, span_of(x, values["centre_m"], values["length_m"], step))

    made = hypothesis_of(
        element, place, free, locate({"centre_m": centre, "length_m": STRETCHES[0] * step}), amend
    )
    about = [*((at, length) for length in STRETCHES for at in CENTRES), (0.0, MOST * longest / step)]
    starts = [
        (*start[: len(own)], at / SPREAD, (length - STRETCHES[0]) / 3.0)
        for start in made.starts[:: 3 if element.ground else 1]
        for at, length in about
    ]
    return replace(made, locate=locate, starts=tuple(starts))


def over_joints(situation: Situation, element: Element, found: Found) -> Hypothesis:
    """At each joint of a stretch of its layer, as it fades out at either end."""
    line = situation.campaign.model.line
    layer = line.joints[int(line.joint_table().layer[found.spot.joints[0]])]
    x, step = stations_of(line, found.spot.name), spacing_of(line, found.spot.name)
    return over_stretch(element, found, layer.between, x, step, "beside each joint of a stretch")
