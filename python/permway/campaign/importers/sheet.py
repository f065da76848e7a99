"""A measuring team's folder - sheet.json, hammer FRFs, runs - as a campaign."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from permway.campaign.campaign import Campaign
from permway.campaign.importers.sheet_form import Sheet, read_sheet
from permway.campaign.importers.sheet_locations import matched, names_of
from permway.campaign.importers.sheet_model import model_table
from permway.campaign.importers.sheet_position import MOVING
from permway.campaign.importers.sheet_runs import UNITS, Runs, read_runs
from permway.campaign.importers.writing import Draft, write_campaigns
from permway.errors import InputError
from permway.files import check_folder
from permway.reading import inside
from permway.recordings.readers import read_frf

KEYS = {
    "E": ("youngs_modulus_Pa", "Pa"),
    "I": ("second_moment_m4", "m4"),
    "rho": ("density_kg_per_m3", "kg/m3"),
    "A": ("area_m2", "m2"),
    "G": ("shear_modulus_Pa", "Pa"),
    "kappa": ("shear_coefficient", "1"),
    "k": ("stiffness", "N/m"),
    "eta": ("loss_factor", "1"),
}

VEHICLE_KEYS = {
    "Mc": ("car_body_mass_kg", "kg"),
    "Mt": ("bogie_mass_kg", "kg"),
    "Mw": ("wheelset_mass_kg", "kg"),
    "Jc": ("car_body_inertia_kg_m2", "kg m2"),
    "Jt": ("bogie_inertia_kg_m2", "kg m2"),
    "kp": ("primary_stiffness_N_per_m", "N/m"),
    "cp": ("primary_damping_Ns_per_m", "N s/m"),
    "ks": ("secondary_stiffness_N_per_m", "N/m"),
    "cs": ("secondary_damping_Ns_per_m", "N s/m"),
    "lc": ("bogie_distance_m", "m"),
    "lt": ("wheelbase_m", "m"),
}

LAYERS = ("pad", "mortar", "sliding", "bearing")

SPEED_2SIGMA, SPEED_BOUND = 0.005, 0.01
"""How well a train's speed is usually noted, and beyond which it is wrong: wheelsets 20 m apart resolve 0.05 %."""

NOISE_2SIGMA = 0.4
"""How far noise where the train is measured may be from what a quiet band states, both of one recorder."""

_SUFFIXES = (".uff", ".unv", ".mat", ".csv", ".npz", ".h5", ".nc", ".tdms", ".wav")


def import_sheet(folder: Path, output: Path, *, copy: bool = True) -> Campaign:
    """Turn a folder with a `sheet.json` into a campaign.

    Parameters
    ----------
    folder : Path
    output : Path
        Gets `campaign.toml`, `model.toml` and, with `copy`, the records.

    Raises
    ------
    InputError
        For a sheet or a record that cannot be read, or does not hold what the sheet states.
    """
    check_folder(output)
    sheet = read_sheet(folder)
    unit = _unit(sheet.hammer.quantity)
    title = f"{folder.resolve().name}: {sheet.layout.spans} span(s) of {sheet.layout.span_m:g} m"
    conditions, records, sources = [], [], []
    for temperature in sheet.temperature_C:
        name = f"hammer_{temperature:+.0f}C"
        source = _find(folder, name)
        conditions.append({"name": name, "kind": "hammer", "temperature_C": temperature})
        records.append(_hammer_record(sheet, name, source))
        sources.append(source)
    runs, names = None, []
    if sheet.runs is not None:
        names = [f"run_{speed:.0f}kmh" for speed in sheet.runs.speeds_kmh]
        runs = read_runs(sheet, [_find(folder, name) for name in names])
        conditions += runs.conditions(names)
        records += runs.records(names)
        sources += runs.sources
    campaign = {
        "format": 1,
        "title": title,
        "model": "model.toml",
        "irregularity": _irregularity(sheet, runs) if runs else None,
        "parameters": [*_parameters(sheet), *(_train_parameters(sheet, names) if runs else [])],
        "sensors": [*_line_sensors(sheet, unit), *(runs.sensors() if runs else [])],
        "forces": _points(sheet),
        "conditions": conditions,
        "records": records,
        "held_out": _held_out(sheet),
    }
    draft = Draft(campaign, model_table(sheet, title), sources)
    return write_campaigns(output, [draft], copy=copy)[0]


def _irregularity(sheet: Sheet, runs: Runs) -> dict[str, Any]:
    """As sheets measure it. Trains stand where the sheet has the irregularity move under them, or none ran."""
    stated = "" if sheet.runs is None else sheet.runs.position
    stands = (isinstance(stated, str) and MOVING in stated) or any(runs.interpolated)
    return {"knowledge": "within", "within_dB": 2.0} | ({"rolling": False} if stands else {})


def _find(folder: Path, name: str) -> Path:
    found = [path for suffix in _SUFFIXES if (path := folder / (name + suffix)).is_file()]
    if len(found) == 1:
        return inside(
            found[0].name, folder, where=str(folder), of="the sheet's", remedy="put the file itself there"
        )
    if found:
        names = [path.name for path in found]
        raise InputError("there are two of that name", where=str(folder), value=names, remedy="leave one")
    remedy = f"the sheet names it; its name ends in one of {', '.join(_SUFFIXES)}"
    raise InputError(f"there is no file {name}", where=str(folder), remedy=remedy)


def _line_sensors(sheet: Sheet, unit: str) -> list[dict[str, Any]]:
    return [
        {"name": name, "body": body, "x_m": x, "quantity": "acceleration", "unit": unit}
        for name, (body, x) in zip(names_of(sheet.hammer.sensors), sheet.hammer.sensors, strict=True)
    ]


