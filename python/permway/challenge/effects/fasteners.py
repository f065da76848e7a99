"""Effects of fasteners and rail."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from permway.challenge.beams import Complexes, Reals
from permway.challenge.effects.base import Effect, Site, Strength, between, inside, interval, size
from permway.challenge.plan import Plan
from permway.challenge.track import Link, grounded

FASTENERS = {"joint": "pad", "x_m": None}


@dataclass(frozen=True)
class PadSpringpot(Effect):
    """Pads stiffen with a power of frequency."""

    KIND = "pad_springpot"
    ID = "pad_frequency"
    FAMILY = "pad law"
    ALTERNATIVES = ("pad_frequency", "layer_damping")
    FADES = (("order", 0.0),)

    order: float
    share: float
    reference_Hz: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Order by strength."""
        return cls(
            size(random, strength, 0.06, 0.13, 0.26), between(random, 0.5, 0.7), between(random, 40.0, 90.0)
        )

    def apply(self, plan: Plan) -> None:
        """Replace the pads' law, whose stiffness at the reference stays."""
        before = plan.track.springs["pad"]
        rest = 1.0 - self.share * np.cos(0.5 * np.pi * self.order)

        def law(f: Reals, t: float) -> Complexes:
            return np.asarray(before(f, t) * (rest + self.share * (1j * f / self.reference_Hz) ** self.order))

        plan.track.springs["pad"] = law

    @property
    def place(self) -> dict[str, Any]:
        """All fasteners."""
        return dict(FASTENERS)

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"pads: a springpot of order {self.order:g} beside a spring"


@dataclass(frozen=True)
class PadZener(Effect):
    """Pads relax at one frequency."""

    KIND = "pad_zener"
    ID = "pad_frequency"
    FAMILY = "pad law"
    ALTERNATIVES = ("pad_frequency", "layer_damping")
    FADES = (("rise", 0.0),)

    rise: float
    relaxation_Hz: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Rise of stiffness by strength."""
        return cls(size(random, strength, 0.15, 0.4, 1.0), between(random, 40.0, 140.0))

    def apply(self, plan: Plan) -> None:
        """Put a Maxwell branch beside the pads' spring; the real part at the relaxation stays."""
        before = plan.track.springs["pad"]

        def law(f: Reals, t: float) -> Complexes:
            branch = self.rise * 1j * f / (self.relaxation_Hz + 1j * f)
            return np.asarray(before(f, t) * (1.0 + branch) / (1.0 + 0.5 * self.rise))

        plan.track.springs["pad"] = law

    @property
    def place(self) -> dict[str, Any]:
        """All fasteners."""
        return dict(FASTENERS)

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"pads: a spring beside a spring and a dashpot in series, relaxing at {self.relaxation_Hz:g} Hz"


@dataclass(frozen=True)
class PadTemperature(Effect):
    """Pads stiffen and lose more in the cold."""

    KIND = "pad_temperature"
    ID = "pad_temperature"
    FAMILY = "pad temperature"
    TEMPERATURES = 2
    FADES = (("stiffer_per_30K", 1.0), ("lossier_per_30K", 1.0))

    stiffer_per_30K: float
    lossier_per_30K: float
    reference_C: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Factor for 30 K by strength."""
        stiffer = round(1.0 + size(random, strength, 0.12, 0.3, 0.9), 3)
        return cls(stiffer, round(1.0 + 0.5 * (stiffer - 1.0), 3), site.tests.temperatures_C[0])

    def apply(self, plan: Plan) -> None:
        """Scale storage and loss with temperature."""
        before = plan.track.springs["pad"]

        def law(f: Reals, t: float) -> Complexes:
            cold = (self.reference_C - t) / 30.0
            value = before(f, t)
            return np.asarray(
                self.stiffer_per_30K**cold * (value.real + 1j * value.imag * self.lossier_per_30K**cold)
            )

        plan.track.springs["pad"] = law

    @property
    def place(self) -> dict[str, Any]:
        """All fasteners."""
        return dict(FASTENERS)

    @property
    def mechanical(self) -> str:
        """In words."""
        stiffer, lossier = self.stiffer_per_30K, self.lossier_per_30K
        return f"pads: stiffness times {stiffer:g}, loss factor times {lossier:g} where it is 30 K colder"


@dataclass(frozen=True)
class FastenersLost(Effect):
    """Fasteners carry little or nothing over a stretch."""

    KIND = "lost"
    ID = "fastener_loss"
    FAMILY = "local loss of support"
    ALTERNATIVES = ("fastener_loss", "mortar_void")
    FADES = (("factor", 1.0),)

    stretch_m: tuple[float, float]
    factor: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """One, two or four fasteners by strength, and what is left of them."""
        bays, least, most = {"weak": (1, 0.4, 0.6), "medium": (2, 0.1, 0.3), "strong": (4, 0.02, 0.08)}[strength]
        return cls(interval(random, site, bays), between(random, least, most))

    def apply(self, plan: Plan) -> None:
        """Scale the pads there."""
        plan.track.scale("pad", lambda x: self.factor if inside(x, self.stretch_m) else 1.0)

    @property
    def place(self) -> dict[str, Any]:
        """The stretch."""
        return {"joint": "pad", "x_m": list(self.stretch_m)}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"fasteners between {self.stretch_m[0]:g} and {self.stretch_m[1]:g} m keep {self.factor:g} of k"


@dataclass(frozen=True)
class RailAbsorbers(Effect):
    """A tuned absorber on the rail at every fastener."""

    KIND = "rail_absorber"
    ID = "rail_absorber"
    FAMILY = "resonator"
    FADES = (("mass_kg", 0.0),)

    mass_kg: float
    tuned_Hz: float
    loss: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Mass by strength."""
        return cls(size(random, strength, 1.0, 3.0, 9.0), between(random, 90.0, 330.0), between(random, 0.06, 0.3))

    def apply(self, plan: Plan) -> None:
        """Hang one on at every station."""
        plan.track.laws["absorber"] = resonator(self.mass_kg, self.tuned_Hz, self.loss)
        stations = [*plan.layout.approaches, *plan.layout.deck]
        plan.track.links += [Link((("rail", x),), "absorber") for x in stations]

    @property
    def place(self) -> dict[str, Any]:
        """The whole rail."""
        return {"body": "rail", "x_m": None}

    @property
    def mechanical(self) -> str:
        """In words."""
        return (
            f"a resonator of {self.mass_kg:g} kg at {self.tuned_Hz:g} Hz, loss factor {self.loss:g}, "
            "on the rail at every fastener"
        )


