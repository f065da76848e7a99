"""rolland's side: its discrete Timoshenko track in frequency domain (TSBDiscr1L), as its user would call it.

Its rail is UIC60 of its own database with the numbers of the problem. Supports stand on a rigid slab, which
rolland writes as a ballast of 1e20 N/m2 in series: 3e-12 of the pad's stiffness.
"""

from __future__ import annotations

import copy
from collections.abc import Callable
from pathlib import Path

import numpy as np
import problems
from rolland.components import DiscrPad, Slab
from rolland.database.rail.db_rail import UIC60
from rolland.methods import TSBDiscr1L
from rolland.track import SimplePeriodicSlabSingleRailTrack


def track() -> SimplePeriodicSlabSingleRailTrack:
    u = problems.UIC60
    rail = copy.copy(UIC60)
    rail.E, rail.G, rail.etar = u["youngs_modulus_Pa"], u["shear_modulus_Pa"], u["loss_factor"]
    rail.Ar, rail.kapz = 76.70e-4, u["shear_area_m2"] / 76.70e-4
    rail.Iyr, rail.mr, rail.rho = u["second_moment_m4"], u["mass_kg_per_m"], u["density_kg_per_m3"]
    k, eta = problems.PAD_N_PER_M, problems.PAD_LOSS
    pad = DiscrPad(sp_z=k, sp_y=k, sp_x=k, etap_z=eta, etap_y=eta, etap_x=eta, etap_r=eta, wdthp=0.15)
    # Of the slab only ms enters the vertical response, against 1e20 N/m2; the rest must be there.
    size = {"lengs": 2.6, "equ_wdths": 0.26, "heights": 0.2, "z_st": -0.1, "z_sb": 0.1}
    slab = Slab(ms=250.0, Is_x=1.0, Is_y=1.0, Is_z=1.0, rhos=2500.0, **size)
    return SimplePeriodicSlabSingleRailTrack(
        rail=rail, pad=pad, slab=slab, distance=problems.BAY_M, num_mount=problems.SUPPORTS, z_f=0.076, y_f=0.0
    )


def prepare(case: str, grid: np.ndarray, _: Path) -> Callable[[], np.ndarray]:
    line, x = track(), problems.places(case)[0]

    def solve() -> np.ndarray:
        method = TSBDiscr1L(track=line, f=grid, x_excit=x, x=x, damp_type="hysteretic")
        return np.reshape(method.receptance, (grid.size, 1, 1))

    return solve


if __name__ == "__main__":
    problems.run(prepare)
