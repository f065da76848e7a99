"""Where small elements are put: the joints and bodies that a scan finds most telling."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from permway.diagnosis.catalogue._roles import fasteners
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.spot import Found

BESIDE_M = 2.0
"""How far from the most telling place of a scan something may stand."""

AWAY_M = 5.0
"""From the most telling joint, where another of its layer is one of another stretch."""

AS_MUCH = 2.0 * float(np.log(10.0))
"""Between the surpluses of two bodies that the records do not tell apart (90 %)."""

NEARLY = 0.8
"""Share of the surplus of the most telling joint from which joints of another layer there are tried, too: where
much is missing the scan of a base that does not fit tells the place, and hardly the layer."""


def first_of(found: Iterable[Found]) -> list[Found]:
    """The most telling place of each body or law."""
    best: dict[str, Found] = {}
    for one in found:
        best.setdefault(one.spot.name, one)
    return list(best.values())


def joints(found: Sequence[Found]) -> list[Found]:
    """The most telling joint, and those that tell nearly as much: of other layers there, of its own far away."""
    of = [one for one in found if one.spot.kind == "joint"]
    away = [abs(one.spot.x_m[0] - of[0].spot.x_m[0]) for one in of]
    near = first_of(one for one, m in zip(of, away, strict=True) if m < BESIDE_M)
    far = [one for one, m in zip(of, away, strict=True) if m > AWAY_M and one.spot.name == of[0].spot.name]
    return [one for one in (*near, *far[:1]) if one is of[0] or one.surplus > NEARLY * of[0].surplus]


def with_rail(situation: Situation, bodies: Sequence[Found]) -> list[Found]:
    """And of what pads hold, where it is none of them."""
    carried = {layer.upper for layer in fasteners(situation.campaign.model.line)}
    others = first_of(f for f in situation.found if f.spot.kind == "body" and f.spot.name in carried)
    return [*bodies, *(one for one in others if all(one is not body for body in bodies))]


def bodies(found: Sequence[Found]) -> list[Found]:
    """The most telling place of a body, and of others that tell as much: layers of a track move together."""
    kept = first_of(one for one in found if one.spot.kind == "body")
    return [one for one in kept if kept[0].surplus - one.surplus < AS_MUCH]
