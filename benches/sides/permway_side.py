"""permway's side: the public call, from the model to the labelled dataset, on so many threads."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import permway
import problems
from permway import _core
from permway.laws import Hysteretic

THREADS = int(os.environ.get("OMP_NUM_THREADS", "1"))
TEMPERATURE_C = 20.0
# The compiled core alone, without the model's tables and the dataset.
_core.solve_line = CORE = problems.Part(_core.solve_line)


def line(case: str) -> permway.Line:
    """The line of a case."""
    if case != "rail":
        return permway.slab_track_viaduct_32m(spans=problems.spans(case))
    u = problems.UIC60
    area = u["mass_kg_per_m"] / u["density_kg_per_m3"]
    rail = permway.Beam(
        theory="timoshenko",
        area_m2=area,
        shear_coefficient=u["shear_area_m2"] / area,
        **{k: v for k, v in u.items() if k not in ("shear_area_m2", "mass_kg_per_m")},
    )
    pad = Hysteretic(stiffness=problems.PAD_N_PER_M, loss_factor=problems.PAD_LOSS)
    at = tuple(problems.BAY_M * i for i in range(problems.SUPPORTS))
    joints = permway.Joints(between=("rail", "ground"), law="pad", at=at)
    return permway.Line(bodies={"rail": rail}, joints=(joints,), laws={"pad": pad})


def write_tables(track: permway.Line, grid: np.ndarray, path: Path) -> None:
    """The line as plain arrays, for the sides that know no permway."""
    beams, table = track.beams(), track.joint_table()
    np.savez(
        path,
        bending=[b.bending_Nm2 for b, _ in beams],
        shear=[b.shear_N for b, _ in beams],
        mass=[b.mass_kg_per_m for b, _ in beams],
        rotary=[b.rotary_kg_m for b, _ in beams],
        interval=[(s.start, s.stop) for _, s in beams],
        x=table.x,
        upper=table.upper,
        lower=table.lower,
        law=table.law,
        scale=table.scale,
        stiffness=track.stiffness(grid, TEMPERATURE_C),
    )


def prepare(case: str, grid: np.ndarray, folder: Path) -> Callable[[], np.ndarray]:
    tables = folder / f"{case}.npz"
    track = line(case)
    if not tables.exists():
        write_tables(track, problems.frequencies(case), tables)
    at = [permway.Place(body="rail", x_m=x) for x in problems.places(case)]

    def solve() -> np.ndarray:
        data = permway.receptance(
            line(case), grid, forces=at, sensors=at, temperature_C=TEMPERATURE_C, threads=THREADS
        )
        return data["receptance"].values

    return solve


if __name__ == "__main__":
    problems.run(prepare, CORE)
