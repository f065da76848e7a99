"""A small line as the challenge's own finite elements, or as a few masses: no code is shared with the solver."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from permway.challenge.assembly import lossy
from permway.challenge.beams import Complexes, Reals, Section
from permway.challenge.mesh import Mesh
from permway.challenge.track import Beam, Link, Location, Matrix, Scalar, Track, grounded, spring

STEP_M, PARTS = 0.15, 60
"""Longest element of a track, m: at 400 Hz a rail's wave has 15 of them, and cubic elements are right to 4e-5 of
its frequency; at half the length a campaign takes twice as long. Parts of a single beam, whose resonances are
sharper."""

STRIP_NM2 = 1.0
"""Bending stiffness of the massless strip whose nodes are sleepers, N m2: 1e-5 of what carries a sleeper."""

AS = {"rail": "rail", "slab": "slab", "sleeper": "slab", "deck": "girder", "girder": "girder", "beam": "girder"}
"""The mesh's name of each body."""

Transfer = Callable[[Reals], Complexes]


@dataclass
class Line:
    """A line that effects may change before it is solved.

    Attributes
    ----------
    track : Track or None
        None of a rig of masses alone.
    stations : dict of str to list of float
        Places of each law's joints, m.
    springs : dict of str to Scalar
        Complex stiffness of each law, N/m.
    masses : dict of str to float
        Of a rig, kg.
    attached : dict of str to list of Scalar
        What else holds a mass of a rig, N/m.
    chains : dict of str to Transfer
        Faults of sensors, by name.
    """

    track: Track | None
    stations: dict[str, list[float]]
    springs: dict[str, Scalar]
    joints: list[dict[str, Any]]
    masses: dict[str, float] = field(default_factory=dict)
    attached: dict[str, list[Scalar]] = field(default_factory=dict)
    chains: dict[str, Transfer] = field(default_factory=dict)

    def receptance(
        self, frequency_Hz: Reals, temperature_C: float, rows: Sequence[Location], columns: Sequence[Location]
    ) -> Complexes:
        """Deflection at rows per force at columns, m/N, shape (rows, columns, F)."""
        if self.track is None:
            return self._rig(frequency_Hz, temperature_C, rows, columns)
        one, other = ([_meshed(location) for location in locations] for locations in (rows, columns))
        mesh = Mesh(self.track, [*one, *other])
        return np.asarray(np.moveaxis(mesh.receptance(frequency_Hz, temperature_C, one, other), 0, -1))

    def _rig(
        self, frequency_Hz: Reals, temperature_C: float, rows: Sequence[Location], columns: Sequence[Location]
    ) -> Complexes:
        names = list(self.masses)
        matrix = np.zeros((frequency_Hz.size, len(names), len(names)), dtype=np.complex128)
        omega2 = (2.0 * np.pi * frequency_Hz) ** 2
        for i, name in enumerate(names):
            matrix[:, i, i] = -omega2 * self.masses[name]
            for law in self.attached.get(name, []):
                matrix[:, i, i] += law(frequency_Hz, temperature_C)
        for joint in self.joints:
            upper, lower = joint["between"]
            value = self.springs[joint["law"]](frequency_Hz, temperature_C)
            i = names.index(upper)
            matrix[:, i, i] += value
            if lower != "ground":
                j = names.index(lower)
                matrix[:, j, j] += value
                matrix[:, i, j] -= value
                matrix[:, j, i] -= value
        inverse = np.linalg.inv(matrix)
        r, c = ([names.index(body) for body, _ in locations] for locations in (rows, columns))
        return np.asarray(np.moveaxis(inverse[:, r][:, :, c], 0, -1))


def _meshed(location: Location) -> Location:
    return AS[location[0].split("[")[0]], location[1]


def line_of(table: dict[str, Any]) -> Line:
    """From the table `line` of a model file: beams of one interval, rows of masses, hysteretic laws."""
    bodies, joints = table["bodies"], table["joints"]
    springs: dict[str, Scalar] = {
        name: lossy(law["stiffness"], law["loss_factor"]) for name, law in table["laws"].items()
    }
    stations = {joint["law"]: _places(joint, bodies) for joint in joints}
    if not any(body["type"] == "beam" for body in bodies.values()):
        masses = {name: float(body["mass_kg"]) for name, body in bodies.items()}
        return Line(None, stations, springs, joints, masses)
    longest = max(b["intervals_m"][0][1] - b["intervals_m"][0][0] for b in bodies.values() if b["type"] == "beam")
    track = Track({}, STEP_M if len(bodies) > 1 else min(STEP_M, longest / PARTS))
    line = Line(track, stations, springs, joints)
    for name, body in bodies.items():
        if body["type"] == "beam":
            start, stop = body["intervals_m"][0]
            bending = body["youngs_modulus_Pa"] * body["second_moment_m4"]
            mass = body["density_kg_per_m3"] * body["area_m2"]
            track.beams[AS[name]] = Beam(Section(bending, mass, loss=body["loss_factor"]), start, stop)
        else:
            at = body["at"]
            track.beams[AS[name]] = Beam(Section(STRIP_NM2, 0.0), at[0], at[-1])
            track.laws[name] = grounded(_inertia(float(body["mass_kg"])))
            track.links += [Link(((AS[name], x),), name) for x in at]
    for joint in joints:
        upper, lower = joint["between"]
        law = joint["law"]
        # By name, so that an effect may put another spring in its place.
        track.laws[law] = (grounded if lower == "ground" else spring)(_named(line, law))
        locations = (upper,) if lower == "ground" else (upper, lower)
        track.links += [Link(tuple((AS[b], x) for b in locations), law) for x in stations[law]]
    return line


def _named(line: Line, law: str) -> Scalar:
    return lambda f, t: line.springs[law](f, t)


def _inertia(mass: float) -> Scalar:
    return lambda f, _: np.asarray(-mass * (2.0 * np.pi * f) ** 2, dtype=np.complex128)


def _places(joint: dict[str, Any], bodies: dict[str, Any]) -> list[float]:
    at = joint["at"]
    if isinstance(at, list):
        return [float(x) for x in at]
    body = bodies[at["of"]]
    return [float(x) for x in (body["at"] if body["type"] == "mass" else body["intervals_m"][0])]


def scaled(line: Line, law: str, factor: Callable[[int, float], complex]) -> None:
    """Multiply the joints of a law by a factor of their number and place."""
    assert line.track is not None
    for number, index in enumerate(line.track.stations(law)):
        link = line.track.links[index]
        line.track.links[index] = replace(link, scale=link.scale * factor(number, link.locations[0][1]))


def hang(line: Line, body: str, law: Scalar, name: str, places: Sequence[float], shares: Sequence[float]) -> None:
    """Put something between a body and the ground, or hang it on, at some places."""
    if line.track is None:
        line.attached.setdefault(body, []).append(law)
        return
    line.track.laws[name] = grounded(law)
    line.track.links += [
        Link(((AS[body], x),), name, float(share)) for x, share in zip(places, shares, strict=True)
    ]


def tie(line: Line, upper: str, lower: str, block: Matrix, name: str, places: Sequence[float]) -> None:
    """Tie two bodies at some places."""
    assert line.track is not None
    line.track.laws[name] = block
    line.track.links += [Link(((AS[upper], x), (AS[lower], x)), name) for x in places]
