"""Changes of a model that several effects share: laws, joints, bodies, sensors."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.errors import InputError
from permway.laws import AnyLaw, Hysteretic, KelvinVoigt, Measured, Parallel, Series, StorageLossPair
from permway.laws.base import Law
from permway.model.changes import Change
from permway.model.joints import Joints
from permway.model.line import Line
from permway.recordings.channel import Chain
from permway.records import type_name

REACH_M = 1e-6
"""Half the length of a change that holds one joint."""

EVERYWHERE_HZ = (1e-6, 1e9)
"""Frequencies of a table that is constant."""


def with_line(campaign: Campaign, **parts: Any) -> Campaign:
    """The campaign with other `bodies`, `joints` or `laws` of its line, checked again."""
    model = campaign.model
    line = Line(**{"bodies": model.line.bodies, "joints": model.line.joints, "laws": model.line.laws, **parts})
    return campaign.with_model(model.model_copy(update={"line": line}))


def with_law(campaign: Campaign, name: str, law: Law) -> Campaign:
    """The campaign with another law of that name."""
    return with_line(campaign, laws={**campaign.model.line.laws, name: law})


def with_joints(campaign: Campaign, *joints: Joints, laws: Mapping[str, Law] | None = None) -> Campaign:
    """The campaign with further joints, and their laws."""
    line = campaign.model.line
    return with_line(campaign, joints=(*line.joints, *joints), laws={**line.laws, **(laws or {})})


def with_loss(campaign: Campaign, name: str, law: Law, loss: Law) -> Campaign:
    """The campaign with another law of a layer, and beside it a law of the part of its loss that it does not have.

    A second layer rather than one law of two parts: what acts on the numbers of the first acts on.
    """
    line = campaign.model.line
    added = fresh(f"{name}_loss", line.laws)
    beside = [layer.model_copy(update={"law": added}) for layer in line.joints if layer.law == name]
    return with_line(campaign, joints=(*line.joints, *beside), laws={**line.laws, name: law, added: loss})


def with_fields(campaign: Campaign, name: str, **fields: Any) -> Campaign:
    """The campaign with other fields of a body, checked again."""
    bodies = campaign.model.line.bodies
    body = bodies[name]
    return with_line(campaign, bodies={**bodies, name: type(body)(**{**dict(body), **fields})})


def with_factors(
    campaign: Campaign, law: str, factor: Callable[[Reals], Reals], *, holding: str | None = None
) -> Campaign:
    """The campaign with a factor on every joint of a law, by its place.

    Parameters
    ----------
    law : str
    factor : callable
        From the places of joints, ascending, shape (J,), to the factors.
    holding : str, optional
        Only on joints of this row of bodies.
    """
    line = campaign.model.line
    table = line.joint_table()
    joints = list(line.joints)
    for index, layer in enumerate(joints):
        if layer.law == law and (holding is None or holding in layer.between):
            x = np.unique(table.x[table.layer == index])
            changes = (*layer.changes, *_changes(x, factor(x)))
            joints[index] = layer.model_copy(update={"changes": changes})
    return with_line(campaign, joints=tuple(joints))


def _changes(x: Reals, factors: Reals) -> list[Change]:
    """A change for each run of joints of one factor other than 1."""
    starts = np.flatnonzero(np.concatenate([[True], np.diff(factors) != 0.0])) if x.size else np.zeros(0, int)
    stops = np.concatenate([starts[1:], [x.size]])
    return [
        Change(from_m=float(x[a]) - REACH_M, to_m=float(x[b - 1]) + REACH_M, factor=float(factors[a]))
        for a, b in zip(starts, stops, strict=True)
        if factors[a] != 1.0
    ]


def with_chain(campaign: Campaign, sensor: str, chain: Chain) -> Campaign:
    """The campaign with another measuring chain of a sensor."""
    stated = campaign.stated
    sensors = tuple(s.model_copy(update={"chain": chain}) if s.name == sensor else s for s in stated.sensors)
    changed = stated.model_copy(update={"sensors": sensors})
    return replace(campaign, stated=changed)


def attached_mass(mass_kg: float, frequency_Hz: float, loss_factor: float, dashpot: float = 0.0) -> Law:
    """What a mass on a spring answers where it hangs: a joint to the ground of this law is the resonator.

    Parameters
    ----------
    mass_kg : float
        Of each joint, or per metre with `stiffness_is = "per_metre"`; 0 for none.
    frequency_Hz : float
        Of the mass on its spring, what it hangs on held.
    loss_factor : float
        Of the spring at that frequency.
    dashpot : float
        Share of the loss that is a dashpot's, and so grows with frequency.
    """
    omega = 2.0 * np.pi * frequency_Hz
    stiffness = max(mass_kg, 1e-9) * omega**2
    spring: AnyLaw = Hysteretic(stiffness=stiffness, loss_factor=(1.0 - dashpot) * loss_factor)
    if dashpot:
        beside = KelvinVoigt(stiffness=0.0, damping=dashpot * loss_factor * stiffness / omega)
        spring = Parallel(first=spring, second=beside)
    return Series(first=spring, second=fixed_mass(mass_kg))


def constant_law(campaign: Campaign, name: str) -> Hysteretic:
    """A law k (1 + i eta) of the line.

    Raises
    ------
    InputError
        If another amendment has changed its kind.
    """
    law = campaign.model.line.laws[name]
    if not isinstance(law, Hysteretic):
        raise InputError(
            "its stiffness is not constant any more", where=f"line.laws.{name}", value=type_name(type(law))
        )
    return law


def constant_loss(loss: float) -> Law:
    """A loss that does not depend on frequency, N/m, without stiffness."""
    return StorageLossPair(
        storage_law=Hysteretic(stiffness=0.0), loss_law=Hysteretic(stiffness=loss, loss_factor=1.0)
    )


def fixed_mass(mass_kg: float) -> Law:
    """What a mass answers that is fixed to a body: a joint to the ground of this law is the mass."""
    return Measured(
        quantity="apparent_mass",
        frequency_Hz=EVERYWHERE_HZ,
        real=(mass_kg, mass_kg),
        imaginary=(0.0, 0.0),
    )


def fresh(name: str, taken: Iterable[str]) -> str:
    """The name, with a number if it is taken."""
    used, number, made = set(taken), 1, name
    while made in used:
        number += 1
        made = f"{name}{number}"
    return made
