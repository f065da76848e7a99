"""A track with its joints and masses shared out over the length."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.model.beam_columns import section
from permway.model.bodies import Beam, Mass, Shaft
from permway.model.line import Line

_FEWEST_JOINTS = 8
"""Joints of a layer in the stretch below which it is no bed. Half would share out bearings; twice would refuse
short test tracks."""
_WIDEST_M = 5.0
"""Mean spacing above which a layer is no bed, for critical waves have 2 to 40 m. Half would refuse no track; twice
would share out the bearings of short spans."""
_COVERED = 0.95
"""Share of the stretch that a body has to cover to be taken as continuous without a note."""


@dataclass(frozen=True)
class Layer:
    """A continuous layer: bodies by index (-1 for the ground), index of its law, and joints' scale per metre."""

    upper: int
    lower: int
    law: int
    per_m: float


@dataclass(frozen=True)
class Bed:
    """A continuous track.

    Attributes
    ----------
    bodies : tuple of str
        The body that the load moves on first.
    sections : tuple of (bending N m2, shear N, mass kg/m, rotary kg m)
        Real parts; bending and shear are zero of masses.
    layers : tuple of Layer
    stretch_m : (float, float)
    spacing_m : float
        Of the densest layer.
    notes : tuple of str
        What was taken as rigid, or only partly covers the stretch.
    """

    bodies: tuple[str, ...]
    sections: tuple[tuple[float, float, float, float], ...]
    layers: tuple[Layer, ...]
    stretch_m: tuple[float, float]
    spacing_m: float
    notes: tuple[str, ...]

    def matrices(self, kappa: float, laws: Reals) -> tuple[Reals, Reals]:
        """Stiffness and mass per metre for waves of one wavenumber; rotations of Timoshenko beams come last.

        Parameters
        ----------
        kappa : float
            rad/m.
        laws : ndarray, shape (L,)
            Real stiffness of each law, N/m.
        """
        turning = [i for i, (bending, shear, _, _) in enumerate(self.sections) if bending > 0.0 and shear > 0.0]
        count = len(self.bodies)
        stiffness = np.zeros((count + len(turning),) * 2)
        mass = np.zeros(count + len(turning))
        for i, (bending, shear, m, _) in enumerate(self.sections):
            mass[i] = m
            stiffness[i, i] = shear * kappa**2 if shear > 0.0 else bending * kappa**4
        for k, i in enumerate(turning, start=count):
            bending, shear, _, rotary = self.sections[i]
            # Shear strain is slope less rotation, a quarter of a wave apart: real with the rotation taken so.
            stiffness[i, k] = stiffness[k, i] = -shear * kappa
            stiffness[k, k] = bending * kappa**2 + shear
            mass[k] = rotary
        for layer in self.layers:
            s = layer.per_m * float(laws[layer.law])
            for one, other in ((layer.upper, layer.lower), (layer.lower, layer.upper)):
                if one >= 0:
                    stiffness[one, one] += s
                    if other >= 0:
                        stiffness[one, other] -= s
        return stiffness, np.diag(mass)


def continuous(
    line: Line,
    *,
    body: str | None = None,
    from_m: float | None = None,
    to_m: float | None = None,
    held: tuple[str, ...] = (),
) -> Bed:
    """Share joints and masses out over a stretch; see :func:`permway.response.dispersion.dispersion`."""
    body = _carrier(line, body)
    for name in held:
        if name not in line.bodies or name == body:
            raise InputError(
                "is no body that can be held",
                where="held",
                value=name,
                remedy=f"use one of {[other for other in line.bodies if other != body]}",
            )
    table, segments = line.joint_table(), line.segments()
    names = np.array([s.body for s in segments] + ["ground"])
    upper, lower = names[table.upper], names[table.lower]
    own = (upper == body) | (lower == body)
    if not own.any():
        raise InputError(f"nothing bears {body!r}", where="body", value=body, remedy="give it joints")
    most = np.bincount(table.layer[own]).argmax()
    stretch = _stretch(table.x[own & (table.layer == most)], body, from_m, to_m)
    rigid = dict.fromkeys(held, "asked for")
    notes: list[str] = []
    found = _layers(line, body, stretch, rigid, notes)
    moving = _moving(body, found, rigid)
    grounded = {str(one) for one, other in zip(upper, lower, strict=True) if other == "ground"}
    if not any(other == "ground" or other in rigid or one in rigid for one, other, _, _, _ in found):
        for name in moving[1:]:
            if name in grounded:
                rigid[name] = "tied to the ground outside the stretch only"
    notes += [f"{name} is taken as rigid ({why})" for name, why in rigid.items()]
    return _bed(line, body, found, rigid, stretch, notes)


_Layers = list[tuple[str, str, int, float, int]]
"""Upper and lower body, law, scale per metre and joints of each layer."""


