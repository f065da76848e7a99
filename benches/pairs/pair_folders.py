"""Where recordings lie, and how a campaign is laid into a folder."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from permway.laws.toml import to_toml

RECORDINGS = Path(__file__).resolve().parents[3] / "shared" / "recordings"
"""Beside the repository: licences differ from the project's, so nothing of them is in it."""


def lay(folder: Path, campaign: Mapping[str, Any], model: Mapping[str, Any]) -> Path:
    """Write both files of a campaign; gives the campaign's."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "model.toml").write_text(to_toml(dict(model)), "utf-8")
    path = folder / "campaign.toml"
    path.write_text(to_toml({"format": 1, "model": "model.toml", **campaign}), "utf-8")
    return path


def columns(path: Path) -> list[np.ndarray]:
    """Columns of a table of numbers with one line of names."""
    return list(np.loadtxt(path, delimiter=",", skiprows=1).T)


def responses(path: Path, frequency_Hz: np.ndarray, frf: np.ndarray, coherence: np.ndarray | None = None) -> str:
    """Write one frequency response as a table that a record of "frf" reads; gives the file's name."""
    path.parent.mkdir(parents=True, exist_ok=True)
    names = ["frequency [Hz]", "sensor", "point", "real", "imaginary"]
    table: list[Sequence[float]] = [frequency_Hz, frf.real, frf.imag]
    if coherence is not None:
        names.append("coherence")
        table.append(np.clip(coherence, 0.0, 1.0))
    rows = zip(*table, strict=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(names)
        for at, *values in rows:
            writer.writerow([f"{at:.9g}", "out", "in", *(f"{value:.9g}" for value in values)])
    return path.name


def one_response(
    name: str, file: str, condition: str, band_Hz: tuple[float, float], **more: Any
) -> dict[str, Any]:
    """A record of one frequency response."""
    return {
        "name": name,
        "file": file,
        "condition": condition,
        "statistic": "frf",
        "band_Hz": list(band_Hz),
        "responses": {"out": "out"},
        "references": {"in": "in"},
        **more,
    }


def factor(name: str, path: str, two_sigma: float) -> dict[str, Any]:
    """A parameter that is a factor of about 1 on a number of the model or the campaign."""
    return {"name": name, "unit": "1", "paths": [path], "nominal": 1.0, "tolerance_2sigma": two_sigma}
