"""What the parts of a line are: rails, pads, slabs, beds, girders, bearings; by what ties them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.laws.base import Law
from permway.model.bodies import Beam, Mass
from permway.model.joints import GROUND, Joints
from permway.model.kept import Kept
from permway.model.line import Line
from permway.model.segments import Segment
from permway.model.stations import Ends

FEW = 4
"""A beam that so many joints or fewer hold to the ground lies on bearings; one that more hold, on a bed."""


DENSE_M = 0.35
"""Stations closer than this stand for a continuous support."""

LOW_HZ, ROOM_C = 1.0, 20.0
"""Where a law is asked whether it carries."""


def is_rail(name: str) -> bool:
    """Whether a body is a rail."""
    return name.startswith("rail")


def body_of(name: str) -> str:
    """The row that a body belongs to: "girder" of "girder[2]"."""
    return name.split("[")[0]


@dataclass(frozen=True)
class Layer:
    """A layer of joints with its stations."""

    index: int
    joints: Joints
    x: Reals

    @property
    def upper(self) -> str:
        """Row of the upper body."""
        return body_of(self.joints.between[0])

    @property
    def lower(self) -> str:
        """Row of the lower body, or the ground."""
        return body_of(self.joints.between[1])

    @property
    def law(self) -> str:
        """Name of its law."""
        return self.joints.law


_LAYERS: Kept[Line, list[Layer]] = Kept(8)
"""Of the lines that a search goes back and forth between: every entry asks for them."""


def layers(line: Line) -> list[Layer]:
    """All layers that carry: not those that stand for an attached mass or for a loss alone."""
    return _LAYERS.of(line, lambda: _layers(line))


def _layers(line: Line) -> list[Layer]:
    table = line.joint_table()
    carrying = {name for name, law in line.laws.items() if _carries(law)}
    return [
        Layer(i, layer, table.x[table.layer == i]) for i, layer in enumerate(line.joints) if layer.law in carrying
    ]


def _carries(law: Law) -> bool:
    try:
        return bool(law.complex(LOW_HZ, ROOM_C).real > 0.0)
    except InputError:
        # A table that begins higher up is of something that was measured to carry.
        return True


def pads(line: Line) -> list[Layer]:
    """Layers that carry a rail."""
    return [layer for layer in layers(line) if is_rail(layer.upper)]


def rubbers(line: Line) -> list[str]:
    """Laws of the pads; on a rig without a rail, of what carries its masses."""
    if any(is_rail(body_of(name)) for name in line.bodies):
        return laws_of(pads(line))
    return laws_of([layer for layer in layers(line) if isinstance(line.bodies.get(layer.upper), Mass)])


def fasteners(line: Line) -> list[Layer]:
    """Layers that carry a rail at places a bay apart, not as a continuous support."""
    return [layer for layer in pads(line) if spacing(layer.x) >= DENSE_M]


def bearings(line: Line) -> list[Layer]:
    """Layers that hold a beam other than a rail at few places: at its ends, or on a few supports."""
    return [
        layer
        for layer in layers(line)
        if not is_rail(layer.upper)
        and isinstance(line.bodies.get(layer.upper), Beam)
        and not isinstance(line.bodies.get(layer.lower), Beam)
        and (isinstance(layer.joints.at, Ends) or layer.x.size <= FEW * len(reaches(line, layer.upper)))
    ]


def beds(line: Line) -> list[Layer]:
    """Layers of many joints below slabs, base plates or sleepers, the upper first: neither pads nor bearings."""
    held = {layer.index for layer in (*pads(line), *bearings(line))}
    found = [layer for layer in layers(line) if layer.index not in held and layer.upper != layer.lower]
    below_rail = carriers(line)
    return sorted(found, key=lambda layer: layer.upper not in below_rail)


def carriers(line: Line) -> list[str]:
    """Rows of bodies directly below the rail."""
    return list(dict.fromkeys(layer.lower for layer in pads(line) if layer.lower != GROUND))


def slabs(line: Line) -> list[str]:
    """Beams directly below the rail that lie on a bed."""
    return [
        name
        for name in carriers(line)
        if isinstance(line.bodies[name], Beam) and any(bed.upper == name for bed in beds(line))
    ]


def girders(line: Line) -> list[str]:
    """Beams on bearings, or pinned at an end."""
    on_bearings = {layer.upper for layer in bearings(line)}
    return [
        name
        for name, body in line.bodies.items()
        if isinstance(body, Beam) and not is_rail(name) and (name in on_bearings or any(body.pinned))
    ]


def sleepers(line: Line) -> list[str]:
    """Rows of masses directly below the rail."""
    return [name for name in carriers(line) if isinstance(line.bodies[name], Mass)]


def reaches(line: Line, body: str) -> list[Segment]:
    """The beams of a row, from left to right."""
    return [segment for segment in line.segments() if segment.body == body]


def laws_of(found: list[Layer]) -> list[str]:
    """Names of the laws of layers, each once."""
    return list(dict.fromkeys(layer.law for layer in found))


def spacing(x: Reals) -> float:
    """Median distance of neighbouring stations, m; 1 where there are none."""
    places = np.unique(x)
    return float(np.median(np.diff(places))) if places.size > 1 else 1.0
