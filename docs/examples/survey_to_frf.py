"""A survey's CSVs to one table that permway reads: `python survey_to_frf.py FOLDER impacts.csv`.

Each `impact_BODY_Xm.csv` has magnitude, phase and coherence of some sensors side by side; the table has a row for
each frequency, sensor and point.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np


def rows(file: Path) -> list[str]:
    """Of one file: its name says where was struck, its header what was read."""
    body, x = file.stem.split("_")[1:]
    labels = [cell.split()[1] for cell in file.read_text().splitlines()[0].split(";")[1::3]]
    table = np.loadtxt(file, delimiter=";", skiprows=1)
    point, found = f"{body}@{x.removesuffix('m')}", []
    for i, label in enumerate(labels):
        for frequency, *parts in table[:, [0, 3 * i + 1, 3 * i + 2, 3 * i + 3]]:
            found.append(",".join([f"{frequency:g}", label, point, *(f"{part:g}" for part in parts)]))
    return found


if __name__ == "__main__":
    lines = ["frequency [Hz],sensor,point,magnitude [(m/s2)/N],phase [deg],coherence"]
    for file in sorted(Path(sys.argv[1]).glob("impact_*.csv")):
        lines += rows(file)
    Path(sys.argv[2]).write_text("\n".join(lines) + "\n")
