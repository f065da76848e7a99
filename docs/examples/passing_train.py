"""The train HSLM-A1 over a bridge of 15 m: acceleration at midspan over speed, and its resonance."""

from __future__ import annotations

import numpy as np
import permway
from look import axes, show
from matplotlib.figure import Figure

LENGTH_M, MASS_KG_PER_M, FIRST_HZ, COACH_M = 15.0, 15e3, 5.0, 18.0
SPEEDS_KM_PER_H = np.array([150.0, 200.0, 240.0, 280.0, 300.0, 310.0, 320.0, 325.0, 330.0, 340.0, 360.0, 400.0])


def compute() -> dict[str, np.ndarray]:
    """Largest acceleration at each speed, m/s2, and the history at resonance."""
    bending = MASS_KG_PER_M * (2 * np.pi * FIRST_HZ * (LENGTH_M / np.pi) ** 2) ** 2
    bridge = permway.Beam(
        youngs_modulus_Pa=bending,
        second_moment_m4=1.0,
        density_kg_per_m3=MASS_KG_PER_M,
        area_m2=1.0,
        intervals_m=((0.0, LENGTH_M),),
        ends="pinned",
        loss_factor=0.02,
    )
    line = permway.Line(bodies={"bridge": bridge}, joints=(), laws={})
    middle = permway.Place(body="bridge", x_m=LENGTH_M / 2)
    peaks, found = [], {}
    for speed in SPEEDS_KM_PER_H:
        train = permway.hslm_a(1, speed_m_per_s=speed / 3.6, body="bridge")
        data = permway.passby(line, train, sensors=[middle], highest_Hz=30.0, quantity="acceleration")
        history = data["history"].sum("part") if "part" in data["history"].dims else data["history"]
        peaks.append(float(np.abs(history).max()))
        if speed == 325.0:
            found = {"time": data["time"].values, "history": history.isel(sensor=0).values}
    return {**found, "peak": np.array(peaks)}


def numbers(found: dict[str, np.ndarray]) -> dict[str, float]:
    """What the page quotes."""
    peak = found["peak"]
    return {
        "speed of the largest acceleration, km/h": float(SPEEDS_KM_PER_H[peak.argmax()]),
        "first frequency times coach length, km/h": 3.6 * FIRST_HZ * COACH_M,
        "largest acceleration, m/s2": float(peak.max()),
        "at 240 km/h, m/s2": float(peak[SPEEDS_KM_PER_H == 240.0][0]),
    }


def picture(found: dict[str, np.ndarray]) -> Figure:
    """Over speed, and over time at resonance."""
    figure, (left, right) = axes(2)
    left.plot(SPEEDS_KM_PER_H, found["peak"], "o-", markersize=4)
    left.set(xlabel="speed, km/h", ylabel="largest acceleration, m/s$^2$")
    right.plot(found["time"], found["history"], linewidth=0.8)
    right.set(xlabel="time, s", ylabel="acceleration at 325 km/h, m/s$^2$", xlim=(-1, 8))
    return figure


if __name__ == "__main__":
    show(__file__, compute, numbers, picture)
