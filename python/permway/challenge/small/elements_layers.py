"""Effects of the layers of the finite elements' line: pads, beds, bearings."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from permway.challenge.beams import Complexes, Reals
from permway.challenge.small.concealed import Concealed
from permway.challenge.small.draws import log_between
from permway.challenge.small.elements_line import Line, scaled
from permway.challenge.small.elements_parts import (
    BEARING,
    Draw,
    bed_of,
    made,
    pad_of,
    rubber_of,
    sized,
    stations_of,
)
from permway.challenge.small.layouts import Layout


def loss(name: str, law_of: Callable[[Layout], str | None]) -> Draw:
    """One to five neighbouring joints of a layer keep part of their stiffness."""

    def draw(random: np.random.Generator, layout: Layout, place_m: float) -> Concealed | None:
        law = law_of(layout)
        if law is None:
            return None
        x = np.array(stations_of(layout, law))
        count = int(random.integers(1, 6))
        near = int(np.argmin(np.abs(x - place_m)))
        first = int(np.clip(near - random.integers(count), 0, x.size - count))
        low, high = float(x[first]), float(x[first + count - 1])
        values = {"centre_m": 0.5 * (low + high), "length_m": high - low, "factor": log_between(random, 0.01, 0.3)}
        numbers = range(first, first + count)

        def apply(line: Line, at: Mapping[str, float]) -> None:
            scaled(line, law, lambda i, _: at["factor"] if i in numbers else 1.0)

        place = {"joint": law, "x_m": [low, high]}
        return made(name, "local loss of support", apply, sized(values, "factor", 1.0), place)

    return draw


def scatter(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    """Every support differs, smoothly along the line and with a mean of one."""
    law = pad_of(layout)
    if law is None:
        return None
    x = np.array(stations_of(layout, law))
    waves = random.standard_normal(8) / np.arange(1, 9) ** 0.5
    shape = np.array([np.cos(np.pi * (k + 1) * (x - x[0]) / (x[-1] - x[0])) for k in range(8)])
    logs = waves @ shape
    logs -= logs.mean()
    logs *= 0.6 / np.std(logs)

    def apply(line: Line, at: Mapping[str, float]) -> None:
        scaled(line, law, lambda i, _: float(np.exp(at["share"] * logs[i])))

    at = sized({"share": 1.0}, "share", 0.0)
    return made("support_scatter", "uneven support", apply, at, {"joint": law, "x_m": [x[0], x[-1]]})


def gradient(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    """A layer stiffens from end to end, its mean unchanged."""
    laws = [law for law in (pad_of(layout), bed_of(layout)) if law]
    if not laws:
        return None
    law = laws[int(random.integers(len(laws)))]
    x = stations_of(layout, law)
    ratio = log_between(random, 2.5, 6.0)
    values = {"ratio": ratio if random.random() < 0.5 else 1.0 / ratio}

    def apply(line: Line, at: Mapping[str, float]) -> None:
        slope = (at["ratio"] - 1.0) / (at["ratio"] + 1.0)
        scaled(line, law, lambda _, v: 1.0 + slope * (2.0 * (v - x[0]) / (x[-1] - x[0]) - 1.0))

    place = {"joint": law, "x_m": [x[0], x[-1]]}
    return made("support_gradient", "uneven support", apply, sized(values, "ratio", 1.0), place)


def rubber(name: str, law_of: Callable[[Layout], str | None], family: str) -> Draw:
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

        return made(name, family, apply, sized(values, size, 0.0), {"joint": law})

    return draw


def viscous(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    """A layer loses in proportion to frequency instead of constantly."""
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

    return made("layer_damping", "damping law", apply, sized(values, "share", 0.0), {"joint": law})


def temperature(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    """Pads stiffen and lose more in the cold, about the warmer test."""
    law = rubber_of(layout)
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

    at = sized(values, "softening_per_K", 0.0)
    return made("pad_temperature", "pad law", apply, at, {"joint": law})


def warping(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    """The mortar carries less towards the slab's ends."""
    if layout.name != "slab":
        return None
    values = {"length_m": log_between(random, 1.5, 4.0), "factor": log_between(random, 0.01, 0.2)}

    def apply(line: Line, at: Mapping[str, float]) -> None:
        def factor(_: int, x: float) -> float:
            away = min(x, layout.length_m - x) / at["length_m"]
            return at["factor"] + (1.0 - at["factor"]) * min(away, 1.0)

        scaled(line, "mortar", factor)

    at = sized(values, "factor", 1.0)
    return made("slab_warping", "slab", apply, at, {"body": "slab"})


def baseplate(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    """Fasteners have a plate between two springs; the static stiffness stays."""
    if pad_of(layout) is None:
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

    at = sized(values, "mass_kg", 0.0)
    return made("baseplate_mass", "two-stage fastener", apply, at, {"joint": "pad"})


def one_bearing(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    """One bearing is softer or stiffer than the others."""
    law = BEARING.get(layout.name)
    if law is None or law not in layout.line["laws"]:
        return None
    x = stations_of(layout, law)
    which = int(random.integers(len(x)))
    factor = log_between(random, 0.05, 0.3)
    values = {"factor": factor if random.random() < 0.7 else 1.0 / factor}

    def apply(line: Line, at: Mapping[str, float]) -> None:
        scaled(line, law, lambda i, _: at["factor"] if i == which else 1.0)

    place = {"joint": law, "x_m": [x[which], x[which]]}
    return made("bearing_stiffness", "bearing and pier", apply, sized(values, "factor", 1.0), place)


def pier(random: np.random.Generator, layout: Layout, _: float) -> Concealed | None:
    """Bearings stand on a mass on soil."""
    if layout.name not in ("deck", "slab"):
        return None
    stiffness = layout.line["laws"]["bearing"]["stiffness"]
    values = {"compliance": log_between(random, 0.5, 4.0)}
    mass_kg = log_between(random, 2.0e4, 2.0e5)
    values["frequency_Hz"] = float(np.sqrt(stiffness / (values["compliance"] * mass_kg)) / (2.0 * np.pi))
    values |= {"loss_factor": log_between(random, 0.05, 0.4)}

    def apply(line: Line, at: Mapping[str, float]) -> None:
        before = line.springs["bearing"]

        def changed(f: Reals, t: float) -> Complexes:
            soil = stiffness / at["compliance"] * (1.0 + 1j * at["loss_factor"])
            below = soil - stiffness / at["compliance"] * (f / at["frequency_Hz"]) ** 2
            bearing = before(f, t)
            return np.asarray(bearing * below / (bearing + below))

        line.springs["bearing"] = changed

    # A stiff soil holds any pier: towards nothing the soil grows stiff.
    at = sized(values, "compliance", 0.0)
    return made("pier_soil", "bearing and pier", apply, at, {"joint": "bearing"})
