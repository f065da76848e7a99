"""Effects of the finite elements' line: how each is drawn, and what it changes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from permway.challenge.beams import Complexes, Reals
from permway.challenge.effects.fasteners import resonator
from permway.challenge.small.concealed import Concealed, moved
from permway.challenge.small.draws import log_between
from permway.challenge.small.elements_line import AS, Line, hang, scaled, tie
from permway.challenge.small.layouts import Layout
from permway.challenge.track import Scalar, spring

Draw = Callable[[np.random.Generator, Layout, float], Concealed | None]
"""From random numbers, a layout and a place (m) to an effect; None if the layout has no such part."""

BED = {"ballast": "ballast", "slab": "mortar"}
GIRDER = {"deck": "deck", "slab": "girder", "beam": "beam"}
BEARING = {"deck": "bearing", "slab": "bearing", "beam": "support"}

Number = Callable[[float], dict[str, float]]


def _made(
    name: str | None,
    family: str,
    apply: Callable[[Line, Mapping[str, float]], None],
    at: Number,
    place: Mapping[str, Any],
    *,
    scales: bool = True,
    words: tuple[str, ...] = (),
    kind: str = "",
) -> Concealed:
    def change(line: Line, share: float) -> Line:
        apply(line, at(share))
        return line

    return Concealed(
        id=name,
        kind=f"elements: {kind or name}",
        family=family,
        domain="path",
        change=change,
        parameters=at,
        place=lambda _: place,
        scales=scales,
        words=words,
        mechanical=kind or str(name),
    )


def _sized(values: Mapping[str, float], size: str, none: float) -> Number:
    return lambda share: {**values, size: moved(values[size], none, share)}


def _loss(name: str, law_of: Callable[[Layout], str | None]) -> Draw:
    """One to five neighbouring joints of a layer keep part of their stiffness."""

    def draw(random: np.random.Generator, layout: Layout, place_m: float) -> Concealed | None:
        law = law_of(layout)
        if law is None:
            return None
        x = np.array(_stations(layout, law))
        count = int(random.integers(1, 6))
        near = int(np.argmin(np.abs(x - place_m)))
        first = int(np.clip(near - random.integers(count), 0, x.size - count))
        low, high = float(x[first]), float(x[first + count - 1])
        values = {"centre_m": 0.5 * (low + high), "length_m": high - low, "factor": log_between(random, 0.01, 0.3)}
        numbers = range(first, first + count)

        def apply(line: Line, at: Mapping[str, float]) -> None:
            scaled(line, law, lambda i, _: at["factor"] if i in numbers else 1.0)

        place = {"joint": law, "x_m": [low, high]}
        return _made(name, "local loss of support", apply, _sized(values, "factor", 1.0), place)

    return draw


def _pad(layout: Layout) -> str | None:
    return "pad" if layout.name in ("deck", "ballast", "slab") else None


def _bed(layout: Layout) -> str | None:
    return BED.get(layout.name)


def _stations(layout: Layout, law: str) -> list[float]:
    from permway.challenge.small.elements_line import line_of

    return line_of(layout.line).stations[law]


def _scatter(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    law = _pad(layout)
    if law is None:
        return None
    x = np.array(_stations(layout, law))
    waves = random.standard_normal(8) / np.arange(1, 9) ** 0.5
    shape = np.array([np.cos(np.pi * (k + 1) * (x - x[0]) / (x[-1] - x[0])) for k in range(8)])
    logs = waves @ shape
    logs -= logs.mean()
    logs *= 0.6 / np.std(logs)

    def apply(line: Line, at: Mapping[str, float]) -> None:
        scaled(line, law, lambda i, _: float(np.exp(at["share"] * logs[i])))

    at = _sized({"share": 1.0}, "share", 0.0)
    return _made("support_scatter", "uneven support", apply, at, {"joint": law, "x_m": [x[0], x[-1]]})


def _gradient(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    laws = [law for law in (_pad(layout), _bed(layout)) if law]
    if not laws:
        return None
    law = laws[int(random.integers(len(laws)))]
    x = _stations(layout, law)
    ratio = log_between(random, 2.5, 6.0)
    values = {"ratio": ratio if random.random() < 0.5 else 1.0 / ratio}

    def apply(line: Line, at: Mapping[str, float]) -> None:
        slope = (at["ratio"] - 1.0) / (at["ratio"] + 1.0)
        scaled(line, law, lambda _, v: 1.0 + slope * (2.0 * (v - x[0]) / (x[-1] - x[0]) - 1.0))

    place = {"joint": law, "x_m": [x[0], x[-1]]}
    return _made("support_gradient", "uneven support", apply, _sized(values, "ratio", 1.0), place)


def _rubber(name: str, law_of: Callable[[Layout], str | None], family: str) -> Draw:
    """A layer's stiffness rises with frequency: a springpot beside a spring, or a relaxing branch."""

    def draw(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
        law = law_of(layout)
        if law is None:
            return None
        if random.random() < 0.5:
            values = {"order": round(float(random.uniform(0.25, 0.5)), 3)}
            share, reference, size = float(random.uniform(0.4, 0.8)), log_between(random, 40.0, 90.0), "order"

            def factor(at: Mapping[str, float], f: Reals) -> Complexes:
                rest = 1.0 - share * np.cos(0.5 * np.pi * at["order"])
                return np.asarray(rest + share * (1j * f / reference) ** at["order"])
        else:
            values = {"rise": log_between(random, 0.6, 3.0), "relaxation_Hz": log_between(random, 30.0, 160.0)}
            size = "rise"

            def factor(at: Mapping[str, float], f: Reals) -> Complexes:
                branch = at["rise"] * 1j * f / (at["relaxation_Hz"] + 1j * f)
                return np.asarray((1.0 + branch) / (1.0 + 0.5 * at["rise"]))

        def apply(line: Line, at: Mapping[str, float]) -> None:
            before = line.springs[law]
            line.springs[law] = lambda f, t: before(f, t) * factor(at, f)

        return _made(name, family, apply, _sized(values, size, 0.0), {"joint": law})

    return draw


def _rubber_law(layout: Layout) -> str | None:
    return "pad" if layout.name != "beam" else None


def _viscous(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    laws = [law for law in layout.line["laws"] if law not in ("clamp", "sling")]
    if not laws:
        return None
    law = laws[int(random.integers(len(laws)))]
    values = {"share": 1.0, "equal_at_Hz": log_between(random, 20.0, 160.0)}

    def apply(line: Line, at: Mapping[str, float]) -> None:
        before = line.springs[law]

        def changed(f: Reals, t: float) -> Complexes:
            value = before(f, t)
            return np.asarray(
                value.real + 1j * value.imag * (1.0 - at["share"] + at["share"] * f / at["equal_at_Hz"])
            )

        line.springs[law] = changed

    return _made("layer_damping", "damping law", apply, _sized(values, "share", 0.0), {"joint": law})


def _absorber(random: np.random.Generator, layout: Layout, place_m: float) -> Concealed | None:
    if _pad(layout) is None:
        return None
    x = np.array(_stations(layout, "pad"))
    count = int(random.choice([1, 3, 6, x.size], p=[0.25, 0.25, 0.2, 0.3]))
    near = int(np.argmin(np.abs(x - place_m)))
    first = int(np.clip(near - count // 2, 0, x.size - count))
    places = [float(v) for v in x[first : first + count]]
    values = {"mass_kg": log_between(random, 8.0, 60.0), "loss_factor": log_between(random, 0.05, 0.4)}
    values |= {"frequency_Hz": log_between(random, 40.0, 0.8 * layout.top_Hz)}

    def apply(line: Line, at: Mapping[str, float]) -> None:
        law = _resonator(at["mass_kg"], at["frequency_Hz"], at["loss_factor"])
        hang(line, "rail", law, "absorber", places, [1.0] * count)

    place = {"body": "rail", "x_m": [places[0], places[-1]]}
    return _made("rail_absorber", "resonator", apply, _sized(values, "mass_kg", 0.0), place)


def _baseplate(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    if _pad(layout) is None:
        return None
    share = round(float(random.uniform(0.3, 0.7)), 3)
    values = {"mass_kg": log_between(random, 25.0, 100.0), "share": share}

    def apply(line: Line, at: Mapping[str, float]) -> None:
        assert line.track is not None

        def block(f: Reals, t: float) -> Complexes:
            series = line.springs["pad"](f, t)
            # The share is the part of the flexibility above the plate.
            upper, lower = series / at["share"], series / (1.0 - at["share"])
            middle = upper + lower - at["mass_kg"] * (2.0 * np.pi * f) ** 2
            found = np.empty((f.size, 2, 2), dtype=np.complex128)
            found[:, 0, 0], found[:, 1, 1] = upper - upper**2 / middle, lower - lower**2 / middle
            found[:, 0, 1] = found[:, 1, 0] = -upper * lower / middle
            return found

        line.track.laws["pad"] = block

    at = _sized(values, "mass_kg", 0.0)
    return _made("baseplate_mass", "two-stage fastener", apply, at, {"joint": "pad"})


def _attachment(random: np.random.Generator, layout: Layout, place_m: float) -> Concealed | None:
    body = GIRDER.get(layout.name)
    if body is None:
        return None
    x = round(float(np.clip(place_m, 0.1 * layout.length_m, 0.9 * layout.length_m)), 3)
    table = layout.line["bodies"][body]
    own = table["density_kg_per_m3"] * table["area_m2"] * layout.length_m
    values = {"x_m": x, "mass_kg": log_between(random, 0.05 * own, 0.5 * own)}
    values |= {"frequency_Hz": log_between(random, 12.0, 100.0), "loss_factor": log_between(random, 0.02, 0.15)}

    def apply(line: Line, at: Mapping[str, float]) -> None:
        law = _resonator(at["mass_kg"], at["frequency_Hz"], at["loss_factor"])
        hang(line, body, law, "attachment", [x], [1.0])

    at = _sized(values, "mass_kg", 0.0)
    return _made("deck_attachment", "resonator", apply, at, {"body": body, "x_m": [x, x]})


def _crack(random: np.random.Generator, layout: Layout, place_m: float) -> Concealed | None:
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

    at = _sized(values, "factor", 1.0)
    return _made("girder_crack", "girder", apply, at, {"body": body, "x_m": [low, high]})


def _one_bearing(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    law = BEARING.get(layout.name)
    if law is None or law not in layout.line["laws"]:
        return None
    x = _stations(layout, law)
    which = int(random.integers(len(x)))
    factor = log_between(random, 0.05, 0.3)
    values = {"factor": factor if random.random() < 0.7 else 1.0 / factor}

    def apply(line: Line, at: Mapping[str, float]) -> None:
        scaled(line, law, lambda i, _: at["factor"] if i == which else 1.0)

    place = {"joint": law, "x_m": [x[which], x[which]]}
    return _made("bearing_stiffness", "bearing and pier", apply, _sized(values, "factor", 1.0), place)


def _pier(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    if layout.name not in ("deck", "slab"):
        return None
    stiffness = layout.line["laws"]["bearing"]["stiffness"]
    values = {"compliance": log_between(random, 0.5, 4.0), "mass_kg": log_between(random, 2.0e4, 2.0e5)}
    values |= {"loss_factor": log_between(random, 0.05, 0.4)}

    def apply(line: Line, at: Mapping[str, float]) -> None:
        before = line.springs["bearing"]

        def changed(f: Reals, t: float) -> Complexes:
            soil = stiffness / at["compliance"] * (1.0 + 1j * at["loss_factor"])
            below = soil - at["mass_kg"] * (2.0 * np.pi * f) ** 2
            bearing = before(f, t)
            return np.asarray(bearing * below / (bearing + below))

        line.springs["bearing"] = changed

    # A stiff soil holds any pier: towards nothing the soil grows stiff.
    at = _sized(values, "compliance", 0.0)
    return _made("pier_soil", "bearing and pier", apply, at, {"joint": "bearing"})


def _local_modes(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
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
        law = _resonator(at["mass_share"] * mass, at["frequency_Hz"], at["loss_factor"])
        hang(line, body, law, "local", [round(float(x), 4) for x in places], list(shares))

    at = _sized(values, "mass_share", 0.0)
    return _made("girder_local_modes", "girder", apply, at, {"body": body})


def _joints(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    if layout.name != "slab":
        return None
    parts = int(random.integers(2, 5))
    x = np.array(_stations(layout, "pad"))
    cuts = []
    for k in range(1, parts):
        # Between two fasteners.
        i = int(np.searchsorted(x, layout.length_m * k / parts))
        cuts.append(round(0.5 * float(x[i - 1] + x[i]), 4))

    def apply(line: Line, _: Mapping[str, float]) -> None:
        assert line.track is not None
        line.track.cut("slab", cuts)

    place = {"body": "slab", "x_m": [cuts[0], cuts[-1]]}
    return _made("slab_joints", "slab", apply, lambda _: {}, place, scales=False)


def _warping(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    if layout.name != "slab":
        return None
    values = {"length_m": log_between(random, 1.5, 4.0), "factor": log_between(random, 0.01, 0.2)}

    def apply(line: Line, at: Mapping[str, float]) -> None:
        def factor(_: int, x: float) -> float:
            away = min(x, layout.length_m - x) / at["length_m"]
            return at["factor"] + (1.0 - at["factor"]) * min(away, 1.0)

        scaled(line, "mortar", factor)

    at = _sized(values, "factor", 1.0)
    return _made("slab_warping", "slab", apply, at, {"body": "slab"})


def _inerter(random: np.random.Generator, layout: Layout, place_m: float) -> Concealed | None:
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
    at = _sized(values, "inertance_kg", 0.0)
    return _made(None, "outside", apply, at, place, words=("inertance",), kind="inerter")


def _lean(random: np.random.Generator, layout: Layout, place_m: float) -> Concealed | None:
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
    return _made(None, "outside", apply, _sized(values, "stiffness", 0.0), place, words=words, kind=kind)


def _outside(random: np.random.Generator, layout: Layout, place_m: float) -> Concealed | None:
    draws = (_inerter, _lean)
    return draws[int(random.integers(len(draws)))](random, layout, place_m)


def _temperature(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    """Pads stiffen and lose more in the cold, about the warmer test."""
    law = _rubber_law(layout)
    if law is None:
        return None
    values = {"softening_per_K": round(float(random.uniform(0.01, 0.04)), 4), "loss_ratio": 0.5}

    def apply(line: Line, at: Mapping[str, float]) -> None:
        before = line.springs[law]

        def changed(f: Reals, t: float) -> Complexes:
            cold = at["softening_per_K"] * (15.0 - t)
            value = before(f, t)
            return np.asarray(np.exp(cold) * (value.real + 1j * value.imag * np.exp(at["loss_ratio"] * cold)))

        line.springs[law] = changed

    at = _sized(values, "softening_per_K", 0.0)
    return _made("pad_temperature", "pad law", apply, at, {"joint": law})


def _resonator(mass: float, frequency_Hz: float, loss: float) -> Scalar:
    """What a mass on a spring makes a point feel, N/m."""
    block = resonator(mass, frequency_Hz, loss)
    return lambda f, t: np.asarray(block(f, t)[:, 0, 0])


PATH: dict[str, Draw] = {
    "fastener_loss": _loss("fastener_loss", _pad),
    "mortar_void": _loss("mortar_void", _bed),
    "support_scatter": _scatter,
    "support_gradient": _gradient,
    "pad_frequency": _rubber("pad_frequency", _rubber_law, "pad law"),
    "ballast_frequency": _rubber("ballast_frequency", _bed, "bed law"),
    "pad_temperature": _temperature,
    "layer_damping": _viscous,
    "rail_absorber": _absorber,
    "baseplate_mass": _baseplate,
    "deck_attachment": _attachment,
    "girder_crack": _crack,
    "bearing_stiffness": _one_bearing,
    "pier_soil": _pier,
    "girder_local_modes": _local_modes,
    "slab_joints": _joints,
    "slab_warping": _warping,
}
"""By entry of the catalogue."""

OUTSIDE: Draw = _outside
