"""Effects of bodies of the finite elements' line, and what hangs on them; and mechanisms of no catalogue."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from permway.challenge.small.concealed import Concealed
from permway.challenge.small.draws import log_between
from permway.challenge.small.elements_line import AS, Line, hang, tie
from permway.challenge.small.elements_parts import (
    GIRDER,
    made,
    pad_of,
    resonator_of,
    sized,
    stations_of,
)
from permway.challenge.small.layouts import Layout
from permway.challenge.track import Scalar, spring


def absorber(random: np.random.Generator, layout: Layout, place_m: float) -> Concealed | None:
    """Masses on springs hang on the rail at one fastener, some, or all."""
    if pad_of(layout) is None:
        return None
    x = np.array(stations_of(layout, "pad"))
    count = int(random.choice([1, 3, 6, x.size], p=[0.25, 0.25, 0.2, 0.3]))
    near = int(np.argmin(np.abs(x - place_m)))
    first = int(np.clip(near - count // 2, 0, x.size - count))
    places = [float(v) for v in x[first : first + count]]
    values = {"mass_kg": log_between(random, 8.0, 60.0), "loss_factor": log_between(random, 0.05, 0.4)}
    values |= {"frequency_Hz": log_between(random, 40.0, 0.8 * layout.top_Hz)}

    def apply(line: Line, at: Mapping[str, float]) -> None:
        law = resonator_of(at["mass_kg"], at["frequency_Hz"], at["loss_factor"])
        hang(line, "rail", law, "absorber", places, [1.0] * count)

    place = {"body": "rail", "x_m": [places[0], places[-1]]}
    return made("rail_absorber", "resonator", apply, sized(values, "mass_kg", 0.0), place)


def attachment(random: np.random.Generator, layout: Layout, place_m: float) -> Concealed | None:
    """A mass on a spring stands on the girder."""
    body = GIRDER.get(layout.name)
    if body is None:
        return None
    x = round(float(np.clip(place_m, 0.1 * layout.length_m, 0.9 * layout.length_m)), 3)
    table = layout.line["bodies"][body]
    own = table["density_kg_per_m3"] * table["area_m2"] * layout.length_m
    values = {"x_m": x, "mass_kg": log_between(random, 0.05 * own, 0.5 * own)}
    values |= {"frequency_Hz": log_between(random, 12.0, 100.0), "loss_factor": log_between(random, 0.02, 0.15)}

    def apply(line: Line, at: Mapping[str, float]) -> None:
        law = resonator_of(at["mass_kg"], at["frequency_Hz"], at["loss_factor"])
        hang(line, body, law, "attachment", [x], [1.0])

    at = sized(values, "mass_kg", 0.0)
    return made("deck_attachment", "resonator", apply, at, {"body": body, "x_m": [x, x]})


def crack(random: np.random.Generator, layout: Layout, place_m: float) -> Concealed | None:
    """The girder keeps part of its bending stiffness over a short length."""
    body = GIRDER.get(layout.name)
    if body is None:
        return None
    length = round(layout.length_m * float(random.uniform(0.04, 0.2)), 3)
    middle = float(np.clip(place_m, 0.5 * length + 0.05, layout.length_m - 0.5 * length - 0.05))
    low, high = round(middle - 0.5 * length, 3), round(middle + 0.5 * length, 3)
    values = {"centre_m": 0.5 * (low + high), "length_m": high - low, "factor": log_between(random, 0.05, 0.4)}

    def apply(line: Line, at: Mapping[str, float]) -> None:
        assert line.track is not None
        line.track.stretch(AS[body], (low, high, at["factor"], 1.0))

    at = sized(values, "factor", 1.0)
    return made("girder_crack", "girder", apply, at, {"body": body, "x_m": [low, high]})


def beam_loss(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    """A share of a beam's loss is viscous: with one damping ratio in all modes, or as Rayleigh's by one term."""
    bodies = [name for name in (GIRDER.get(layout.name), "slab" if layout.name == "slab" else None) if name]
    if not bodies:
        return None
    body = bodies[int(random.integers(len(bodies)))]
    kind = str(random.choice(["ratio", "mass", "stiffness"], p=[0.5, 0.25, 0.25]))
    omega = 2.0 * np.pi * log_between(random, 8.0, 60.0)

    def apply(line: Line, at: Mapping[str, float]) -> None:
        assert line.track is not None
        beam = line.track.beams[AS[body]]
        section, given = beam.section, at["share"] * beam.section.loss
        turning = given * (section.bending * section.mass) ** 0.5
        terms = {
            "mass": (given * omega, 0.0, 0.0),
            "stiffness": (0.0, given / omega, 0.0),
            "ratio": (0.0, 0.0, turning),
        }
        rest = replace(section, loss=section.loss - given)
        line.track.beams[AS[body]] = replace(beam, section=rest, viscous=terms[kind])

    at = sized({"share": float(random.uniform(0.5, 1.0))}, "share", 0.0)
    return made("beam_damping", "damping law", apply, at, {"body": body})


def local_modes(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    """Parts of the girder move on springs all along it."""
    body = GIRDER.get(layout.name)
    if body is None:
        return None
    table = layout.line["bodies"][body]
    mass = table["density_kg_per_m3"] * table["area_m2"] * layout.length_m
    values = {"mass_share": log_between(random, 0.1, 0.8), "frequency_Hz": log_between(random, 20.0, 120.0)}
    values |= {"loss_factor": log_between(random, 0.03, 0.2)}
    places = np.linspace(0.0, layout.length_m, 25)
    shares = np.full(25, 1.0 / 24.0)
    shares[[0, -1]] *= 0.5

    def apply(line: Line, at: Mapping[str, float]) -> None:
        law = resonator_of(at["mass_share"] * mass, at["frequency_Hz"], at["loss_factor"])
        hang(line, body, law, "local", [round(float(x), 4) for x in places], list(shares))

    at = sized(values, "mass_share", 0.0)
    return made("girder_local_modes", "girder", apply, at, {"body": body})


def slab_joints(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    """The slab is cut through at equal distances, between fasteners."""
    if layout.name != "slab":
        return None
    parts = int(random.integers(2, 5))
    x = np.array(stations_of(layout, "pad"))
    cuts = []
    for k in range(1, parts):
        # Between two fasteners.
        i = int(np.searchsorted(x, layout.length_m * k / parts))
        cuts.append(round(0.5 * float(x[i - 1] + x[i]), 4))

    def apply(line: Line, _: Mapping[str, float]) -> None:
        assert line.track is not None
        line.track.cut("slab", cuts)

    place = {"body": "slab", "x_m": [cuts[0], cuts[-1]]}
    return made("slab_joints", "slab", apply, lambda _: {}, place, scales=False)


def _inerter(random: np.random.Generator, layout: Layout, place_m: float) -> Concealed | None:
    """A force in proportion to the relative acceleration of two bodies."""
    bodies = {"deck": ("rail", "deck"), "slab": ("slab", "girder")}.get(layout.name)
    if bodies is None:
        return None
    upper, lower = bodies
    x = round(float(np.clip(place_m, 0.0, layout.length_m)), 3)
    values = {"inertance_kg": log_between(random, 200.0, 3000.0)}

    def apply(line: Line, at: Mapping[str, float]) -> None:
        mass = at["inertance_kg"]
        law: Scalar = lambda f, _: np.asarray(-mass * (2.0 * np.pi * f) ** 2, dtype=np.complex128)  # noqa: E731
        tie(line, upper, lower, spring(law), "inerter", [x])

    place = {"joint": f"{upper} to {lower}", "x_m": [x, x]}
    at = sized(values, "inertance_kg", 0.0)
    return made(None, "outside", apply, at, place, words=("inertance",), kind="inerter")


def _lean(random: np.random.Generator, layout: Layout, place_m: float) -> Concealed | None:
    """A body leans on the ground by a springpot, or by a spring that pushes it away."""
    body = GIRDER.get(layout.name) or ("rail" if layout.name == "ballast" else None)
    if body is None:
        return None
    x = round(float(np.clip(place_m, 0.05 * layout.length_m, 0.95 * layout.length_m)), 3)
    negative = random.random() < 0.4
    size = log_between(random, 2.0e7, 6.0e8) * (-0.2 if negative else 1.0)
    order = 0.0 if negative else round(float(random.uniform(0.4, 0.9)), 2)
    values = {"stiffness": size}

    def apply(line: Line, at: Mapping[str, float]) -> None:
        law: Scalar = lambda f, _: np.asarray(at["stiffness"] * (1j * f / 20.0) ** order)  # noqa: E731
        hang(line, body, law, "lean", [x], [1.0])

    words = ("spring of -",) if negative else ("springpot",)
    kind = "negative spring" if negative else "springpot"
    place = {"joint": f"{body} to ground", "x_m": [x, x]}
    return made(None, "outside", apply, sized(values, "stiffness", 0.0), place, words=words, kind=kind)


def outside(random: np.random.Generator, layout: Layout, place_m: float) -> Concealed | None:
    """A mechanism of no catalogue."""
    draws = (_inerter, _lean)
    return draws[int(random.integers(len(draws)))](random, layout, place_m)
