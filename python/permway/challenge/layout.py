"""What a measuring team would know of a line: layout, values with their tolerances, places, runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from permway.challenge.track import Location

Values = Mapping[str, Mapping[str, float]]

NOMINAL: Values = {
    "rail": {"E": 2.1e11, "I": 3.217e-5, "rho": 7850.0, "A": 7.745e-3, "G": 7.7e10, "kappa": 0.4, "eta": 0.01},
    "slab": {"E": 3.6e10, "I": 8.5e-4, "rho": 2500.0, "A": 0.255, "eta": 0.1},
    "base": {"E": 3.0e10, "I": 3.65625e-3, "rho": 2500.0, "A": 0.4875, "eta": 0.1},
    "girder": {"E": 3.6e10, "I": 5.528, "rho": 2650.0, "A": 4.5445, "eta": 0.1},
    "pad": {"k": 5.8e7, "eta": 0.12},
    "mortar": {"k": 3.79e11, "eta": 0.2},
    "sliding": {"k": 2.1e11, "eta": 0.2},
    "bearing": {"k": 6.0e9, "eta": 0.25},
    "vehicle": {
        "Mc": 42934.0,
        "Mt": 3300.0,
        "Mw": 1780.0,
        "Jc": 1.712e6,
        "Jt": 1807.0,
        "kp": 1.176e6,
        "cp": 1.0e4,
        "ks": 2.4e5,
        "cs": 2.0e4,
        "lc": 17.5,
        "lt": 2.5,
        "half": 0.5,
    },
}
"""One rail: sections, masses and stiffnesses halved; the vehicle's masses whole, its suspensions of one side."""

TOLERANCE: Values = {
    "pad": {"k": 0.25, "eta": 0.5},
    "mortar": {"k": 0.5, "eta": 0.5},
    "sliding": {"k": 0.5, "eta": 0.5},
    "bearing": {"k": 0.4, "eta": 0.5},
    "slab": {"E": 0.1, "eta": 0.5},
    "base": {"E": 0.1, "eta": 0.5},
    "girder": {"E": 0.12, "rho": 0.05, "eta": 0.5},
    "rail": {"eta": 0.5},
    "vehicle": {"kp": 0.15, "cp": 0.25, "ks": 0.15, "cs": 0.25, "Mc": 0.08},
}
"""Two standard deviations, relative."""

VARIED = {
    "slab": ("I", "A"),
    "base": ("I", "A"),
    "girder": ("I", "A"),
    "vehicle": ("Mc", "Mt", "Mw", "kp", "cp", "ks"),
}
"""Designers' values that differ from line to line by some percent, beside stiffnesses by some tens."""

GRID_M = 0.16
"""Wheelsets stand at whole multiples of this, halfway at the even one."""

WHEEL_RADIUS_M = 0.43

SPACINGS_M = (0.60, 0.61, 0.62, 0.63, 0.64, 0.65)


@dataclass(frozen=True)
class Layout:
    """Where everything is, m.

    Parameters
    ----------
    spans, bays : int
        Spans, and fastener bays on the whole deck: no multiple of the spans, so that piers lie between stations.
    spacing_m : float
        Between fasteners.
    approach_bays : int
        Bays with fasteners on rigid bed before and behind the deck.
    """

    spans: int = 1
    bays: int = 50
    spacing_m: float = 0.64
    approach_bays: int = 30

    @property
    def span_m(self) -> float:
        """Length of a span."""
        return round(self.length_m / self.spans, 6)

    @property
    def length_m(self) -> float:
        """Length of the deck."""
        return round(self.bays * self.spacing_m, 6)

    @property
    def approach_m(self) -> float:
        """Reach of the fasteners before and behind the deck."""
        return round(self.approach_bays * self.spacing_m, 6)

    def station(self, index: int) -> float:
        """A fastener's place, from 0 at the deck's beginning."""
        return round(index * self.spacing_m, 6)

    @property
    def deck(self) -> list[float]:
        """Stations on the deck."""
        return [self.station(i) for i in range(self.bays + 1)]

    @property
    def approaches(self) -> list[float]:
        """Stations before and behind it."""
        reach = range(1, self.approach_bays + 1)
        return [self.station(-i) for i in reversed(reach)] + [self.station(self.bays + i) for i in reach]

    def wheels_m(self, vehicle: Mapping[str, float]) -> list[float]:
        """Wheelsets 1 to 4, the leading one first."""
        bogie, wheel = 0.5 * vehicle["lc"], 0.5 * vehicle["lt"]
        away = np.array([bogie + wheel, bogie - wheel, wheel - bogie, -bogie - wheel])
        places = GRID_M * np.round(((0.5 * self.length_m + away) / GRID_M).round(9))
        return [round(float(x), 6) for x in places]


