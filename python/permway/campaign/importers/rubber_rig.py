"""Rubber tested twice over: a DMA machine, and a mass on two rings shaken at its base."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from permway.campaign.campaign import Campaign
from permway.campaign.importers.writing import Draft, write_campaigns
from permway.errors import InputError
from permway.files import check_folder
from permway.laws import law_to_dict
from permway.laws.dma import DmaTable, read_dma
from permway.laws.identify import identify
from permway.laws.transmissibility import ShearRig

RIG = ShearRig(
    outer_diameter_m=33.5e-3, inner_diameter_m=11.8e-3, thickness_m=6e-3, rings=2, moving_mass_kg=14.8e-3
)
"""As the recordings' README gives it; end discs of 14.8 g move with the mass."""

MASSES_KG = {"118g": 0.1178, "253g": 0.2533, "573g": 0.573, "1196g": 1.196}
"""By the name of the file, to the tenth of a gram."""

AREA_M2 = RIG.shape_factor_m * RIG.thickness_m / RIG.rings
"""Of one ring."""

ROOM_C = 21.0
"""Of the shaker's room, not logged."""

CONSTANT, SHEET_HZ = "constant", 10.0
"""The law that a data sheet knows, and the frequency that it is of."""

KNOWN = {"tolerance_2sigma": 0.5}
"""How well a rig's factor, or a rubber's stiffness and loss, are known, relative."""

WITHIN_DB = 0.5
"""Of two accelerometers against each other, as data sheets have it: not stated, usual."""

Known = list[tuple[str, str, str]]
"""Name, unit and key of what is not known of a law."""


def import_rubber_rig(
    folder: Path, output: Path, *, copy: bool = False, law: str = "fractional_zener"
) -> list[Campaign]:
    """Turn every material of the folder into a campaign in a folder of its name.

    The model is the rubber's law as identified from the DMA table at the lowest strain, by WLF, and one mass on it
    that was shaken; nothing is fitted to the shaker. With the law "constant" it is what a data sheet states,
    modulus and loss factor at 10 Hz and room temperature, and the campaign holds the shaker's records alone: what
    the DMA knows of frequency is withheld.

    A shaker record is named by level and mass, as 01g_253g.csv. Records of one level are of one condition; a mass
    that was shaken at several is one body with one sensor. Files that are no records of these are named in a
    warning.

    Parameters
    ----------
    folder : Path
        Holds a folder for every material, with `dma` and `shaker` in it.
    output : Path
    copy : bool
        Whether the records are copied beside the campaigns.
    law : str
        "constant", or a family, see :func:`permway.laws.identify.identify`.

    Raises
    ------
    InputError
        For a folder without materials, or files that cannot be read.
    """
    check_folder(output)
    materials = sorted(path.parent.parent for path in folder.glob("*/dma/tf_015p.csv"))
    if not materials:
        raise InputError("holds no material", where=str(folder), remedy="it needs */dma/tf_015p.csv")
    untested = sorted({path.parent for path in folder.glob("*/shaker")} - set(materials))
    _left_aside(folder, untested, "without dma/tf_015p.csv")
    return write_campaigns(output, [_material(path, law) for path in materials], copy=copy)


def _material(folder: Path, law: str) -> Draft:
    sweep = folder / "dma" / "tf_015p.csv"
    shaken = [path for path in _files(folder / "shaker") if path.suffix.lower() == ".csv"]
    if not shaken:
        raise InputError("holds no shaker record", where=str(folder / "shaker"))
    rubber, known = _constant(read_dma(sweep)) if law == CONSTANT else _identified(read_dma(sweep), law)
    named = {path: _level_and_mass(path) for path in shaken}
    masses = list(dict.fromkeys(mass for _, mass in named.values()))
    strains = sorted((folder / "dma").glob("sd_*.csv"))
    tested = [] if law == CONSTANT else [sweep, *strains]
    _left_aside(folder / "shaker", set(_files(folder / "shaker")) - set(shaken), "no tables")
    _left_aside(
        folder / "dma", set(_files(folder / "dma")) - {sweep, *strains}, "neither tf_015p.csv nor sd_*.csv"
    )
    records: list[dict[str, Any]] = [_dma(path) for path in tested]
    records += [
        {
            "name": path.stem,
            "file": path.name,
            "condition": f"shaker_{level}",
            "statistic": "transmissibility",
            "channels": {"mass": mass},
            "within_dB": WITHIN_DB,
        }
        for path, (level, (mass, _)) in named.items()
    ]
    levels = {
        level: [path for path in shaken if named[path][0] == level]
        for level in sorted({level for level, _ in named.values()})
    }
    campaign = {
        "format": 1,
        "title": f"{folder.name}: two rings in shear, {'and their DMA' if tested else 'as a data sheet has it'}",
        "model": "model.toml",
        "parameters": [
            {"name": name, "unit": unit, "paths": [f"line.laws.rubber.{key}"], "acts": "scales", **KNOWN}
            for name, unit, key in known
        ],
        "sensors": [
            {"name": name, "body": name, "x_m": _place(i), "unit": "m/s2"} for i, (name, _) in enumerate(masses)
        ],
        "conditions": [
            *([{"name": "dma", "kind": "table"}] if tested else []),
            *(
                {"name": f"shaker_{level}", "kind": "shaker", "temperature_C": ROOM_C, "note": "room, not logged"}
                for level in levels
            ),
        ],
        "records": records,
        "held_out": [
            {"name": name, "axis": "record", "members": [path.stem for path in left_out]}
            for name, left_out in _held_out(levels, strains, bool(tested))
        ],
    }
    model = _model(folder.name, rubber, masses)
    return Draft(campaign, model, [*tested, *shaken], folder.name)


