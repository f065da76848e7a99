"""A hypothesis: one named change of a campaign's model at one place, with parameters and priors."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Literal, Protocol

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.fit import Build, Fit, Free
from permway.diagnosis.location import Location

Domain = Literal["path", "irregularity", "vehicle", "measurement"]
Amend = Callable[[Campaign, Mapping[str, float]], Campaign]
"""From a campaign, its own parameters set, and the effect's values to the amended campaign."""


@dataclass(frozen=True)
class Situation:
    """What hypotheses are made from.

    Attributes
    ----------
    fit : Fit
        The recalibrated base.
    locations : sequence of Location
        Places to look at, those that matter most first; may be empty.
    asked : list of str
        Laws and bodies whose places were asked for: without any, other places make no difference.
    """

    fit: Fit
    locations: tuple[Location, ...]
    asked: list[str] = field(default_factory=list, compare=False)

    @property
    def campaign(self) -> Campaign:
        """The base, recalibrated."""
        return self.fit.campaign

    def joints(self, law: str, most: int = 3) -> list[Location]:
        """The first joints of a law."""
        self.asked.append(law)
        mine = [at for at in self.locations if at.kind == "joint" and at.name == law]
        return mine[:most]

    def bodies(self, body: str, most: int = 3) -> list[Location]:
        """The first places of a body."""
        self.asked.append(body)
        mine = [at for at in self.locations if at.kind == "body" and at.name.split("[")[0] == body]
        return mine[:most]


@dataclass(frozen=True)
class Where:
    """The place of an effect.

    Attributes
    ----------
    what : str
        Body, or law of a joint, or "" for none in particular.
    x_m : (float, float), optional
    channels : tuple of str
        Of a fault in the measurement, or of one wheelset.
    """

    what: str = ""
    x_m: tuple[float, float] | None = None
    channels: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """For people."""
        parts = [self.what] if self.what else []
        if self.x_m is not None:
            low, high = self.x_m
            parts.append(f"at {low:.3g} m" if low == high else f"from {low:.4g} to {high:.4g} m")
        parts.extend(self.channels)
        return " ".join(parts)


@dataclass(frozen=True)
class Hypothesis:
    """A change of the model that may be the missing physics.

    Attributes
    ----------
    entry : str
        Identifier in the catalogue.
    domain : "path", "irregularity", "vehicle" or "measurement"
    family : str
        Effects that are near-degenerate share one.
    free : tuple of Free
        The effect's parameters, each a priori normal with unit variance in its coordinate z.
    amend : callable
    locate : callable
        From values to the place.
    starts : tuple of tuple of float
        Coordinates z to begin at.
    law : callable
        From values to the mechanics, in words.
    size : str
        The parameter that says how strong the effect is; "" if none does.
    none : float
        The value of `size` at which there is no effect.
    power : float
        Of its size, that a small effect changes records by: 2 for an amplitude that adds to a spectral density.
    variant : str
        What distinguishes forms of the effect that have the same parameters.
    moves : str
        Nominal parameter that the first of its own moves, in standard deviations of that one's prior; "" for none.
    """

    entry: str
    domain: Domain
    family: str
    free: tuple[Free, ...]
    amend: Amend
    locate: Callable[[Mapping[str, float]], Where]
    starts: tuple[tuple[float, ...], ...]
    law: Callable[[Mapping[str, float]], str] = field(default=lambda _: "")
    size: str = ""
    none: float = 0.0
    power: float = 1.0
    variant: str = ""
    moves: str = ""

    @property
    def form(self) -> tuple[str, ...]:
        """Effect and names of parameters: joints that are cut and joints that bend are two forms of one effect."""
        return self.entry, self.family, self.variant, *(f.name for f in self.free)

    def stacked_on(
        self, build: Build, prefix: str, campaign: Campaign | None = None
    ) -> tuple[Build, tuple[Free, ...]]:
        """A base with the effect on top: from values to the campaign, and the effect's parameters, renamed.

        Parameters
        ----------
        build : callable
            The base's.
        prefix : str
            Before the names of the effect's parameters, as "1.": two effects may be of one kind.
        campaign : Campaign, optional
            Whose nominal parameters the hypothesis may move.
        """
        names = {prefix + f.name: f.name for f in self.free}
        # Slopes by the effect's own parameters are all of one base.
        last: list[tuple[dict[str, float], Campaign]] = []

        def made(values: Mapping[str, float]) -> Campaign:
            nominal = {k: v for k, v in values.items() if k not in names}
            if self.moves and campaign is not None:
                known = campaign.parameters.known[self.moves]
                shift = values[prefix + self.free[0].name]
                nominal[self.moves] = known.value(known.z(nominal[self.moves]) + shift)
            if not last or last[0][0] != nominal:
                last[:] = [(nominal, build(nominal))]
            return self.amend(last[0][1], {names[k]: v for k, v in values.items() if k in names})

        return made, tuple(Free(prefix + f.name, f.unit, f.value, f.limits) for f in self.free)


class Entry(Protocol):
    """An effect of the catalogue: a module with these names.

    `ID`, `DOMAIN`, `FAMILY`; `SUMMARY` (one sentence: the law or change), `PARAMETERS` (name to unit, range and
    meaning), `SIGNATURE` (channels, bands, how it scales), `CONFUSED_WITH` (identifier to what separates them),
    `SOURCE`.
    """

    ID: str
    DOMAIN: Domain
    FAMILY: str
    SUMMARY: str
    PARAMETERS: Mapping[str, str]
    SIGNATURE: str
    CONFUSED_WITH: Mapping[str, str]
    SOURCE: str

    def hypotheses(self, situation: Situation) -> Iterable[Hypothesis]:
        """What of this kind may be in the situation at hand; none if the model has no such part."""


def log_free(name: str, unit: str, centre: float, factor: float, *, lowest: float = 0.0) -> Free:
    """A positive number known to a factor: one standard deviation is a multiplication by it."""
    spread = float(np.log(factor))
    low = max(-5.0, float(np.log(lowest / centre)) / spread) if lowest > 0.0 else -5.0
    return Free(name, unit, lambda z: centre * float(np.exp(spread * z)), (low, 5.0))


def linear_free(name: str, unit: str, centre: float, sigma: float, low: float, high: float) -> Free:
    """A number between two bounds, known to a standard deviation."""
    return Free(name, unit, lambda z: centre + sigma * z, ((low - centre) / sigma, (high - centre) / sigma))


def between_free(name: str, unit: str, low: float, high: float) -> Free:
    """A number evenly likely between two bounds: by the normal distribution function."""
    from scipy.special import ndtr

    return Free(name, unit, lambda z: low + (high - low) * float(ndtr(z)), (-4.0, 4.0))