def resonator(mass: float, tuned_Hz: float, loss: float) -> Any:
    """What a mass on a spring makes a point feel, (F, 1, 1)."""
    spring = mass * (2.0 * np.pi * tuned_Hz) ** 2 * (1.0 + 1j * loss)

    def law(f: Reals, _: float) -> Complexes:
        inertia = mass * (2.0 * np.pi * f) ** 2
        return np.asarray(-inertia * spring / (spring - inertia))

    return grounded(law)


@dataclass(frozen=True)
class BaseplateMass(Effect):
    """Fasteners have two stages with a mass between."""

    KIND = "baseplate_mass"
    ID = "baseplate_mass"
    FAMILY = "pad law"
    FADES = (("mass_kg", 0.0),)

    mass_kg: float
    lower_over_upper: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Mass by strength."""
        return cls(size(random, strength, 5.0, 12.0, 30.0), between(random, 0.4, 2.5))

    def _block(self, series: Complexes, f: Reals) -> Complexes:
        upper = series * (1.0 + 1.0 / self.lower_over_upper)
        lower = series * (1.0 + self.lower_over_upper)
        between_them = upper + lower - self.mass_kg * (2.0 * np.pi * f) ** 2
        block = np.empty((f.size, 2, 2), dtype=np.complex128)
        block[:, 0, 0] = upper - upper**2 / between_them
        block[:, 1, 1] = lower - lower**2 / between_them
        block[:, 0, 1] = block[:, 1, 0] = -upper * lower / between_them
        return block

    def apply(self, plan: Plan) -> None:
        """Split each pad in two, of the same static stiffness."""
        springs = plan.track.springs
        plan.track.laws["pad"] = lambda f, t: self._block(springs["pad"](f, t), f)
        plan.track.laws["approach"] = lambda f, t: self._block(springs["pad"](f, t), f)[:, :1, :1]

    @property
    def place(self) -> dict[str, Any]:
        """All fasteners."""
        return dict(FASTENERS)

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"a plate of {self.mass_kg:g} kg between two springs in every fastener"


@dataclass(frozen=True)
class SupportGradient(Effect):
    """Pads grow stiffer along the deck."""

    KIND = "support_gradient"
    ID = "support_gradient"
    FAMILY = "support along x"
    FADES = (("slope", 0.0),)

    slope: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Half the relative rise from end to end by strength, up or down."""
        return cls(size(random, strength, 0.1, 0.2, 0.45) * float(random.choice([-1.0, 1.0])))

    def apply(self, plan: Plan) -> None:
        """Scale each pad by its place."""
        length = plan.layout.length_m
        plan.track.scale("pad", lambda x: 1.0 + self.slope * (2.0 * x / length - 1.0))

    @property
    def place(self) -> dict[str, Any]:
        """The pads on the deck."""
        return {"joint": "pad", "x_m": None}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"pads on the deck go from {1.0 - self.slope:.2f} to {1.0 + self.slope:.2f} of their stiffness"
