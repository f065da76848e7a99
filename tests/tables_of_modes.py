"""A deck on its bearings and its table of modes, as tests write them."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
from permway.laws.toml import to_toml
from permway.model.line import Line
from permway.model.place import Place
from permway.response.modes import poles_between

PLACES_M = {"a": 4.0, "b": 9.0, "c": 12.0, "d": 19.0}
SD, SD_DAMPING = 0.002, 0.1

MODEL: dict[str, Any] = {
    "format": 1,
    "frequencies": {"from_Hz": 5.0, "to_Hz": 200.0, "step_Hz": 5.0},
    "line": {
        "bodies": {
            "deck": {
                "type": "beam",
                "youngs_modulus_Pa": 3.4e10,
                "second_moment_m4": 1.2,
                "density_kg_per_m3": 2500.0,
                "area_m2": 4.0,
                "loss_factor": 0.04,
                "intervals_m": [[0.0, 24.0]],
            }
        },
        "laws": {"bearing": {"type": "hysteretic", "stiffness": 1.5e9, "loss_factor": 0.1}},
        "joints": [{"between": ["deck", "ground"], "law": "bearing", "at": {"of": "deck"}}],
    },
    "forces": [{"body": "deck", "x_m": 12.0}],
    "sensors": [{"body": "deck", "x_m": 12.0}],
}

CAMPAIGN: dict[str, Any] = {
    "format": 1,
    "title": "Modes of a deck",
    "model": "model.toml",
    "parameters": [
        {"name": "E", "paths": "line.bodies.deck.youngs_modulus_Pa", "unit": "Pa", "tolerance_2sigma": 0.15},
        {"name": "eta", "paths": "line.bodies.deck.loss_factor", "tolerance_2sigma": 0.5},
        {"name": "k", "paths": "line.laws.bearing.stiffness", "unit": "N/m", "tolerance_2sigma": 0.3},
    ],
    "sensors": [{"name": n, "body": "deck", "x_m": x, "unit": "m/s2"} for n, x in PLACES_M.items()],
    "conditions": [{"name": "ambient", "kind": "table"}],
    "records": [
        {
            "name": "table",
            "file": "modes.csv",
            "condition": "ambient",
            "statistic": "modes",
            "channels": {n: n for n in PLACES_M},
        }
    ],
}


def changed(amend: Any = None) -> dict[str, Any]:
    """The model's table after a change."""
    model = copy.deepcopy(MODEL)
    if amend is not None:
        amend(model)
    return model


def rows_of(
    model: dict[str, Any], *, seed: int | None = None, shapes: bool = True, high_Hz: float = 120.0
) -> list[str]:
    """The lines of a table of a model's modes, exact, or with scatter of a seed."""
    line = Line.model_validate(model["line"])
    found = poles_between(line, 3.0, high_Hz, places=[Place(body="deck", x_m=x) for x in PLACES_M.values()])
    rng = np.random.default_rng(seed)
    scatter = np.zeros((2, found.omega.size)) if seed is None else rng.standard_normal((2, found.omega.size))
    header = "frequency_Hz,frequency_sd_Hz,damping,damping_sd"
    lines = [header + ("," + ",".join(PLACES_M) if shapes else "")]
    for f, z, shape, (e, d) in zip(found.frequency_Hz, found.damping, found.shape.real, scatter.T, strict=True):
        cells = [
            f * np.exp(SD * e),
            SD * f,
            z * np.exp(SD_DAMPING * d),
            SD_DAMPING * z,
            *(shape if shapes else ()),
        ]
        lines.append(",".join(f"{v:.9g}" for v in cells))
    return lines


def write(
    folder: Path, rows: list[str], *, model: dict[str, Any] | None = None, free: bool = True, **record: Any
) -> Path:
    """A campaign of the nominal model, or another, with this table; keys of its record may differ.

    Unless parameters are free, it has none.
    """
    folder.mkdir(parents=True, exist_ok=True)
    campaign = copy.deepcopy(CAMPAIGN)
    campaign["records"][0] |= record
    if not free:
        del campaign["parameters"]
    (folder / "modes.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    (folder / "model.toml").write_text(to_toml(model or MODEL), encoding="utf-8")
    path = folder / "campaign.toml"
    path.write_text(to_toml(campaign), encoding="utf-8")
    return path
