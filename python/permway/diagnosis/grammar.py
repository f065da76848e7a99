"""Mechanics outside the catalogue: small elements put where something acts that no named effect explains.

An element of up to three constants (spring, dashpot, springpot, Maxwell's pair, inertance, mass on a spring,
standing rod; of either sign where the sign is free) is added to one joint, to the joints of a stretch, to every
joint of a layer, to a place or a stretch of a body, or to a body wherever it is held. What fits best is a
description, not a name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from permway.arrays import Reals
from permway.diagnosis import crossed
from permway.diagnosis import grammar_places as places
from permway.diagnosis.catalogue._change import fresh, with_joints, with_law
from permway.diagnosis.catalogue._interval import shares, spacing_of, span_of, stations_of, weakened
from permway.diagnosis.elements import ELEMENTS, PART, Element
from permway.diagnosis.ends import SPACING_M
from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import Amend, Hypothesis, Situation, Where, linear_free, log_free
from permway.diagnosis.spot import Found
from permway.diagnosis.verdict import NOVEL
from permway.laws import Parallel
from permway.model.changes import Change
from permway.model.joints import GROUND, Joints
from permway.recordings.campaign import Campaign

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

WEAKER = (-0.5, -1.5, -2.5)
"""Sizes, in coordinates, that what is beside every joint of a layer is looked for with, too."""

SHARES = (0.5, -0.5, -1.5)
"""Coordinates that a part of one joint's law is looked for with: a quarter more, one or three quarters less."""

Values = Mapping[str, float]


def hypotheses(situation: Situation, like: Values | None = None) -> Iterator[Hypothesis]:
    """Each element at the most telling joint and place of a body, or some, in every layer, and all along the rail.

    What is alike all along a track is told by no one place: where it tells most may be of another body.

    Parameters
    ----------
    situation : Situation
    like : mapping of name to float, optional
        Of a mass on a spring that explained part: what hangs on a body is looked for from there.
    """
    joints = places.joints(situation.found)
    bodies = places.bodies(situation.found)[: 1 if like is not None else None]
    layers = places.first_of(f for f in situation.found if f.spot.kind == "joint")
    along = bodies if like is not None else places.with_rail(situation, bodies)
    for element in ELEMENTS:
        if not element.ground:
            for joint in joints:
                yield _at_joint(situation, element, joint)
                yield _over_joints(situation, element, joint)
            yield from (_in_layer(element, layer) for layer in layers)
        for body in bodies:
            yield _on_body(element, body, like)
            yield _over_body(situation, element, body, like)
        for body in along:
            yield from _at_supports(situation, element, body, like)
    for joint in joints:
        yield _part_of_one(joint)
        yield _part(situation, joint)
    for joint in joints[: 1 if like is None else 0]:
        yield from crossed.at_joint(situation, joint.spot.name, joint.spot.x_m[0])


def alike(
    situation: Situation, like: Values | None, one: Hypothesis, z: tuple[float, ...]
) -> Iterator[Hypothesis]:
    """Other elements of the same constants at the same place, begun where one of them ended.

    What rings at one frequency may be met first by another element that rings there, too.

    Parameters
    ----------
    situation, like
        As of :func:`hypotheses`, which gave `one`.
    one : Hypothesis
    z : tuple of float
        Coordinates of its constants where it ended.
    """
    place, names = one.family.partition(" ")[2], [f.name for f in one.free]
    for other in hypotheses(situation, like):
        apart = other.family != one.family and other.family.partition(" ")[2] == place
        if apart and [f.name for f in other.free] == names:
            yield replace(other, starts=(z,))


def _typical(found: Found) -> tuple[float, float]:
    """Size of the free stiffness where it is best known, and at which frequency."""
    known = np.abs(found.stiffness_N_per_m) / np.maximum(found.sigma_N_per_m, 1e-300)
    weight = known * np.maximum(found.by_band, 0.0)
    best = int(np.argmax(weight))
    return float(max(np.abs(found.stiffness_N_per_m[best]), 1.0)), float(found.frequency_Hz[best])


def _made(element: Element, place: str, free: tuple[Free, ...], where: Where, amend: Amend) -> Hypothesis:
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


def _at_joint(situation: Situation, element: Element, found: Found) -> Hypothesis:
    line = situation.campaign.model.line
    table = line.joint_table()
    layer = line.joints[int(table.layer[found.spot.joints[0]])]
    x = found.spot.x_m[0]

    def amend(campaign: Campaign, values: Values) -> Campaign:
        name = fresh(NOVEL, campaign.model.line.laws)
        joints = Joints(between=layer.between, law=name, at=(x,))
        return with_joints(campaign, joints, laws={name: element.law(values)})

    return _made(
        element, "beside one joint", element.free(*_typical(found)), Where(found.spot.name, (x, x)), amend
    )


def _in_layer(element: Element, found: Found) -> Hypothesis:
    """Beside every joint of a layer; a free stiffness at one of them says little of what is so at all."""
    name = found.spot.name

    def amend(campaign: Campaign, values: Values) -> Campaign:
        law = campaign.model.line.laws[name]
        return with_law(campaign, name, Parallel(first=law, second=element.law(values)))

    made = _made(
        element, "beside every joint of the layer", element.free(*_typical(found)), Where(found.spot.name), amend
    )
    rest = (0.0,) * (len(made.free) - 1)
    return replace(made, starts=(*made.starts, *((size, *rest) for size in WEAKER)))