@dataclass(frozen=True)
class Tests:
    """Hammer tests and runs.

    Parameters
    ----------
    sensors, points : tuple of Location
    temperatures_C : tuple of float
        As written down, one hammer test each; trains run at the first.
    speeds_kmh : tuple of float
        As written down.
    """

    sensors: tuple[Location, ...]
    points: tuple[Location, ...]
    temperatures_C: tuple[float, ...] = (12.0,)
    speeds_kmh: tuple[float, ...] = (200.016, 299.988)
    lines_Hz: tuple[float, float, float] = (2.0, 400.0, 1.0)
    blows: int = 8
    sampling_Hz: float = 1024.0
    seconds: float = 64.0
    channels: tuple[str, ...] = field(
        default=("axlebox1", "axlebox2", "axlebox3", "axlebox4", "bogie1", "carbody")
    )


def draw_layout(random: np.random.Generator) -> Layout:
    """Mostly one span of about 32 m; of several, spans that end on a whole centimetre, between stations."""
    spans = int(random.choice([1, 2, 3], p=[0.8, 0.12, 0.08]))
    spacing = float(random.choice({1: SPACINGS_M, 2: SPACINGS_M[::2], 3: SPACINGS_M[::3]}[spans]))
    span = (32.0 if spans < 3 else 30.0) + float(random.uniform(-2.0, 2.0))
    bays = {1: 2, 2: 2, 3: 3}[spans] * round(spans * span / spacing / {1: 2, 2: 2, 3: 3}[spans])
    return Layout(spans, bays + (spans > 1), spacing, approach_bays=int(random.integers(28, 34)))


def draw_nominal(random: np.random.Generator) -> dict[str, dict[str, float]]:
    """Designers' values about the usual ones, rounded as designers round."""
    values = {group: dict(table) for group, table in NOMINAL.items()}
    for group, names in VARIED.items():
        for name in names:
            values[group][name] = _rounded(values[group][name] * float(random.uniform(0.96, 1.04)))
    for layer in ("pad", "mortar", "sliding", "bearing"):
        values[layer]["k"] = _rounded(values[layer]["k"] * float(np.exp(random.uniform(-0.2, 0.2))))
    return values


def draw_true(random: np.random.Generator, nominal: Values) -> dict[str, dict[str, float]]:
    """True values within the tolerances: normal, cut off at two standard deviations."""
    values = {group: dict(table) for group, table in nominal.items()}
    for group, table in TOLERANCE.items():
        for name, tolerance in table.items():
            off = float(random.standard_normal())
            while abs(off) > 2.0:
                off = float(random.standard_normal())
            values[group][name] *= 1.0 + 0.5 * tolerance * off
    return values


def draw_tests(random: np.random.Generator, layout: Layout, *, temperatures: int) -> Tests:
    """Sensors at and about the middle of a span, blows along the whole deck."""
    spacing = layout.spacing_m
    per_span = layout.bays // layout.spans
    middle = layout.station(per_span * (layout.spans // 2) + per_span // 2)
    within = round(middle + 0.5 * spacing, 2)

    def near(share: float) -> float:
        return layout.station(round(layout.bays * share) + int(random.integers(-2, 3)))

    quarter = layout.station(per_span // 4 + int(random.integers(-1, 2)))
    sensors: list[Location] = [("rail", within), ("rail", middle), ("rail", near(0.8)), ("slab", middle)]
    sensors += [("slab", near(0.77)), ("base", middle), ("girder", middle), ("girder", quarter), ("girder", 0.0)]
    stride = 2 * layout.spans
    start = int(random.integers(1, stride + 1))
    along = [layout.station(i) for i in range(start, layout.bays, stride)]
    points: list[Location] = [("rail", within), ("rail", middle)]
    points += [("rail", x) for x in along if abs(x - middle) > 1e-6]
    points.append(("girder", middle))
    first = float(random.integers(5, 25))
    warm = (first,) if temperatures == 1 else (first, first - float(random.integers(25, 38)))
    speeds = tuple(round(3.6 * float(random.uniform(*pair)), 3) for pair in ((53.0, 58.0), (80.0, 86.0)))
    return Tests(sensors=tuple(sensors), points=tuple(points), temperatures_C=warm, speeds_kmh=speeds)


def _rounded(value: float) -> float:
    return float(f"{value:.4g}")
