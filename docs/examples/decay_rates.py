"""Track decay rate of ballasted track with soft and stiff pads, by the places of EN 15461."""

from __future__ import annotations

import numpy as np
import permway
import xarray as xr
from look import axes, show
from matplotlib.figure import Figure
from permway.model.lines_ballasted import ballasted_b91_60e1
from permway.recordings.estimates.bands import bands_between
from permway.recordings.estimates.decay_rate import grid_positions, track_decay_rate

PADS = {"soft, 100 kN/mm": 1.0e8, "stiff, 600 kN/mm": 6.0e8}
BANDS = bands_between(100.0, 4000.0)


def compute() -> dict[str, xr.DataArray]:
    """Decay rate in dB/m over one-third octaves, by pad."""
    found = {}
    for name, stiffness in PADS.items():
        pad = permway.law_from_dict({"type": "hysteretic", "stiffness": stiffness, "loss_factor": 0.2})
        line = ballasted_b91_60e1(sleepers=241, pad=pad)
        places = 72.3 + grid_positions(0.6)
        sensors = [permway.Place(body="rail", x_m=float(x), name=f"{x:.2f}") for x in places]
        # Seven lines a band; energies of the band are added.
        lines = np.array([np.geomspace(a, b, 9)[1:-1] for a, b in zip(BANDS.low_Hz, BANDS.high_Hz, strict=True)])
        data = permway.receptance(line, lines.reshape(-1), forces=sensors[:1], sensors=sensors)
        velocity = permway.mobility(data["receptance"]).values[:, :, 0].reshape(*lines.shape, -1)
        energy = np.sqrt((np.abs(velocity) ** 2).mean(axis=1)).T
        rate = track_decay_rate(energy, grid_positions(0.6), warn=False)["decay_rate"]
        found[name] = rate.assign_coords(line=BANDS.nominal_Hz)
    return found


def numbers(found: dict[str, xr.DataArray]) -> dict[str, float]:
    """What the page quotes."""
    quoted = {}
    for name, rate in found.items():
        for f in (315.0, 1000.0):
            quoted[f"{name}, {f:g} Hz, dB/m"] = float(rate.sel(line=f, method="nearest"))
    return quoted


def picture(found: dict[str, xr.DataArray]) -> Figure:
    """Rates over frequency."""
    figure, (one,) = axes()
    for name, rate in found.items():
        one.loglog(rate["line"], rate, "o-", markersize=4, label=name)
    one.set(xlabel="one-third octave, Hz", ylabel="decay rate, dB/m", xticks=[100, 250, 500, 1000, 2000, 4000])
    one.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
    one.xaxis.set_minor_formatter(lambda x, _: "")
    one.legend(frameon=False)
    return figure


if __name__ == "__main__":
    show(__file__, compute, numbers, picture)