def _near(like: Values) -> tuple[Free, ...]:
    """Constants of what hangs on a body, about those that explained part."""
    return (
        log_free("mass_kg", "kg", like["mass_kg"], 2.0),
        log_free("frequency_Hz", "Hz", like["frequency_Hz"], 1.5),
        log_free("loss_factor", "1", like["loss_factor"], 2.0),
    )


def _on_body(element: Element, found: Found, like: Values | None = None) -> Hypothesis:
    x = found.spot.x_m[0]
    free = _near(like) if element.ground and like is not None else element.free(*_typical(found))
    # The scan looks at places a metre apart.
    free = (*free, linear_free("x_m", "m", x, 0.5, x - places.BESIDE_M, x + places.BESIDE_M))

    def amend(campaign: Campaign, values: Values) -> Campaign:
        name = fresh(NOVEL, campaign.model.line.laws)
        joints = Joints(between=(found.spot.name, GROUND), law=name, at=(values["x_m"],))
        return with_joints(campaign, joints, laws={name: element.law(values)})

    made = _made(element, "on the body", free, Where(found.spot.name, (x, x)), amend)
    return replace(made, locate=lambda v: Where(found.spot.name, (v["x_m"], v["x_m"])))


def _over_joints(situation: Situation, element: Element, found: Found) -> Hypothesis:
    """At each joint of a stretch of its layer, as it fades out at either end."""
    line = situation.campaign.model.line
    layer = line.joints[int(line.joint_table().layer[found.spot.joints[0]])]
    x, step = stations_of(line, found.spot.name), spacing_of(line, found.spot.name)
    return _stretch(element, found, layer.between, x, step, "beside each joint of a stretch")


def _part_of_one(found: Found) -> Hypothesis:
    """More or less of what one joint has: of joints that are few, as bearings, a stretch has all."""
    law, x = found.spot.name, found.spot.x_m[0]

    def amend(campaign: Campaign, values: Values) -> Campaign:
        return weakened(campaign, law, x, 0.0, 1.0 + values["share"])

    made = _made(PART, "beside one joint", PART.free(1.0, 1.0), Where(law, (x, x)), amend)
    return replace(made, starts=tuple((size,) for size in SHARES))


def _part(situation: Situation, found: Found) -> Hypothesis:
    """More or less of what the joints of a stretch have; of one, if the stretch is short."""

    def amend(campaign: Campaign, values: Values) -> Campaign:
        law, factor = found.spot.name, 1.0 + values["share"]
        return weakened(campaign, law, values["centre_m"], values["length_m"], factor)

    return replace(_over_joints(situation, PART, found), amend=amend)


def _over_body(situation: Situation, element: Element, found: Found, like: Values | None = None) -> Hypothesis:
    """At points of a stretch of a body, a metre apart."""
    same = [f.spot.x_m[0] for f in situation.found if f.spot.kind == "body" and f.spot.name == found.spot.name]
    x = np.arange(min(same), max(same) + 1e-6, SPACING_M)
    between = (found.spot.name, GROUND)
    place = f"every {SPACING_M:g} m of a stretch of the body"
    own = _near(like) if element.ground and like is not None else None
    return _stretch(element, found, between, x, SPACING_M, place, own)


def _at_supports(
    situation: Situation, element: Element, found: Found, like: Values | None = None
) -> Iterator[Hypothesis]:
    """On a body, at every station of the layer that holds it at most places."""
    body = found.spot.name
    line = situation.campaign.model.line
    laws = {layer.law for layer in line.joints if body in layer.between}
    if not laws:
        return
    holding = max(laws, key=lambda law: (stations_of(line, law).size, law))
    x = tuple(stations_of(line, holding).tolist())
    stiffness, frequency = _typical(found)
    free = (
        _near(like) if element.ground and like is not None else element.free(stiffness / STRETCHES[0], frequency)
    )

    def amend(campaign: Campaign, values: Values) -> Campaign:
        name = fresh(NOVEL, campaign.model.line.laws)
        joints = Joints(between=(body, GROUND), law=name, at=x)
        return with_joints(campaign, joints, laws={name: element.law(values)})

    yield _made(element, f"on the body at every joint of {holding}", free, Where(body), amend)


def _stretch(
    element: Element,
    found: Found,
    between: tuple[str, str],
    x: Reals,
    step: float,
    place: str,
    own: tuple[Free, ...] | None = None,
) -> Hypothesis:
    """An element at each of some stations about the most telling place."""
    stiffness, frequency = _typical(found)
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

    made = _made(element, place, free, locate({"centre_m": centre, "length_m": STRETCHES[0] * step}), amend)
    about = [*((at, length) for length in STRETCHES for at in CENTRES), (0.0, MOST * longest / step)]
    starts = [
        (*start[: len(own)], at / SPREAD, (length - STRETCHES[0]) / 3.0)
        for start in made.starts[:: 3 if element.ground else 1]
        for at, length in about
    ]
    return replace(made, locate=locate, starts=tuple(starts))
