"""Small lines for the campaigns of `simulated_train`: slab track on one span and two, ballast, a bed."""

from __future__ import annotations

import copy
from typing import Any

from simulated import MODEL

SPAN_M, STEP_M = 15.0, 0.6


def beam(modulus: float, inertia: float, area: float, loss: float, *intervals: list[float]) -> dict[str, Any]:
    """A concrete beam."""
    return {
        "type": "beam",
        "youngs_modulus_Pa": modulus,
        "second_moment_m4": inertia,
        "density_kg_per_m3": 2500.0,
        "area_m2": area,
        "loss_factor": loss,
        "intervals_m": list(intervals),
    }


def along(low: float, high: float, step: float = STEP_M) -> dict[str, float]:
    """Stations."""
    return {"from_m": low, "to_m": high, "spacing_m": step}


def hysteretic(stiffness: float, loss: float) -> dict[str, Any]:
    """A law."""
    return {"type": "hysteretic", "stiffness": stiffness, "loss_factor": loss}


def rail(*interval: float) -> dict[str, Any]:
    """The rail of the deck of 12 m, over another length."""
    return {**MODEL["line"]["bodies"]["rail"], "intervals_m": [list(interval)]}


def viaduct(spans: int = 1) -> dict[str, Any]:
    """Rail, slab, base plate and girder, on bearings; fasteners to the ground before and behind."""
    length = spans * SPAN_M
    whole, each = [0.0, length], [[SPAN_M * i, SPAN_M * (i + 1)] for i in range(spans)]
    bodies = {
        "rail": rail(-4.0, length + 4.0),
        "slab": beam(3.4e10, 8.5e-4, 0.255, 0.05, whole),
        "base": beam(3.0e10, 3.6e-3, 0.49, 0.05, whole),
        "girder": beam(3.5e10, 0.35, 2.2, 0.04, *each),
    }
    laws = {
        "pad": hysteretic(4.0e7, 0.15),
        "mortar": hysteretic(3.0e9, 0.1),
        "sliding": hysteretic(4.0e9, 0.15),
        "bearing": hysteretic(1.2e9, 0.2),
    }
    approach = [along(-3.6, -0.6), along(length + 0.6, length + 3.6)]
    joints = [
        {"between": ["rail", "slab"], "law": "pad", "at": along(0.0, length)},
        {"between": ["rail", "ground"], "law": "pad", "at": approach},
        {"between": ["slab", "base"], "law": "mortar", "at": along(0.0, length), "stiffness_is": "total"},
        # No station where two girders meet: it would have to say which of them is meant.
        {
            "between": ["base", "girder"],
            "law": "sliding",
            "at": [along(a + 0.3, b - 0.3) for a, b in each],
            "stiffness_is": "total",
        },
        {"between": ["girder", "ground"], "law": "bearing", "at": {"of": "girder"}},
    ]
    return _model(bodies, laws, joints, 7.2)


def ballasted() -> dict[str, Any]:
    """Sleepers on ballast."""
    sleeper = {"type": "mass", "mass_kg": 150.0, "at": along(0.0, 12.0)}
    laws = {"pad": hysteretic(8.0e7, 0.15), "ballast": hysteretic(2.0e7, 0.4)}
    rows = {"of": "sleeper"}
    joints = [
        {"between": ["rail", "sleeper"], "law": "pad", "at": rows},
        {"between": ["sleeper", "ground"], "law": "ballast", "at": rows},
    ]
    return _model({"rail": rail(-1.0, 13.0), "sleeper": sleeper}, laws, joints, 6.0)


def embedded() -> dict[str, Any]:
    """A rail on a continuous support."""
    joints = [
        {
            "between": ["rail", "ground"],
            "law": "bed",
            "at": along(0.0, 12.0, 0.1),
            "stiffness_is": "per_metre",
        }
    ]
    return _model({"rail": rail(-1.0, 13.0)}, {"bed": hysteretic(6.0e7, 0.15)}, joints, 6.0)


def _model(bodies: dict[str, Any], laws: dict[str, Any], joints: list[Any], middle: float) -> dict[str, Any]:
    model = copy.deepcopy(MODEL)
    model["line"] = {"bodies": bodies, "laws": laws, "joints": joints}
    model["forces"] = model["sensors"] = [{"body": "rail", "x_m": middle}]
    return model


def campaign(model: dict[str, Any]) -> dict[str, Any]:
    """Hammer tests on all bodies along x, and what the user does not know exactly."""
    line = model["line"]
    middle = model["forces"][0]["x_m"]
    places = [("rail", middle), ("rail", middle + 3.3), ("rail", 1.5)]
    for body in line["bodies"]:
        if body == "sleeper":
            places.append((f"{body}[6]", 3.0))
        elif body != "rail":
            # Where two girders meet neither may be meant; the second of two is by name.
            several = len(line["bodies"][body]["intervals_m"]) > 1
            places += [(f"{body}[1]" if several else body, x) for x in (middle, 3.9)]
    parameters = [
        {"name": f"{law}.k", "unit": "N/m", "paths": f"line.laws.{law}.stiffness", "tolerance_2sigma": 0.3}
        for law in line["laws"]
    ]
    parameters += [
        {"name": f"{law}.eta", "paths": f"line.laws.{law}.loss_factor", "tolerance_2sigma": 0.4}
        for law in line["laws"]
    ]
    parameters += [
        {"name": f"{body}.E", "paths": f"line.bodies.{body}.youngs_modulus_Pa", "tolerance_2sigma": 0.12}
        for body in line["bodies"]
        if body not in ("rail", "sleeper")
    ]
    struck = [("rail", middle), ("rail", middle + 2.1), (places[-1][0], places[-1][1] + 0.7)]
    if "sleeper" in struck[-1][0]:
        struck[-1] = ("rail", 3.3)
    sensors = [
        {"name": f"{b.split('[')[0]}@{x:g}", "body": b, "x_m": x, "unit": "m/s2"} for b, x in dict.fromkeys(places)
    ]
    return {
        "format": 1,
        "title": "A small line",
        "model": "model.toml",
        "parameters": parameters,
        "sensors": sensors,
        "forces": [{"name": f"hit{i}", "body": b, "x_m": x} for i, (b, x) in enumerate(struck)],
        "conditions": [{"name": "still", "kind": "hammer", "temperature_C": 12.0}],
        "records": [
            {
                "name": "blows",
                "file": "frf.npz",
                "condition": "still",
                "statistic": "frf",
                "averages": 16,
                "responses": {s["name"]: s["name"] for s in sensors},
                "references": {f"hit{i}": f"hit{i}" for i in range(len(struck))},
            }
        ],
    }
