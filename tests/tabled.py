"""The small campaign with its responses as a table of text, a row for each frequency, sensor and point."""

from __future__ import annotations

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from permway.laws.toml import to_toml
from simulated import CAMPAIGN, FREQUENCY, simulate

Rows = list[dict[str, Any]]


def nothing(_table: dict[str, Any]) -> None:
    """The campaign as it is."""


def tabled(
    folder: Path,
    *,
    rows: Callable[[Rows], Rows] = lambda rows: rows,
    unit: str | None = "(m/s2)/N",
    scale: complex = 1.0,
    stated: Callable[[dict[str, Any]], None] = nothing,
    seed: int = 5,
) -> Path:
    """Write the campaign; its path.

    Parameters
    ----------
    folder : Path
    rows : callable
        Changes the table, rows of f, sensor, point, real, imag, coherence.
    unit : str, optional
        In the header.
    scale : complex
        On what is written.
    stated : callable
        Changes the campaign's table.
    """
    made = simulate(folder, seed)
    (dataset,) = made.campaign.load()
    frf, coherence = dataset.data["frf"].values * scale, dataset.data["coherence"].values
    table: Rows = [
        {
            "f": float(f),
            "sensor": sensor,
            "point": point,
            "real": f"{frf[i, j, k].real:.8g}",
            "imag": f"{frf[i, j, k].imag:.8g}",
            "coherence": f"{coherence[i, j, k]:.7f}",
        }
        for i, sensor in enumerate(CAMPAIGN["records"][0]["responses"])
        for j, point in enumerate(CAMPAIGN["records"][0]["references"])
        for k, f in enumerate(FREQUENCY)
    ]
    head = "" if unit is None else f" [{unit}]"
    lines = [f"frequency [Hz],sensor,point,real{head},imag{head},coherence"]
    lines += [",".join(str(cell) for cell in row.values()) for row in rows(table)]
    (folder / "frf.csv").write_text("\n".join(lines) + "\n")
    campaign = copy.deepcopy(CAMPAIGN)
    campaign["records"][0]["file"] = "frf.csv"
    stated(campaign)
    made.path.write_text(to_toml(campaign))
    return made.path


def without(*cells: str, sensor: str, point: str) -> Callable[[Rows], Rows]:
    """Cells of a pair emptied; without any, its rows taken away."""

    def change(rows: Rows) -> Rows:
        mine = [row for row in rows if (row["sensor"], row["point"]) == (sensor, point)]
        assert len(mine) == np.size(FREQUENCY)
        if not cells:
            return [row for row in rows if row not in mine]
        for row in mine:
            row |= dict.fromkeys(cells, "")
        return rows

    return change
