"""Pads that are others under one condition than under another."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from permway.campaign.campaign import Campaign
from permway.campaign.factors import model_under
from permway.campaign.parts import Condition
from permway.diagnosis.catalogue._roles import rubbers
from permway.laws import AnyLaw, Parallel, Scaled
from permway.model.line import Line

Keys = tuple[str, ...]

STIFFNESS: dict[str, Keys] = {
    "hysteretic": ("stiffness",),
    "kelvin_voigt": ("stiffness", "damping"),
    "fractional_kelvin_voigt": ("stiffness", "coefficient"),
    "springpot": ("coefficient",),
    "maxwell": ("stiffness", "damping"),
    "scaled": ("factor",),
}
"""Numbers of a law that all scale with its stiffness."""

LOSS: dict[str, Keys] = {
    "hysteretic": ("loss_factor",),
    "kelvin_voigt": ("damping",),
    "fractional_kelvin_voigt": ("coefficient",),
    "springpot": ("coefficient",),
    "maxwell": ("stiffness", "damping"),
}
"""Numbers that scale its loss, the stiffness at rest as it is."""

REFERENCE_HZ = 60.0


def keys_of(law: AnyLaw, of: Mapping[str, Keys]) -> Keys:
    """Paths from a law to such numbers; none if it has none, or a part of it has none."""
    if isinstance(law, Parallel):
        parts = {"first": keys_of(law.first, of), "second": keys_of(law.second, of)}
        if not all(parts.values()):
            return ()
        return tuple(f"{part}.{key}" for part, keys in parts.items() for key in keys)
    if isinstance(law, Scaled) and law.type not in of:
        inner = keys_of(law.law, of)
        return (*(f"law.{key}" for key in inner), "loss_factor") if inner else ()
    return of.get(law.type, ())


def pad_laws(line: Line) -> list[str]:
    """Laws of pads, or of a rig's rubber, of which the numbers can be scaled."""
    return [name for name in rubbers(line) if keys_of(line.laws[name], STIFFNESS)]


def loss_factor(line: Line, law: str) -> float:
    """Of a law that does not depend on temperature, at 60 Hz."""
    return float(line.laws[law].loss_factor(np.array([REFERENCE_HZ]))[0])


def factors(line: Line, law: str, stiffness: float, loss: float = 1.0) -> dict[str, float]:
    """Factors by path that multiply a law's stiffness, and its loss over its stiffness."""
    found = {f"line.laws.{law}.{key}": stiffness for key in keys_of(line.laws[law], STIFFNESS)}
    for key in keys_of(line.laws[law], LOSS):
        path = f"line.laws.{law}.{key}"
        found[path] = found.get(path, 1.0) * loss
    return found


def scaled(campaign: Campaign, laws: Iterable[str], stiffness: float) -> Campaign:
    """The campaign with the laws' stiffness multiplied under all conditions."""
    if stiffness == 1.0:
        return campaign
    line = campaign.model.line
    every = tuple(item for law in laws for item in factors(line, law, stiffness).items())
    return campaign.with_model(model_under(campaign.model, every))


def measured_under(campaign: Campaign) -> list[Condition]:
    """Conditions that some record of line or train was taken under."""
    used = {record.condition for record in campaign.stated.records}
    return [c for c in campaign.stated.conditions if c.name in used and c.kind != "table"]


def with_factors(campaign: Campaign, by_condition: Mapping[str, Mapping[str, float]]) -> Campaign:
    """The campaign with further factors under some conditions, by their names."""
    changed = []
    for condition in campaign.stated.conditions:
        new = by_condition.get(condition.name, {})
        merged = {**condition.factors, **{p: condition.factors.get(p, 1.0) * f for p, f in new.items()}}
        changed.append(condition.model_copy(update={"factors": merged}) if new else condition)
    stated = campaign.stated.model_copy(update={"conditions": tuple(changed)})
    return replace(campaign, stated=stated)