def _held_out(
    levels: dict[str, list[Path]], strains: list[Path], tested: bool
) -> Iterator[tuple[str, list[Path]]]:
    """Each of several levels; all that was shaken, and all that was strained, or without a DMA each by itself."""
    shaken = sorted(path for paths in levels.values() for path in paths)
    if len(levels) > 1:
        yield from ((f"level {level}", paths) for level, paths in levels.items())
    if not tested:
        yield from ((path.stem, [path]) for path in shaken)
        return
    yield "shaker", shaken
    if strains:
        yield "strain", strains


def _identified(table: DmaTable, law: str) -> tuple[dict[str, Any], Known]:
    """The law of one ring of the rubber as its DMA knows it, and the rig's factor on it."""
    found = identify(table, law=law, shift="wlf", reference_temperature_C=ROOM_C)
    ring = {
        "type": "pad",
        "area_m2": AREA_M2,
        "thickness_m": RIG.thickness_m,
        "effective_fraction": 1.0,
        "material": law_to_dict(found.law),
    }
    return ring, [("rig.factor", "1", "effective_fraction")]


def _constant(table: DmaTable) -> tuple[dict[str, Any], Known]:
    """One ring with the modulus and loss factor of the test nearest to 10 Hz and room temperature."""
    away = np.abs(np.log(table.frequency_Hz / SHEET_HZ))
    if table.temperature_C is not None:
        away = away + np.abs(table.temperature_C - ROOM_C)
    row = int(np.argmin(away))
    storage, loss = float(table.storage_Pa[row]), float(table.loss_Pa[row])
    ring = {
        "type": "hysteretic",
        "stiffness": storage * AREA_M2 / RIG.thickness_m,
        "loss_factor": loss / storage,
    }
    return ring, [("rubber.k", "N/m", "stiffness"), ("rubber.eta", "1", "loss_factor")]


def _dma(path: Path) -> dict[str, Any]:
    return {
        "name": path.stem,
        "file": path.name,
        "condition": "dma",
        "statistic": "material",
        "law": "line.laws.rubber.material",
    }


def _level_and_mass(path: Path) -> tuple[str, tuple[str, float]]:
    """The shaker's level as the file's name has it, and the mass's name and kg."""
    remedy = "name it by level and mass, as 1g_253g.csv"
    level, _, rest = path.stem.partition("_")
    key = rest.split("_")[-1]
    if not (level and rest):
        raise InputError("states not both a level and a mass", where=str(path), value=path.stem, remedy=remedy)
    if key in MASSES_KG:
        return level, (f"mass_{key}", MASSES_KG[key])
    grams = re.fullmatch(r"(\d+(?:\.\d+)?)g", key)
    if grams is None:
        raise InputError("states no mass", where=str(path), value=path.stem, remedy=remedy)
    return level, (f"mass_{key.replace('.', '-')}", 1e-3 * float(grams[1]))


def _files(folder: Path) -> list[Path]:
    return sorted(path for path in folder.glob("*") if path.is_file() and not path.name.startswith("."))


def _left_aside(folder: Path, others: Iterable[Path], why: str) -> None:
    """Name what nobody will miss else."""
    names = sorted(path.name for path in others)
    if names:
        warnings.warn(f"{folder}: left aside, {why}: {', '.join(names)}", stacklevel=4)


def _place(index: int) -> float:
    return float(index)


def _model(name: str, law: dict[str, Any], masses: list[tuple[str, float]]) -> dict[str, Any]:
    places = [{"body": body, "x_m": _place(i)} for i, (body, _) in enumerate(masses)]
    return {
        "format": 1,
        "title": f"{name}: masses on two rings each",
        "temperature_C": ROOM_C,
        "frequencies": {"from_Hz": 20.0, "to_Hz": 1000.0, "points": 100},
        "line": {
            "bodies": {body: {"type": "mass", "mass_kg": mass + RIG.moving_mass_kg} for body, mass in masses},
            "laws": {"rubber": law},
            "joints": [
                {"between": [body, "ground"], "law": "rubber", "at": [_place(i)], "scale": float(RIG.rings)}
                for i, (body, _) in enumerate(masses)
            ],
        },
        "forces": places,
        "sensors": places,
    }
