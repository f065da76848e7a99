"""Mechanics outside the catalogue: small elements put where something acts that no named effect explains.

An element of up to three constants (spring, dashpot, springpot, Maxwell's pair, inertance, mass on a spring,
standing rod; of either sign where the sign is free) is added to one joint, to the joints of a stretch, to every
joint of a layer, to a place or a stretch of a body, or to a body wherever it is held. What fits best is a
description, not a name.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis import crossed
from permway.diagnosis import grammar_places as places
from permway.diagnosis.catalogue._change import fresh, with_joints, with_law
from permway.diagnosis.catalogue._interval import stations_of
from permway.diagnosis.elements import ELEMENTS, Element, Values
from permway.diagnosis.ends import SPACING_M
from permway.diagnosis.fit import Free
from permway.diagnosis.grammar_made import STRETCHES, hypothesis_of, over_joints, over_stretch, typical
from permway.diagnosis.grammar_parts import part, part_of_one, parts_lost, springpot_instead
from permway.diagnosis.hypothesis import Hypothesis, Situation, Where, linear_free, log_free
from permway.diagnosis.spot import Found
from permway.diagnosis.verdict import NOVEL
from permway.laws import Parallel
from permway.model.joints import GROUND, Joints

WEAKER = (-0.5, -1.5, -2.5)
"""Sizes, in coordinates, that what is beside every joint of a layer is looked for with, too."""


HUNG, LUMPED = 8, 10.0
"""Places of a body where one mass is tried in place of what hangs all along, and metres that it stands for."""


def hypotheses(situation: Situation, like: Values | None = None) -> Iterator[Hypothesis]:
    """Each element at the most telling joint and place of a body, or some, in every layer, and all along the rail.

    What is alike all along a track is told by no one place: where it tells most may be of another body.

    Parameters
    ----------
    situation : Situation
    like : mapping of name to float, optional
        Of a mass on a spring that explained part: what hangs on a body is looked for from there.
    """
    yield from _elements(situation, like)
    if like is None:
        for layer in _layers(situation):
            yield from parts_lost(situation, layer)
            yield springpot_instead(layer)


def _elements(situation: Situation, like: Values | None) -> Iterator[Hypothesis]:
    joints = places.joints(situation.found)
    bodies = places.bodies(situation.found)[: 1 if like is not None else None]
    along = bodies if like is not None else places.with_rail(situation, bodies)
    for element in ELEMENTS:
        if not element.ground:
            for joint in joints:
                yield _at_joint(situation, element, joint)
                yield over_joints(situation, element, joint)
            yield from (_in_layer(element, layer) for layer in _layers(situation))
        for body in bodies:
            yield _on_body(element, body, like)
            yield _over_body(situation, element, body, like)
        for body in along:
            yield from _at_supports(situation, element, body, like)
    for joint in joints:
        yield part_of_one(joint)
        yield part(situation, joint)
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
    for other in _elements(situation, like):
        apart = other.family != one.family and other.family.partition(" ")[2] == place
        if apart and [f.name for f in other.free] == names:
            yield replace(other, starts=(z,))


def hung(situation: Situation, body: str, like: Values) -> Iterator[Hypothesis]:
    """A mass on a spring at places of a body, or over a stretch of it, where one all along it explained much.

    Parameters
    ----------
    situation : Situation
    body : str
    like : mapping of name to float
        Of what hangs on each metre of it.
    """
    mine = [f for f in situation.found if f.spot.kind == "body" and f.spot.name == body]
    taken: list[Found] = []
    for one in mine:
        if all(abs(one.spot.x_m[0] - other.spot.x_m[0]) >= 2.0 * places.BESIDE_M for other in taken):
            taken.append(one)
    heavier = {**like, "mass_kg": LUMPED * like["mass_kg"]}
    resonator = next(element for element in ELEMENTS if element.name == "resonator")
    for one in taken[:HUNG]:
        on = _on_body(resonator, one, heavier)
        yield replace(on, starts=((0.0,) * len(on.free),))
    for one in taken[:1]:
        yield _over_body(situation, resonator, one, like)


def _layers(situation: Situation) -> list[Found]:
    """The most telling joint of each."""
    return places.first_of(f for f in situation.found if f.spot.kind == "joint")


def _at_joint(situation: Situation, element: Element, found: Found) -> Hypothesis:
    line = situation.campaign.model.line
    table = line.joint_table()
    layer = line.joints[int(table.layer[found.spot.joints[0]])]
    x = found.spot.x_m[0]

    def amend(campaign: Campaign, values: Values) -> Campaign:
        name = fresh(NOVEL, campaign.model.line.laws)
        joints = Joints(between=layer.between, law=name, at=(x,))
        return with_joints(campaign, joints, laws={name: element.law(values)})

    return hypothesis_of(
        element, "beside one joint", element.free(*typical(found)), Where(found.spot.name, (x, x)), amend
    )


def _in_layer(element: Element, found: Found) -> Hypothesis:
    """Beside every joint of a layer; a free stiffness at one of them says little of what is so at all."""
    name = found.spot.name

    def amend(campaign: Campaign, values: Values) -> Campaign:
        law = campaign.model.line.laws[name]
        return with_law(campaign, name, Parallel(first=law, second=element.law(values)))

    made = hypothesis_of(
        element, "beside every joint of the layer", element.free(*typical(found)), Where(found.spot.name), amend
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
    free = _near(like) if element.ground and like is not None else element.free(*typical(found))
    # The scan looks at places a metre apart.
    free = (*free, linear_free("x_m", "m", x, 0.5, x - places.BESIDE_M, x + places.BESIDE_M))

    def amend(campaign: Campaign, values: Values) -> Campaign:
        name = fresh(NOVEL, campaign.model.line.laws)
        joints = Joints(between=(found.spot.name, GROUND), law=name, at=(values["x_m"],))
        return with_joints(campaign, joints, laws={name: element.law(values)})

    made = hypothesis_of(element, "on the body", free, Where(found.spot.name, (x, x)), amend)
    return replace(made, locate=lambda v: Where(found.spot.name, (v["x_m"], v["x_m"])))


def _over_body(situation: Situation, element: Element, found: Found, like: Values | None = None) -> Hypothesis:
    """At points of a stretch of a body, a metre apart."""
    same = [f.spot.x_m[0] for f in situation.found if f.spot.kind == "body" and f.spot.name == found.spot.name]
    x = np.arange(min(same), max(same) + 1e-6, SPACING_M)
    between = (found.spot.name, GROUND)
    place = f"every {SPACING_M:g} m of a stretch of the body"
    own = _near(like) if element.ground and like is not None else None
    return over_stretch(element, found, between, x, SPACING_M, place, own)


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
    stiffness, frequency = typical(found)
    free = (
        _near(like) if element.ground and like is not None else element.free(stiffness / STRETCHES[0], frequency)
    )

    def amend(campaign: Campaign, values: Values) -> Campaign:
        name = fresh(NOVEL, campaign.model.line.laws)
        joints = Joints(between=(body, GROUND), law=name, at=x)
        return with_joints(campaign, joints, laws={name: element.law(values)})

    yield hypothesis_of(element, f"on the body at every joint of {holding}", free, Where(body), amend)