def _points(sheet: Sheet) -> list[dict[str, Any]]:
    points = sheet.hammer.points
    return [
        {"name": name, "body": body, "x_m": x} for name, (body, x) in zip(names_of(points), points, strict=True)
    ]


def _unit(quantity: str) -> str:
    """Accelerance in (m/s^2)/N is what these folders hold; anything else is refused."""
    found = re.search(r"\((m/s\^?2|g)\)\s*/\s*N", quantity)
    if not quantity.lower().startswith("accelerance") or found is None:
        remedy = "write it as 'accelerance (m/s^2)/N, ...'"
        raise InputError(
            "must be an accelerance with its unit",
            where="sheet.json: hammer.quantity",
            value=quantity,
            remedy=remedy,
        )
    return UNITS[found[1]]


def _hammer_record(sheet: Sheet, name: str, source: Path) -> dict[str, Any]:
    file = read_frf(source)
    responses = matched(file.responses, sheet.hammer.sensors, source, "sensors")
    references = matched(file.references, sheet.hammer.points, source, "points")
    blows = re.search(r"of (\d+) blows", sheet.hammer.quantity)
    record: dict[str, Any] = {
        "name": name,
        "file": source.name,
        "condition": name,
        "statistic": "frf",
        "band_Hz": list(sheet.hammer.lines_Hz[:2]),
        "responses": responses,
        "references": references,
    }
    if blows is not None:
        record["averages"] = float(blows[1])
    elif file.averages is None:
        remedy = "write it as 'H1 of 8 blows'"
        raise InputError("states no number of blows", where="sheet.json: hammer.quantity", remedy=remedy)
    return record


def _parameters(sheet: Sheet) -> list[dict[str, Any]]:
    parameters = []
    for group, table in sheet.tolerance_2sigma_relative.items():
        for key, tolerance in table.items():
            if group == "vehicle" and sheet.runs is None:
                continue
            paths, unit, nominal = _paths(sheet, group, key)
            parameters.append(
                {
                    "name": f"{group}.{key}",
                    "unit": unit,
                    "paths": paths,
                    "acts": "scales",
                    "nominal": nominal,
                    "tolerance_2sigma": tolerance,
                    "prior": "log_normal",
                }
            )
    return parameters


def _paths(sheet: Sheet, group: str, key: str) -> tuple[list[str], str, float]:
    """Where a value stands in the model, its unit, and what the sheet states that it is."""
    values = getattr(sheet.values, group)
    nominal = float(getattr(values, key))
    if group == "vehicle":
        name, unit = VEHICLE_KEYS[key]
        return [f"train.vehicle.{name}"], unit, nominal
    name, unit = KEYS[key]
    if group not in LAYERS:
        return [f"line.bodies.{group}.{name}"], unit, nominal
    law = f"line.laws.{group}"
    if values.viscous_at_Hz is None:
        return [f"{law}.{name}"], unit, nominal
    # A loss factor scales the dashpot, and so does the stiffness that it is a share of.
    return ([f"{law}.stiffness", f"{law}.damping"] if key == "k" else [f"{law}.damping"]), unit, nominal


def _train_parameters(sheet: Sheet, runs: Sequence[str]) -> list[dict[str, Any]]:
    level = {
        "name": "irregularity.level",
        "unit": "dB",
        "paths": ["campaign.irregularity.level_dB"],
        "acts": "sets",
        "tolerance_2sigma": 2.0,
        "absolute": True,
    }
    floors = [
        {
            "name": f"noise.{channel}",
            "unit": "(m/s2)2/Hz",
            "paths": [f"campaign.sensors.{channel}.chain.noise_floor"],
            "acts": "scales",
            "tolerance_2sigma": NOISE_2SIGMA,
            "prior": "log_normal",
        }
        for channel in (sheet.runs.channels if sheet.runs else ())
    ]
    speeds = [
        {
            "name": f"speed.{run}",
            "unit": "m/s",
            "paths": [f"campaign.conditions.{run}.speed_m_per_s"],
            "acts": "scales",
            "tolerance_2sigma": SPEED_2SIGMA,
            "prior": "log_normal",
            "bounds": [speed / 3.6 * (1.0 - SPEED_BOUND), speed / 3.6 * (1.0 + SPEED_BOUND)],
        }
        for run, speed in zip(runs, sheet.runs.speeds_kmh if sheet.runs else (), strict=True)
    ]
    return [level, *floors, *speeds]


def _held_out(sheet: Sheet) -> list[dict[str, Any]]:
    """Groups along the axes that such a folder has: places, a channel, a band, a speed, a temperature."""
    length = sheet.layout.spans * sheet.layout.span_m
    groups: list[dict[str, Any]] = [
        {"name": "second quarter", "axis": "place", "from_to_m": [0.25 * length, 0.5 * length - 0.01]},
        {"name": "upper band", "axis": "band", "band_Hz": [200.0, 260.0]},
        {"name": "last sensor", "axis": "channel", "members": names_of(sheet.hammer.sensors)[-1:]},
    ]
    if sheet.runs is not None and len(sheet.runs.speeds_kmh) > 1:
        groups.append({"name": "last speed", "axis": "speed", "members": [sheet.runs.speeds_kmh[-1] / 3.6]})
    if len(sheet.temperature_C) > 1:
        groups.append({"name": "last temperature", "axis": "temperature", "members": [sheet.temperature_C[-1]]})
    return groups
