"""Which fastener matters: derivatives by every one, and the response with one of them gone."""

from __future__ import annotations

import numpy as np
import permway
import xarray as xr
from look import axes, show
from matplotlib.figure import Figure

FREQUENCY_HZ = np.geomspace(10.0, 600.0, 240)


def compute() -> dict[str, xr.DataArray | np.ndarray]:
    """The rail's receptance whole, with the fastener below it gone, with one 3.1 m away gone; derivatives."""
    line = permway.slab_track_viaduct_32m()
    rail = permway.Place(body="rail", x_m=16.0)
    data = permway.sensitivity(
        line, FREQUENCY_HZ, forces=[rail], sensors=[rail], places=True, bodies=False, temperature_C=20.0
    )
    table = line.joint_table()
    pads = np.flatnonzero(table.law == list(line.laws).index("pad"))
    law = line.laws["pad"].complex(FREQUENCY_HZ, 20.0)
    below = int(pads[np.abs(table.x[pads] - 16.0).argmin()])
    away = int(pads[np.abs(table.x[pads] - 19.1).argmin()])
    whole = data["receptance"].values[:, 0, 0]
    gone = [permway.change_joint(data, joint, -law).values[:, 0, 0] for joint in (below, away)]
    # A relative change of each pad's stiffness, in parts of the receptance.
    share = np.stack([permway.by_joint(data, int(j)).values[:, 0, 0] * law / whole for j in pads], axis=-1)
    return {"whole": whole, "below": gone[0], "away": gone[1], "x": table.x[pads], "share": share}


def numbers(found: dict[str, np.ndarray]) -> dict[str, float]:
    """What the page quotes."""
    at = int(np.abs(FREQUENCY_HZ - 100.0).argmin())
    share = np.abs(found["share"][at])
    middle = int(np.abs(found["x"] - 16.0).argmin())
    return {
        "per cent of the receptance at 100 Hz, by 1 % of the pad below": float(share[middle]),
        "by 1 % of its neighbour": float(share[middle + 1]),
        "dB at 100 Hz with the pad below gone": float(20 * np.log10(abs(found["below"][at] / found["whole"][at]))),
        "dB at 100 Hz with the one 3.1 m away gone": float(
            20 * np.log10(abs(found["away"][at] / found["whole"][at]))
        ),
    }


def picture(found: dict[str, np.ndarray]) -> Figure:
    """Receptances, and a map of what each pad does."""
    figure, (left, right) = axes(2)
    for name, label in (("whole", "whole"), ("below", "pad below gone"), ("away", "pad 3.1 m away gone")):
        left.loglog(FREQUENCY_HZ, np.abs(found[name]), label=label, linestyle="--" if name == "away" else "-")
    left.set(xlabel="frequency, Hz", ylabel="receptance, m/N")
    left.legend(frameon=False, fontsize=8)
    drawn = right.pcolormesh(FREQUENCY_HZ, found["x"], np.abs(found["share"]).T, cmap="magma_r", vmax=0.5)
    right.grid(False)
    right.set(xlabel="frequency, Hz", ylabel="pad at x, m", xscale="log", ylim=(10, 22))
    figure.colorbar(drawn, ax=right, label="change by 1 % of the pad, %")
    return figure


if __name__ == "__main__":
    show(__file__, compute, numbers, picture)
