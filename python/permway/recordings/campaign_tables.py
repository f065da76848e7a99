"""The numbers that the core solves with, and how they change with the parameters.

A response depends on the parameters only through these tables, so its derivative is the core's adjoint by table
entry, contracted with the derivatives given here. No line is solved for them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike

from permway.arrays import Complexes, Reals, real_numbers
from permway.errors import InputError
from permway.model.file import Model
from permway.recordings.campaign import Campaign

STEP = 1e-4
"""Step of the central difference, in standard deviations of the prior (or less, to stay within bounds)."""


@dataclass(frozen=True)
class Tables:
    """Compiled numbers of a model, or their derivatives by one parameter.

    Attributes
    ----------
    laws : ndarray of complex128, shape (F, L)
        Stiffness of every law, N/m.
    scale : ndarray, shape (J,)
        Factor on the law of every joint.
    bending, shear : ndarray of complex128, shape (B,)
        Of every beam, N m2 and N.
    mass, rotary : ndarray, shape (B,)
        Of every beam, kg/m and kg m.
    masses : ndarray, shape (M,)
        Point masses, kg.
    vehicle : ndarray of complex128, shape (F, D, D)
        Dynamic stiffness of the free vehicle; (F, 0, 0) without a train.
    contact : ndarray, shape (1,)
        Flexibility of one contact, m/N; 0 without a train.
    """

    laws: Complexes
    scale: Reals
    bending: Complexes
    shear: Complexes
    mass: Reals
    rotary: Reals
    masses: Reals
    vehicle: Complexes
    contact: Reals


def tables(model: Model, frequency_Hz: ArrayLike, temperature_C: float | None = None) -> Tables:
    """Compile a model.

    Parameters
    ----------
    model : Model
    frequency_Hz : array_like, shape (F,)
    temperature_C : float, optional
        By default the model's.

    Raises
    ------
    InputError
        As :meth:`permway.model.line.Line.joint_table` and :meth:`~permway.model.line.Line.stiffness`.
    """
    frequency = np.atleast_1d(real_numbers(frequency_Hz, "frequency_Hz"))
    temperature = model.temperature_C if temperature_C is None else temperature_C
    return _compiled(model, frequency, temperature, {"laws", "scale", "beams", "vehicle"}, None)


def table_derivatives(
    campaign: Campaign,
    values: Mapping[str, float],
    frequency_Hz: ArrayLike,
    temperature_C: float | None = None,
    *,
    names: Iterable[str] | None = None,
) -> dict[str, Tables]:
    """Derivatives of the tables by parameters, by central differences.

    Parameters
    ----------
    campaign : Campaign
    values : mapping
        Where to differentiate; parameters left out stand at their nominal.
    frequency_Hz : array_like, shape (F,)
    temperature_C : float, optional
    names : iterable of str, optional
        By default all parameters. One that acts on the campaign file alone (a sensor's chain) gives zeros.

    Returns
    -------
    dict of str to Tables
        d table / d z, z in standard deviations of the prior.

    Raises
    ------
    InputError
        As :meth:`Campaign.model_with`.
    """
    frequency = np.atleast_1d(real_numbers(frequency_Hz, "frequency_Hz"))
    known = campaign.parameters.known
    here = {**campaign.parameters.nominal(), **values}
    base_model = campaign.model_with(here)
    temperature = base_model.temperature_C if temperature_C is None else temperature_C
    zero = _zeros(tables(base_model, frequency, temperature))
    found = {}
    for name in known if names is None else names:
        if name not in known:
            raise InputError("no such parameter", where="names", value=name, remedy=f"use one of {list(known)}")
        parts = _parts(campaign.parameters.touches(name))
        if not parts:
            found[name] = zero
            continue
        z = known[name].z(here[name])
        low, high = (_inside(known[name].bounds, known[name].value(z + s)) for s in (-STEP, STEP))
        below, above = (
            _compiled(
                campaign.parameters.moved(base_model, name, here[name], value)
                or campaign.model_with({**here, name: value}),
                frequency,
                temperature,
                parts,
                zero,
            )
            for value in (low, high)
        )
        width = known[name].z(high) - known[name].z(low)
        found[name] = Tables(
            **{f.name: (getattr(above, f.name) - getattr(below, f.name)) / width for f in fields(Tables)}
        )
    return found


def _parts(touched: set[str]) -> set[str]:
    """Which tables can change; all of them for a path into what a preset is made of."""
    parts: set[str] = set()
    for head in touched:
        match head:
            case "line.laws":
                parts |= {"laws"}
            case "line.joints":
                parts |= {"scale"}
            case "line.bodies":
                # Places of a body move the joints that hold on to it.
                parts |= {"beams", "scale"}
            case "train.vehicle" | "train.contact":
                parts |= {"vehicle"}
            case _ if head.startswith(("campaign.", "irregularity.", "train.")):
                pass
            case _:
                parts |= {"laws", "scale", "beams", "vehicle"}
    return parts


def _compiled(
    model: Model, frequency: Reals, temperature: float | None, parts: set[str], rest: Tables | None
) -> Tables:
    """The tables named, the others as `rest` has them."""
    got = {f.name: getattr(rest, f.name) for f in fields(Tables)} if rest is not None else {}
    line = model.line
    if "laws" in parts:
        got["laws"] = line.stiffness(frequency, temperature)
    if "scale" in parts:
        got["scale"] = line.joint_table().scale
    if "beams" in parts:
        pairs = [beam for beam, _ in line.beams()]
        got["bending"] = np.array([b.bending_Nm2 for b in pairs], dtype=np.complex128)
        got["shear"] = np.array([b.shear_N for b in pairs], dtype=np.complex128)
        got["mass"] = np.array([b.mass_kg_per_m for b in pairs], dtype=np.float64)
        got["rotary"] = np.array([b.rotary_kg_m for b in pairs], dtype=np.float64)
        got["masses"] = line.masses_kg()
    if "vehicle" in parts:
        train = model.train
        if train is None:
            got["vehicle"] = np.zeros((frequency.size, 0, 0), dtype=np.complex128)
            got["contact"] = np.zeros(1)
        else:
            got["vehicle"] = train.vehicle.dynamic_stiffness(frequency)
            got["contact"] = np.array([train.contact.receptance(train.vehicle.share)])
    return Tables(**got)


def _zeros(like: Tables) -> Tables:
    return Tables(**{f.name: np.zeros_like(getattr(like, f.name)) for f in fields(Tables)})


def _inside(bounds: tuple[float, float], value: float) -> float:
    return min(max(value, bounds[0]), bounds[1])
