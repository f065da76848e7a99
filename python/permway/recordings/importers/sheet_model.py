"""From a sheet to the model file: the half model on one rail, as the sheet describes it."""

from __future__ import annotations

from typing import Any

import numpy as np

from permway.errors import InputError
from permway.recordings.importers.sheet_form import BeamValues, LayerValues, Sheet

WHEEL_GRID_M = 0.16
"""Wheelsets stand at whole multiples of this, as the sheets' `position` says."""

_LAYERS = ("pad", "mortar", "sliding", "bearing")


def model_table(sheet: Sheet, title: str) -> dict[str, Any]:
    """The model file as a table.

    Sections, masses and stiffnesses are of one rail already. Vehicle masses are of the whole vehicle, of which the
    model carries the share `half`; suspensions are those of one side and stay, so the whole vehicle has 1/half of
    them; the contact is one wheel's. Layers' totals go over the stations by length, half shares at the ends. The
    irregularity is the German spectrum of low disturbance down to 1 m, continued as W^-3.06.

    Raises
    ------
    InputError
        For lengths that are no whole number of spacings.
    """
    layout, values = sheet.layout, sheet.values
    length = layout.spans * layout.span_m
    spacing = layout.fastener_spacing_m
    deck = {"from_m": 0.0, "to_m": _whole(length, spacing, "span_m"), "spacing_m": spacing}
    _whole(length, layout.slab_length_m, "slab_length_m")
    slabs = round(length / layout.slab_length_m)
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
                "slab": {"type": "beam", **_beam(values.slab), "intervals_m": _row(slabs, layout.slab_length_m)},
                "base": {"type": "beam", **_beam(values.base), "intervals_m": _row(1, length)},
                "girder": {
                    "type": "beam",
                    **_beam(values.girder),
                    "intervals_m": _row(layout.spans, layout.span_m),
                },
            },
            "laws": {name: _law(getattr(values, name)) for name in _LAYERS},
            "joints": [
                {"between": ["rail", "slab"], "law": "pad", "at": deck},
                *_approaches(sheet, length),
                {"between": ["slab", "base"], "law": "mortar", "at": deck, "stiffness_is": "total"},
                {"between": ["base", "girder"], "law": "sliding", "at": deck, "stiffness_is": "total"},
                {"between": ["girder", "ground"], "law": "bearing", "at": {"of": "girder"}},
            ],
        },
        "forces": [{"body": struck, "x_m": struck_m}],
        "sensors": [{"body": body, "x_m": x} for body, x in sheet.hammer.sensors],
    }
    if sheet.runs is not None:
        table["train"] = {
            "centre_m": 0.5 * length,
            "speed_m_per_s": sheet.runs.speeds_kmh[0] / 3.6,
            "vehicle": _vehicle(sheet),
            "contact": {"type": "given", "stiffness_N_per_m": sheet.contact_stiffness_N_per_m},
        }
        table["irregularity"] = {"type": "german_sato", "continuous": True, "exponent": 3.06}
    return table


def wheels_m(sheet: Sheet) -> list[float]:
    """Where the wheelsets stand, the leading one first, each at the nearest whole multiple of 0.16 m.

    Halfway between two the even multiple: of 26 and 6 m it makes 25.92 and 6.08 m, as the records' lags have it.
    """
    vehicle = sheet.values.vehicle
    centre = 0.5 * sheet.layout.spans * sheet.layout.span_m
    away = (
        np.array([1.0, 1.0, -1.0, -1.0]) * 0.5 * vehicle.lc + np.array([1.0, -1.0, 1.0, -1.0]) * 0.5 * vehicle.lt
    )
    # Three spans of 31.4 m are 94.2 m but for a last digit, which must not tell what is halfway.
    multiples = np.round(((centre + away) / WHEEL_GRID_M).round(9))
    return [round(float(x), 6) for x in WHEEL_GRID_M * multiples]


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


def _whole(length: float, part: float, name: str) -> float:
    if abs(length / part - round(length / part)) > 1e-6:
        raise InputError(f"{length:g} m is no whole number of {part:g} m", where=f"sheet.json: layout.{name}")
    return length
