"""From a sheet to the model file: the half model on one rail, as the sheet describes it."""

from __future__ import annotations

from typing import Any

import numpy as np

from permway.campaign.importers.sheet_form import BeamValues, LayerValues, Sheet
from permway.campaign.importers.sheet_layers import MEET_M, between
from permway.campaign.importers.sheet_position import position
from permway.errors import InputError

_LAYERS = ("pad", "mortar", "sliding", "bearing")


def model_table(sheet: Sheet, title: str) -> dict[str, Any]:
    """The model file as a table.

    Sections, masses and stiffnesses are of one rail already. Vehicle masses are of the whole vehicle, of which the
    model carries the share `half`; suspensions are those of one side and stay, so the whole vehicle has 1/half of
    them; the contact is one wheel's. Layers: :func:`permway.campaign.importers.sheet_layers.between`. The
    irregularity is the German spectrum of low disturbance down to 1 m, continued as W^-3.06.

    Raises
    ------
    InputError
        For lengths that are no whole number of spacings, and for a sensor or hammer point where two beams meet.
    """
    layout, values = sheet.layout, sheet.values
    length = layout.spans * layout.span_m
    spacing = layout.fastener_spacing_m
    _whole(length, spacing, "span_m")
    _whole(length, layout.slab_length_m, "slab_length_m")
    slabs_m = _row(round(length / layout.slab_length_m), layout.slab_length_m)
    spans_m = _row(layout.spans, layout.span_m)
    _check_locations(sheet, {"slab": slabs_m, "girder": spans_m})
    rail = values.rail
    struck, struck_m = sheet.hammer.points[0]
    table: dict[str, Any] = {
        "format": 1,
        "title": title,
        "temperature_C": sheet.temperature_C[0],
        "frequencies": dict(zip(("from_Hz", "to_Hz", "step_Hz"), sheet.hammer.lines_Hz, strict=True)),
        "line": {
            "bodies": {
                "rail": {
                    "type": "beam",
                    "theory": "timoshenko",
                    **_beam(rail),
                    "shear_modulus_Pa": rail.G,
                    "shear_coefficient": rail.kappa,
                },
                "slab": {"type": "beam", **_beam(values.slab), "intervals_m": slabs_m},
                "base": {"type": "beam", **_beam(values.base), "intervals_m": _row(1, length)},
                "girder": {"type": "beam", **_beam(values.girder), "intervals_m": spans_m},
            },
            "laws": {name: _law(getattr(values, name)) for name in _LAYERS},
            "joints": [
                *between("rail", "slab", "pad", length, spacing, slabs_m, total=False),
                *_approaches(sheet, length),
                *between("slab", "base", "mortar", length, spacing, slabs_m, total=True),
                *between("base", "girder", "sliding", length, spacing, spans_m, total=True),
                {"between": ["girder", "ground"], "law": "bearing", "at": {"of": "girder"}},
            ],
        },
        "forces": [{"body": struck, "x_m": struck_m}],
        "sensors": [{"body": body, "x_m": x} for body, x in dict.fromkeys(sheet.hammer.sensors)],
    }
    if sheet.runs is not None:
        table["train"] = {
            "centre_m": position(sheet).centre_m,
            "speed_m_per_s": sheet.runs.speeds_kmh[0] / 3.6,
            "vehicle": _vehicle(sheet),
            "contact": {"type": "given", "stiffness_N_per_m": sheet.contact_stiffness_N_per_m},
        }
        table["irregularity"] = {"type": "german_sato", "continuous": True, "exponent": 3.06}
    return table


def _vehicle(sheet: Sheet) -> dict[str, Any]:
    v = sheet.values.vehicle
    return {
        "car_body_mass_kg": v.Mc,
        "bogie_mass_kg": v.Mt,
        "wheelset_mass_kg": v.Mw,
        "car_body_inertia_kg_m2": v.Jc,
        "bogie_inertia_kg_m2": v.Jt,
        "primary_stiffness_N_per_m": v.kp / v.half,
        "primary_damping_Ns_per_m": v.cp / v.half,
        "secondary_stiffness_N_per_m": v.ks / v.half,
        "secondary_damping_Ns_per_m": v.cs / v.half,
        "bogie_distance_m": v.lc,
        "wheelbase_m": v.lt,
        "share": v.half,
    }


def _beam(values: BeamValues | Any) -> dict[str, float]:
    return {
        "youngs_modulus_Pa": values.E,
        "second_moment_m4": values.I,
        "density_kg_per_m3": values.rho,
        "area_m2": values.A,
        "loss_factor": values.eta,
    }


def _law(layer: LayerValues) -> dict[str, Any]:
    if layer.viscous_at_Hz is None:
        return {"type": "hysteretic", "stiffness": layer.k, "loss_factor": layer.eta}
    damping = layer.k * layer.eta / (2.0 * np.pi * layer.viscous_at_Hz)
    return {"type": "kelvin_voigt", "stiffness": layer.k, "damping": damping}


def _row(count: int, length: float) -> list[list[float]]:
    return [[i * length, (i + 1) * length] for i in range(count)]


def _approaches(sheet: Sheet, length: float) -> list[dict[str, Any]]:
    spacing, reach = sheet.layout.fastener_spacing_m, sheet.layout.approach_m
    if reach < 0.5 * spacing:
        return []
    _whole(reach, spacing, "approach_m")
    before = {"from_m": -reach, "to_m": -spacing, "spacing_m": spacing}
    behind = {"from_m": length + spacing, "to_m": length + reach, "spacing_m": spacing}
    return [{"between": ["rail", "ground"], "law": "pad", "at": [before, behind]}]


def _check_locations(sheet: Sheet, rows: dict[str, list[list[float]]]) -> None:
    """Ask which of two beams is meant by a place where they meet."""
    for what, locations in (("sensors", sheet.hammer.sensors), ("points", sheet.hammer.points)):
        for index, (body, x) in enumerate(locations):
            for number, (_, end) in enumerate(rows.get(body, [])[:-1], start=1):
                if abs(x - end) < MEET_M:
                    raise InputError(
                        f"two of the {body}s meet there: which of them is it on?",
                        where=f"sheet.json: hammer.{what}[{index}]",
                        value=[body, x],
                        remedy=f'write ["{body}[{number}]", {x:g}] or ["{body}[{number + 1}]", {x:g}]',
                    )


def _whole(length: float, part: float, name: str) -> float:
    if abs(length / part - round(length / part)) > 1e-6:
        raise InputError(f"{length:g} m is no whole number of {part:g} m", where=f"sheet.json: layout.{name}")
    return length
