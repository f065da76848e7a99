"""Rail pad rubbers as two files each: storage modulus and loss factor over frequency."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from permway.campaign.campaign import Campaign
from permway.campaign.importers.writing import Draft, write_campaigns
from permway.errors import InputError
from permway.files import check_folder
from permway.laws import law_to_dict
from permway.laws.dma import read_modulus_pair
from permway.laws.identify import identify

STORAGE, LOSS = "storage_modulus_MPa.tsv", "loss_factor.tsv"

AREA_M2, THICKNESS_M = 0.18 * 0.15, 7e-3
"""A pad of usual size, assumed, to make a stiffness of the modulus in the model file."""

RAIL_KG = 60.0
"""About a metre of rail, assumed: what stands on the pad in the model file."""


def import_pad_materials(
    folder: Path, output: Path, *, copy: bool = False, law: str = "springpot_parallel"
) -> list[Campaign]:
    """Turn every material of the folder into a campaign in a folder of its name.

    The model's law is identified from the table itself, so what the campaign shows is what a law of that form
    leaves over. Its temperature is not stated.

    Raises
    ------
    InputError
        For a folder without materials, or files that cannot be read.
    """
    check_folder(output)
    materials = sorted({path.parent for name in (STORAGE, LOSS) for path in folder.glob(f"*/{name}")})
    if not materials:
        raise InputError("holds no material", where=str(folder), remedy=f"it needs */{STORAGE} and */{LOSS}")
    return write_campaigns(output, [_material(path, law) for path in materials], copy=copy)


def _material(folder: Path, law: str) -> Draft:
    table = read_modulus_pair(folder / STORAGE, folder / LOSS)
    found = identify(table, law=law, shift="none")
    campaign: dict[str, Any] = {
        "format": 1,
        "title": f"{folder.name}: modulus over frequency",
        "model": "model.toml",
        "parameters": [
            {
                "name": f"material.{name}",
                "unit": "",
                "paths": [f"line.laws.pad.material.{path}"],
                "acts": "scales",
                "tolerance_2sigma": 0.5,
            }
            for name, path in _numbers(law_to_dict(found.law))
        ],
        "conditions": [
            {"name": "dma", "kind": "table", "note": "very probably shifted to one temperature, not stated"}
        ],
        "records": [
            {
                "name": "modulus",
                "file": STORAGE,
                "loss_file": LOSS,
                "condition": "dma",
                "statistic": "material",
                "law": "line.laws.pad.material",
            }
        ],
    }
    place = {"body": "rail", "x_m": 0.0}
    model = {
        "format": 1,
        "title": f"{folder.name}: a pad of usual size under a metre of rail",
        "frequencies": {"from_Hz": 1.0, "to_Hz": 1000.0, "points": 100},
        "line": {
            "bodies": {"rail": {"type": "mass", "mass_kg": RAIL_KG}},
            "laws": {
                "pad": {
                    "type": "pad",
                    "area_m2": AREA_M2,
                    "thickness_m": THICKNESS_M,
                    "material": law_to_dict(found.law),
                }
            },
            "joints": [{"between": ["rail", "ground"], "law": "pad", "at": [0.0]}],
        },
        "forces": [place],
        "sensors": [place],
    }
    return Draft(campaign, model, [folder / STORAGE, folder / LOSS], folder.name)


def _numbers(law: dict[str, Any], before: str = "") -> list[tuple[str, str]]:
    """Name and path of every number above zero in a law's table."""
    found: list[tuple[str, str]] = []
    for key, value in law.items():
        if isinstance(value, dict):
            found += _numbers(value, f"{before}{key}.")
        elif isinstance(value, float) and value > 0.0:
            found.append((f"{before}{key}", f"{before}{key}"))
    return found
