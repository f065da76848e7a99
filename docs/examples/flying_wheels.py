"""A train over a weld that lies too deep: the wheel leaves the rail, and lands harder than one held to it."""

from __future__ import annotations

import numpy as np
from look import axes, show
from matplotlib.figure import Figure
from permway.challenge.assembly import assemble
from permway.challenge.crossing import Consist, cross
from permway.challenge.layout import NOMINAL, Layout
from permway.challenge.mesh import Mesh

WELD_M, DEPTH_M, LENGTH_M, SPEED_M_PER_S = 20.3, 2e-3, 0.4, 70.0
LINE = Layout(spans=5, bays=101, spacing_m=0.64, approach_bays=90)


def weld(x: np.ndarray) -> np.ndarray:
    """How much lower the rail is, m."""
    along = np.clip((x - WELD_M) / LENGTH_M, -0.5, 0.5)
    return np.asarray(0.5 * DEPTH_M * (1.0 + np.cos(2.0 * np.pi * along)))


def compute() -> dict[str, np.ndarray]:
    """Two cars over five spans, by finite elements integrated in time; once with contacts that only press."""
    train = Consist(NOMINAL, cars=2, car_m=25.0, speed_m_per_s=SPEED_M_PER_S)
    middle = [("girder", LINE.station(30))]
    line = Mesh(assemble(LINE, NOMINAL), middle)
    found = {}
    for name, leaves in (("free", True), ("held", False)):
        run = cross(line, train, from_m=5.0, to_m=72.0, leaves=leaves, profile=weld, sensors=middle)
        found |= {"front_m": run.front_m, name: run.contact_force, f"{name}_girder": run.displacement[:, 0]}
    return found


def numbers(found: dict[str, np.ndarray]) -> dict[str, float]:
    """What the page quotes."""
    step_ms = 1e3 * float(np.diff(found["front_m"][:2])[0]) / SPEED_M_PER_S
    return {
        "load of a wheel, kN": 1e-3 * float(found["free"][0].mean()),
        "least force of the first wheel, kN": 1e-3 * float(found["free"][:, 0].min()),
        "the same held to the rail, kN": 1e-3 * float(found["held"][:, 0].min()),
        "time in the air, ms": step_ms * float((found["free"][:, 0] == 0.0).sum()),
        "largest force of the first wheel, kN": 1e-3 * float(found["free"][:, 0].max()),
        "the same held to the rail, largest, kN": 1e-3 * float(found["held"][:, 0].max()),
        "girder's deflection under the train, mm": 1e3 * float(found["free_girder"].max()),
    }


def picture(found: dict[str, np.ndarray]) -> Figure:
    """The first wheel's force about the weld, and the girder under the train."""
    figure, (left, right) = axes(2)
    left.plot(found["front_m"], 1e-3 * found["held"][:, 0], label="held to the rail", linewidth=0.9)
    left.plot(found["front_m"], 1e-3 * found["free"][:, 0], label="may leave it", linewidth=1.2)
    left.axhline(0.0, color="black", linewidth=0.6)
    left.set(xlim=(19.5, 22.5), xlabel="first wheel at, m", ylabel="force on the rail, kN")
    left.legend()
    right.plot(found["front_m"], 1e3 * found["free_girder"])
    right.set(xlabel="first wheel at, m", ylabel="middle of the second girder, mm down")
    return figure


if __name__ == "__main__":
    show(__file__, compute, numbers, picture)
