"""Layouts of small campaigns, as tables of a model file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from permway.challenge.small.draws import log_between, rounded

IRREGULAR, JITTER_M = 0.3, 0.05
"""Share of tracks whose supports stand irregularly, and the standard deviation of each place, m: real fasteners
are within some centimetres. At half of it they are nearly regular; at twice as much bays differ by a third."""

CLAMP_N_PER_M = 2.0e9
"""Stiffness of each of the two joints that clamp a beam, 0.15 m apart: a file has no clamped end, and at ten times
as much the solution loses digits, at a tenth the clamp turns visibly."""

RUNS_ON = ("deck", "ballast", "slab")
"""Layouts that have a rail, on which a vehicle may run."""


@dataclass(frozen=True)
class Layout:
    """A line as its file has it.

    Attributes
    ----------
    name : str
        "deck", "ballast", "slab", "beam" or "rig".
    variant : str
        What states forms of one layout apart.
    line : dict
        The table `line` of a model file.
    locations : mapping of str to tuple of (low, high)
        Bodies that can be struck or read, and the interval where, m; of a point mass both are its place.
    spacing_m : float
        Of the supports; 0 without rows of supports.
    length_m : float
    top_Hz : float
        Highest line of hammer tests.
    """

    name: str
    variant: str
    line: dict[str, Any]
    locations: dict[str, tuple[float, float]]
    spacing_m: float
    length_m: float
    top_Hz: float

    @property
    def near_m(self) -> float:
        """How far from a true place a stated one may lie: 1.5 m or an eighth of the line, at least a spacing."""
        return round(max(self.spacing_m, min(1.5, self.length_m / 8.0)), 4)


def draw_layout(random: np.random.Generator) -> Layout:
    """One of five, with values about the usual ones."""
    names = list(_DRAWN)
    return _DRAWN[names[int(random.choice(len(names), p=SHARES))]](random)


def _beam(modulus: float, inertia: float, density: float, area: float, loss: float, *at: float) -> dict[str, Any]:
    return {
        "type": "beam",
        "youngs_modulus_Pa": modulus,
        "second_moment_m4": inertia,
        "density_kg_per_m3": density,
        "area_m2": area,
        "loss_factor": loss,
        "intervals_m": [list(at)],
    }


def _law(random: np.random.Generator, low: float, high: float, loss: tuple[float, float]) -> dict[str, Any]:
    return {
        "type": "hysteretic",
        "stiffness": log_between(random, low, high),
        "loss_factor": log_between(random, *loss),
    }


def _stations(random: np.random.Generator, bays: int, spacing: float) -> list[float]:
    """Bays + 1 places from 0 on; the first and the last stay where they are."""
    x = spacing * np.arange(bays + 1)
    if random.random() < IRREGULAR:
        x[1:-1] += np.clip(JITTER_M * random.standard_normal(bays - 1), -0.15, 0.15)
    return [round(float(v), 3) for v in x]


def _rail(start: float, stop: float) -> dict[str, Any]:
    return _beam(2.1e11, 3.0e-5, 7850.0, 7.7e-3, 0.02, start, stop)


def _track(random: np.random.Generator) -> tuple[list[float], float, float]:
    """Stations, their spacing and the length of a short track."""
    spacing = float(random.choice([0.6, 0.63, 0.65, 0.7]))
    x = _stations(random, int(random.integers(14, 27)), spacing)
    return x, spacing, x[-1]


def _deck(random: np.random.Generator) -> Layout:
    """A rail on a deck on bearings, as a short bridge."""
    x, spacing, length = _track(random)
    line = {
        "bodies": {
            "rail": _rail(-1.2, round(length + 1.2, 3)),
            "deck": _beam(3.4e10, log_between(random, 0.08, 0.2), 2500.0, 1.5, 0.05, 0.0, length),
        },
        "laws": {
            "pad": _law(random, 2.0e7, 1.2e8, (0.1, 0.25)),
            "bearing": _law(random, 4.0e8, 2.0e9, (0.1, 0.25)),
        },
        "joints": [
            {"between": ["rail", "deck"], "law": "pad", "at": x},
            {"between": ["deck", "ground"], "law": "bearing", "at": {"of": "deck"}},
        ],
    }
    locations = {"rail": (0.0, length), "deck": (0.0, length)}
    return Layout("deck", "", line, locations, spacing, length, float(random.choice([200.0, 260.0])))


def _ballast(random: np.random.Generator) -> Layout:
    """A ballasted track: sleepers as masses."""
    x, spacing, length = _track(random)
    sleepers = {"type": "mass", "mass_kg": rounded(float(random.uniform(110.0, 170.0))), "at": x}
    rows = {"of": "sleeper"}
    line = {
        "bodies": {"rail": _rail(-0.6, round(length + 0.6, 3)), "sleeper": sleepers},
        "laws": {
            "pad": _law(random, 4.0e7, 3.0e8, (0.1, 0.25)),
            "ballast": _law(random, 1.2e7, 6.0e7, (0.2, 0.6)),
        },
        "joints": [
            {"between": ["rail", "sleeper"], "law": "pad", "at": rows},
            {"between": ["sleeper", "ground"], "law": "ballast", "at": rows},
        ],
    }
    locations = {"rail": (0.0, length)}
    locations |= {f"sleeper[{i + 1}]": (v, v) for i, v in enumerate(x) if 0 < i < len(x) - 1}
    return Layout("ballast", "", line, locations, spacing, length, float(random.choice([260.0, 400.0])))


def _slab(random: np.random.Generator) -> Layout:
    """One span of slab track: rail, slab and girder on bearings."""
    x, spacing, length = _track(random)
    line = {
        "bodies": {
            "rail": _rail(-1.2, round(length + 1.2, 3)),
            "slab": _beam(3.4e10, 8.5e-4, 2500.0, 0.255, 0.05, 0.0, length),
            "girder": _beam(3.5e10, log_between(random, 0.15, 0.5), 2500.0, 2.0, 0.04, 0.0, length),
        },
        "laws": {
            "pad": _law(random, 3.0e7, 1.0e8, (0.1, 0.25)),
            "mortar": _law(random, 1.0e8, 1.0e9, (0.08, 0.2)),
            "bearing": _law(random, 6.0e8, 2.0e9, (0.1, 0.25)),
        },
        "joints": [
            {"between": ["rail", "slab"], "law": "pad", "at": x},
            {"between": ["slab", "girder"], "law": "mortar", "at": x},
            {"between": ["girder", "ground"], "law": "bearing", "at": {"of": "girder"}},
        ],
    }
    locations = dict.fromkeys(("rail", "slab", "girder"), (0.0, length))
    return Layout("slab", "", line, locations, spacing, length, float(random.choice([200.0, 260.0])))


def _single(random: np.random.Generator) -> Layout:
    """A beam that is clamped at one end or both, on soft slings as a free one, or on two supports."""
    variant = str(random.choice(["clamped", "clamped both", "free", "supported"]))
    length = round(float(random.uniform(3.0, 10.0)), 2)
    depth = length * float(random.uniform(0.02, 0.04))
    area = rounded(0.3 * depth)
    body = _beam(2.1e11, rounded(0.3 * depth**3 / 12.0), 7850.0, area, 0.01, 0.0, length)
    near = (0.0, 0.15) if length > 4.0 else (0.0, 0.1)
    far = tuple(round(length - v, 3) for v in near[::-1])
    law, at = "clamp", list(near)
    table: dict[str, Any] = {"type": "hysteretic", "stiffness": CLAMP_N_PER_M, "loss_factor": 0.02}
    if variant == "clamped both":
        at = [*near, *far]
    elif variant == "free":
        law, at = "sling", [round(0.22 * length, 2), round(0.78 * length, 2)]
        weight = 7850.0 * area * length
        table = {"type": "hysteretic", "stiffness": rounded(0.5 * weight * (2 * np.pi * 3.0) ** 2)}
        table["loss_factor"] = 0.1
    elif variant == "supported":
        law, at = "support", [round(float(random.uniform(0.0, 0.1)) * length, 2), length]
        table = _law(random, 1.0e7, 1.0e8, (0.05, 0.2))
    line = {
        "bodies": {"beam": body},
        "laws": {law: table},
        "joints": [{"between": ["beam", "ground"], "law": law, "at": at}],
    }
    return Layout("beam", variant, line, {"beam": (0.0, length)}, 0.0, length, 300.0)


def _rig(random: np.random.Generator) -> Layout:
    """A mass on a pad, or on a pad, a second mass and a bed."""
    stages = int(random.integers(1, 3))
    bodies: dict[str, Any] = {"block": {"type": "mass", "mass_kg": log_between(random, 40.0, 400.0)}}
    laws = {"pad": _law(random, 2.0e6, 6.0e7, (0.08, 0.3))}
    joints = [{"between": ["block", "ground"], "law": "pad", "at": [0.0]}]
    locations = {"block": (0.0, 0.0)}
    if stages == 2:
        bodies["frame"] = {"type": "mass", "mass_kg": log_between(random, 100.0, 1500.0)}
        laws["bed"] = _law(random, 2.0e6, 6.0e7, (0.08, 0.3))
        joints[0] = {"between": ["block", "frame"], "law": "pad", "at": [0.0]}
        joints.append({"between": ["frame", "ground"], "law": "bed", "at": [0.0]})
        locations["frame"] = (0.0, 0.0)
    line = {"bodies": bodies, "laws": laws, "joints": joints}
    return Layout("rig", f"{stages}", line, locations, 0.0, 0.0, 300.0)


_DRAWN: dict[str, Callable[[np.random.Generator], Layout]] = {
    "deck": _deck,
    "ballast": _ballast,
    "slab": _slab,
    "beam": _single,
    "rig": _rig,
}

SHARES = (0.3, 0.25, 0.25, 0.14, 0.06)
"""Of the layouts, in this order: few kinds of effect are possible on a beam, and fewer on a rig."""
