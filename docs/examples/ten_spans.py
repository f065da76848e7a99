"""A viaduct of ten spans: how far a blow on the third one reaches."""

from __future__ import annotations

import numpy as np
import permway
import xarray as xr
from look import axes, show
from matplotlib.figure import Figure

SPAN_M, SPANS = 32.0, 10
FREQUENCY_HZ = np.arange(1.0, 200.5, 0.5)


def compute() -> xr.DataArray:
    """Receptance of every girder's middle, and of the rail above, to a force on the third span's rail, m/N."""
    line = permway.slab_track_viaduct_32m(spans=SPANS)
    middles = [SPAN_M * (i + 0.5) for i in range(SPANS)]
    struck = permway.Place(body="rail", x_m=middles[2])
    sensors = [permway.Place(body="rail", x_m=x, name=f"rail {i + 1}") for i, x in enumerate(middles)]
    sensors += [
        permway.Place(body=f"girder[{i + 1}]", x_m=x, name=f"girder {i + 1}") for i, x in enumerate(middles)
    ]
    answer = permway.receptance(line, FREQUENCY_HZ, forces=[struck], sensors=sensors, temperature_C=20.0)
    return answer["receptance"].isel(force=0)


def numbers(found: xr.DataArray) -> dict[str, float]:
    """What the page quotes."""
    size = abs(found)
    first = size.sel(sensor="girder 3", frequency=slice(2.0, 10.0))
    peak = float(first.idxmax("frequency"))

    def fall(body: str, span: int, frequency: float) -> float:
        here = size.sel(frequency=frequency)
        return float(20.0 * np.log10(here.sel(sensor=f"{body} 3") / here.sel(sensor=f"{body} {span}")))

    return {
        "resonance of the span that is struck, Hz": peak,
        "girder 4 below girder 3 there, dB": fall("girder", 4, peak),
        "girder 5 below girder 3 there, dB": fall("girder", 5, peak),
        "rail over span 4 below that over span 3 at 100 Hz, dB": fall("rail", 4, 100.0),
    }


def picture(found: xr.DataArray) -> Figure:
    """Levels of the girders over frequency and span."""
    figure, (one,) = axes()
    girders = [f"girder {i + 1}" for i in range(SPANS)]
    level = 20.0 * np.log10(abs(found.sel(sensor=girders)).values)
    span = np.arange(1, SPANS + 1)
    drawn = one.pcolormesh(FREQUENCY_HZ, span, level.T, cmap="viridis", shading="nearest", vmin=-280, vmax=-160)
    one.grid(False)
    one.set(xlabel="frequency, Hz", ylabel="span", xscale="log", yticks=span, xticks=[1, 3, 10, 30, 100, 200])
    one.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
    figure.colorbar(drawn, ax=one, label="girder's receptance, dB re 1 m/N")
    return figure


if __name__ == "__main__":
    show(__file__, compute, numbers, picture)
