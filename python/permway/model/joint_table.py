"""The layers of a line, joint by joint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.model.bodies import AnyBody
from permway.model.changes import changed
from permway.model.joints import GROUND, Joints
from permway.model.kept import Kept
from permway.model.segments import Integers, Segment, end_places, find, is_placed, nearest_mass
from permway.model.stations import TOUCH_M, Along, Ends, groups


@dataclass(frozen=True)
class JointTable:
    """The joints of a line one by one, in the order of the model's layers, then along x.

    Read-only arrays, shape (J,): layer's index, x in m, upper and lower segment (-1 for the ground), law, scale.
    """

    layer: Integers
    x: Reals
    upper: Integers
    lower: Integers
    law: Integers
    scale: Reals


Columns = tuple[Reals, Integers, Integers, Reals]
"""Stations, upper and lower segments, scales."""

_LAYERS: Kept[Joints, Columns] = Kept(256)
"""Of layers: lines of a search differ in few of them."""


def joint_table(
    bodies: Mapping[str, AnyBody], layers: Sequence[Joints], laws: Sequence[str], segments: Sequence[Segment]
) -> JointTable:
    """Compile the layers.

    Raises
    ------
    InputError
        If a joint lies off one of its bodies, ties a body to itself, or is one too many at its station; if nothing
        holds a mass of a row; if a change holds no joint.
    """
    columns = []
    for index, layer in enumerate(layers):
        columns.append(_LAYERS.of(layer, partial(_changed, bodies, segments, index, layer), given=segments))
    sizes = [len(x) for x, _, _, _ in columns]
    table = JointTable(
        layer=np.repeat(np.arange(len(sizes)), sizes),
        x=np.concatenate([c[0] for c in columns] or [np.zeros(0)]),
        upper=np.concatenate([c[1] for c in columns] or [np.zeros(0, dtype=np.int64)]),
        lower=np.concatenate([c[2] for c in columns] or [np.zeros(0, dtype=np.int64)]),
        law=np.repeat(np.array([laws.index(layer.law) for layer in layers], dtype=np.int64), sizes),
        scale=np.concatenate([c[3] for c in columns] or [np.zeros(0)]),
    )
    itself = np.flatnonzero(table.upper == table.lower)
    if itself.size:
        layer_index = int(table.layer[itself[0]])
        raise InputError(
            f"ties {segments[table.upper[itself[0]]].name} to itself",
            where=f"joints[{layer_index}].between",
            value=layers[layer_index].between,
            remedy="name two bodies",
        )
    _check_held(segments, table)
    for values in vars(table).values():
        values.flags.writeable = False
    return table


def _check_held(segments: Sequence[Segment], table: JointTable) -> None:
    held = np.zeros(len(segments) + 1, dtype=np.bool_)
    held[table.upper] = held[table.lower] = True
    for segment, has_joint in zip(segments, held, strict=False):
        if is_placed(segment) and not has_joint:
            raise InputError(
                f"nothing holds {segment.name} at {segment.start:g} m",
                where=f"bodies.{segment.body}.at",
                remedy="give it a joint, with scale 0 if it is lost, or leave the mass out",
            )


def _changed(bodies: Mapping[str, AnyBody], segments: Sequence[Segment], index: int, layer: Joints) -> Columns:
    """With its changes and its scatter."""
    x, upper, lower, scale = _columns(bodies, segments, index, layer)
    return x, upper, lower, scale * changed(layer.changes, layer.scatter, x, where=f"joints[{index}]")


def _columns(bodies: Mapping[str, AnyBody], segments: Sequence[Segment], index: int, layer: Joints) -> Columns:
    if isinstance(layer.at, str):
        return _at_meetings(segments, index, layer)
    if isinstance(layer.at, Ends):
        return _at_ends(bodies, segments, index, layer, layer.at)
    return _along(segments, index, layer, layer.at)


def _along(segments: Sequence[Segment], index: int, layer: Joints, at: Along) -> Columns:
    stretches = groups(at)
    scattered = np.concatenate(stretches)
    order = np.argsort(scattered, kind="stable")
    stations = scattered[order]
    near = np.flatnonzero(np.diff(stations) < TOUCH_M)
    if near.size:
        raise InputError(
            "two joints of the layer share a station",
            where=f"joints[{index}].at",
            value=float(stations[near[0]]),
            remedy="name each station once; for two joints at one place write two layers",
        )
    upper, lower = (_side(segments, body, stations, index) for body in layer.between)
    return stations, upper, lower, layer.weights(stretches)[order]


def _at_ends(
    bodies: Mapping[str, AnyBody], segments: Sequence[Segment], index: int, layer: Joints, ends: Ends
) -> Columns:
    own = np.array([i for i, s in enumerate(segments) if s.body == ends.of], dtype=np.int64)
    x = end_places(bodies, ends)
    # Each end belongs to its own beam, even where two beams of a row meet.
    own = np.repeat(own, x.size // own.size)
    upper, lower = (
        own if body == ends.of else _side(segments, body, x, index, ends.within_m) for body in layer.between
    )
    return x, upper, lower, np.full(x.shape, layer.scale)


def _at_meetings(segments: Sequence[Segment], index: int, layer: Joints) -> Columns:
    name = layer.between[0]
    row = [(i, s) for i, s in enumerate(segments) if s.body == name and not is_placed(s)]
    if not row:
        find(segments, name, np.zeros(0), lambda _: f"joints[{index}].between[0]")
    met = [(a[0], b[0], b[1].start) for a, b in pairwise(row) if b[1].start - a[1].stop < TOUCH_M]
    if not met:
        raise InputError(
            f"no two beams of {name} meet",
            where=f"joints[{index}].at",
            value=layer.at,
            remedy="a joint ties two ends at one place: let one beam of the row start where the other stops",
        )
    x = np.array([place for _, _, place in met], dtype=np.float64)
    upper, lower = (np.array([pair[side] for pair in met], dtype=np.int64) for side in (0, 1))
    return x, upper, lower, np.full(x.shape, layer.scale)


def _side(segments: Sequence[Segment], body: str, stations: Reals, index: int, within_m: float = 0.0) -> Integers:
    if body == GROUND:
        return np.full(stations.shape, -1, dtype=np.int64)

    def where(number: int) -> str:
        return f"joints[{index}].at[{number}]"

    if within_m > 0.0 and any(body in (s.name, s.body) and is_placed(s) for s in segments):
        return nearest_mass(segments, body, stations, within_m, where)
    return find(segments, body, stations, where)