def _layers(
    line: Line, body: str, stretch: tuple[float, float], rigid: dict[str, str], notes: list[str]
) -> _Layers:
    """Layers that are beds in the stretch; what stands on less goes to the rigid bodies."""
    table, segments = line.joint_table(), line.segments()
    names = np.array([s.body for s in segments] + ["ground"])
    upper, lower = names[table.upper], names[table.lower]
    inside = (table.x >= stretch[0] - 1e-9) & (table.x < stretch[1] - 1e-9)
    length = stretch[1] - stretch[0]
    found: _Layers = []
    for index, layer in enumerate(line.joints):
        rows = inside & (table.layer == index)
        count = int(np.sum(rows & (table.scale != 0.0)))
        if not count:
            continue
        one, other = str(upper[rows][0]), str(lower[rows][0])
        if one in rigid and (other in rigid or other == "ground"):
            continue
        if count >= _FEWEST_JOINTS and length / count <= _WIDEST_M:
            found.append((one, other, int(table.law[rows][0]), float(table.scale[rows].sum()) / length, count))
        elif one == body:
            notes.append(f"{count} joints of {one} and {other} ({layer.law}) are no bed and left out")
        else:
            rigid[one] = f"{count} joints of {layer.law} below it are no bed"
    return found


def _moving(body: str, found: _Layers, rigid: dict[str, str]) -> list[str]:
    """The carrier, and what it moves through the layers."""
    moving = [body]
    for name in moving:
        for one, other, _, _, _ in found:
            for here, there in ((one, other), (other, one)):
                if here == name and there not in rigid and there != "ground" and there not in moving:
                    moving.append(there)
    return moving


def _bed(
    line: Line,
    body: str,
    found: _Layers,
    rigid: dict[str, str],
    stretch: tuple[float, float],
    notes: list[str],
) -> Bed:
    moving = _moving(body, found, rigid)
    layers = []
    for one, other, law, per_m, _ in found:
        a, b = (moving.index(name) if name in moving else -1 for name in (one, other))
        if a >= 0 or b >= 0:
            layers.append(Layer(a, b, law, per_m))
    if not layers:
        raise InputError(
            f"nothing bears {body!r} as a bed between {stretch[0]:g} and {stretch[1]:g} m",
            where="from_m",
            remedy="choose a stretch with joints at regular places, from_m to to_m",
        )
    sections = tuple(_section(line, name, stretch, notes) for name in moving)
    length = stretch[1] - stretch[0]
    spacing = min(length / count for one, other, _, _, count in found if one in moving or other in moving)
    return Bed(tuple(moving), sections, tuple(layers), stretch, spacing, tuple(notes))


def _carrier(line: Line, body: str | None) -> str:
    beams = [name for name, each in line.bodies.items() if isinstance(each, Beam)]
    if body is None:
        endless = [name for name in beams if getattr(line.bodies[name], "intervals_m", None) is None]
        if not beams:
            raise InputError("the line has no beam", where="line.bodies", remedy="give it a rail")
        return (endless or beams)[0]
    if body not in beams:
        raise InputError("is no beam of the line", where="body", value=body, remedy=f"use one of {beams}")
    return body


def _stretch(x: Reals, body: str, from_m: float | None, to_m: float | None) -> tuple[float, float]:
    """The stretch asked for, or that of the body's joints, each with half a spacing on either side."""
    stations = np.unique(x)
    if len(stations) < 2:
        raise InputError(f"{body!r} has fewer than two joints", where="body", value=body, remedy="give it a bed")
    spacing = float(np.median(np.diff(stations)))
    start = float(stations[0]) - 0.5 * spacing if from_m is None else from_m
    stop = float(stations[-1]) + 0.5 * spacing if to_m is None else to_m
    if not (math.isfinite(start) and math.isfinite(stop) and start < stop):
        raise InputError("the stretch does not run from left to right", where="from_m", value=(start, stop))
    return start, stop


def _section(
    line: Line, name: str, stretch: tuple[float, float], notes: list[str]
) -> tuple[float, float, float, float]:
    body, length = line.bodies[name], stretch[1] - stretch[0]
    reaches = [(s.start, s.stop) for s in line.segments() if s.body == name]
    if isinstance(body, Mass):
        count = sum(stretch[0] - 1e-9 <= start < stretch[1] - 1e-9 for start, _ in reaches)
        if body.at is None:
            raise InputError(
                f"{name!r} is one mass and no row of them",
                where=f"line.bodies.{name}",
                remedy="give it places (at), or hold it",
            )
        return 0.0, 0.0, body.mass_kg * count / length, 0.0
    assert isinstance(body, Beam | Shaft)
    covered = sum(max(min(stop, stretch[1]) - max(start, stretch[0]), 0.0) for start, stop in reaches) / length
    if covered < _COVERED:
        notes.append(f"{name} covers {100.0 * covered:.0f} % of the stretch and is taken as continuous")
    elif len(reaches) > 1:
        notes.append(f"{name} is taken as continuous over its {len(reaches)} pieces")
    if body.changes:
        notes.append(f"changes of the section of {name} are left out")
    bending, shear, mass, rotary, _ = section(body)
    return bending.real, shear.real, mass, rotary
