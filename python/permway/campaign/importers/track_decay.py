"""Track decay rates in one-third octaves, a row for each test."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from permway.campaign.campaign import Campaign
from permway.campaign.importers.writing import Draft, write_campaigns
from permway.errors import InputError
from permway.files import check_folder
from permway.laws.textfile import number, read_lines

TABLE = "tdr_reference_section.csv"
COLUMNS = ("tdr_id", "messdatum", "temp", "rail", "dir")

SPACING_M = 0.6
"""Of the sleepers; not stated, usual there."""

LENGTH_M = 90.0
ACCELEROMETER_M = 25.5 * SPACING_M
"""In the middle of a bay, far from the ends of the sleepers."""

BAND_HZ = (250.0, 2500.0)
"""Where the model holds: below, the ballast is more than a spring; above, so is the rail's section."""

CONTINUOUS_M = 0.15
"""Spacing that stands for a continuous support: the rail is pinned between supports far above 5 kHz only."""

TOLERANCES = {
    "pad.k": ("line.laws.pad.stiffness", "N/m", 0.9),
    "pad.eta": ("line.laws.pad.loss_factor", "1", 0.7),
    "ballast.k": ("line.laws.ballast.stiffness", "N/m", 0.9),
    "ballast.eta": ("line.laws.ballast.loss_factor", "1", 0.7),
    "rail.eta": ("line.bodies.rail.loss_factor", "1", 0.9),
    "sleeper.m": ("line.bodies.sleeper.mass_kg", "kg", 0.2),
}
"""Paths, units and two standard deviations, relative; pads and ballast differ widely from line to line."""


def import_track_decay(folder: Path, output: Path, *, copy: bool = False, support: str = "discrete") -> Campaign:
    """Turn the table of decay rates into a campaign.

    The model is a 60E1 rail on B91 sleepers in ballast; section and spacing are assumed, as the source does not
    say them. Lateral rates are kept, and not predicted.

    Parameters
    ----------
    folder : Path
        Holds `tdr_reference_section.csv`.
    output : Path
    copy : bool
        Whether the table is copied beside the campaign.
    support : "discrete" or "continuous"
        Sleepers, or the same mass and stiffness spread out.

    Raises
    ------
    InputError
        For a table that cannot be read.
    """
    if support not in ("discrete", "continuous"):
        raise InputError("unknown", where="support", value=support, remedy='use "discrete" or "continuous"')
    check_folder(output)
    source = folder / TABLE
    header, *rows = read_lines(source)
    missing = [name for name in COLUMNS if name not in header.cells]
    if missing:
        raise InputError(
            f"no column {', '.join(missing)}", where=f"{source}: line {header.number}", value=header.cells
        )
    if not rows:
        raise InputError("holds no test", where=str(source), remedy="it needs a row for each, below its header")
    conditions, records = [], []
    for row in rows:
        if len(row.cells) != len(header.cells):
            what = f"{len(row.cells)} cells where the header has {len(header.cells)}"
            raise InputError(what, where=f"{source}: line {row.number}")
        cell = dict(zip(header.cells, row.cells, strict=True))
        test = number(cell["tdr_id"], f"{source}: line {row.number}, column 'tdr_id'")
        temperature = number(cell["temp"], f"{source}: line {row.number}, column 'temp'")
        lateral = cell["dir"] == "h"
        name = f"tdr_{test:g}"
        conditions.append(
            {
                "name": name,
                "kind": "hammer",
                "temperature_C": temperature,
                "date": cell["messdatum"],
                "note": f"rail {cell['rail']}; not stated whether the temperature is the air's or the rail's",
            }
        )
        records.append(
            {
                "name": f"{name}_{cell['rail']}_{cell['dir']}",
                "file": TABLE,
                "condition": name,
                "statistic": "decay",
                "spacing_m": SPACING_M,
                "band_Hz": list(BAND_HZ),
                "channels": {"rail": "rail lateral" if lateral else "rail vertical"},
                "select": {"tdr_id": test},
            }
        )
    place = {"body": "rail", "x_m": ACCELEROMETER_M, "unit": "m/s2"}
    campaign = {
        "format": 1,
        "title": f"Track decay rates of a ballasted section, {support} support",
        "model": "model.toml",
        "parameters": [
            {"name": name, "unit": unit, "paths": [path], "acts": "scales", "tolerance_2sigma": tolerance}
            for name, (path, unit, tolerance) in TOLERANCES.items()
        ],
        "sensors": [
            {"name": "rail vertical", **place},
            {"name": "rail lateral", **place, "direction": "lateral"},
        ],
        "conditions": conditions,
        "records": records,
    }
    model = _model(SPACING_M if support == "discrete" else CONTINUOUS_M)
    return write_campaigns(output, [Draft(campaign, model, [source])], copy=copy)[0]


def _model(spacing_m: float) -> dict[str, Any]:
    share = spacing_m / SPACING_M
    each = {"of": "sleeper"}
    place = {"body": "rail", "x_m": ACCELEROMETER_M}
    return {
        "format": 1,
        "title": "60E1 on B91 sleepers in ballast",
        "frequencies": {"from_Hz": 100.0, "to_Hz": 5000.0, "points": 200},
        "line": {
            "bodies": {
                "rail": {
                    "type": "beam",
                    "theory": "timoshenko",
                    "youngs_modulus_Pa": 2.1e11,
                    "second_moment_m4": 3.0383e-5,
                    "density_kg_per_m3": 7850.0,
                    "area_m2": 7.67e-3,
                    "shear_modulus_Pa": 8.1e10,
                    "shear_coefficient": 0.4,
                    "loss_factor": 0.01,
                },
                "sleeper": {
                    "type": "mass",
                    "mass_kg": 150.0 * share,
                    "at": {"from_m": 0.0, "to_m": LENGTH_M, "spacing_m": spacing_m},
                },
            },
            "laws": {
                "pad": {"type": "hysteretic", "stiffness": 5.0e8, "loss_factor": 0.25},
                "ballast": {"type": "hysteretic", "stiffness": 2.0e7, "loss_factor": 1.0},
            },
            "joints": [
                {"between": ["rail", "sleeper"], "law": "pad", "at": each, "scale": share},
                {"between": ["sleeper", "ground"], "law": "ballast", "at": each, "scale": share},
            ],
        },
        "forces": [place],
        "sensors": [place],
    }
