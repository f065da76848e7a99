"""Faults of sensors in records of finite elements."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from permway.challenge.beams import Complexes, Reals
from permway.challenge.small.concealed import Concealed, displaced
from permway.challenge.small.draws import log_between
from permway.challenge.small.elements_line import Line

FAMILIES = {
    "sensor_gain": "level",
    "sensor_polarity": "level",
    "sensor_delay": "sensor dynamics",
    "sensor_mounting": "sensor dynamics",
    "noise_floor": "noise",
}


def fault(random: np.random.Generator, name: str, sensor: str, top_Hz: float) -> Concealed:
    """A fault of a sensor by its entry in the catalogue.

    Parameters
    ----------
    random : Generator
    name : str
        One of :data:`FAMILIES`.
    sensor : str
    top_Hz : float
        Highest line.
    """
    values, size, none = _drawn(random, name, top_Hz)

    def at(share: float) -> dict[str, float]:
        return {**values, size: displaced(values[size], none, share)} if size else dict(values)

    def change(line: Line, share: float) -> Line:
        before, now = line.chains.get(sensor), _TRANSFER[name](at(share))
        line.chains[sensor] = now if before is None else lambda f: np.asarray(before(f) * now(f))
        return line

    def noise(share: float) -> dict[str, float]:
        return {sensor: at(share)["noise_ratio"]} if name == "noise_floor" else {}

    return Concealed(
        id=name,
        kind=f"elements: {name}",
        family=FAMILIES[name],
        domain="measurement",
        change=change,
        parameters=at,
        place=lambda _: {"channels": [sensor]},
        scales=bool(size),
        mechanical=f"{name} of {sensor}",
        noise=noise,
    )


def _drawn(random: np.random.Generator, name: str, top_Hz: float) -> tuple[dict[str, float], str, float]:
    up = random.random() < 0.5
    match name:
        case "sensor_gain":
            gain = log_between(random, 1.5, 3.0)
            return {"gain": gain if up else 1.0 / gain}, "gain", 1.0
        case "sensor_polarity":
            return {"sign": -1.0}, "", 0.0
        case "sensor_delay":
            delay = log_between(random, 1e-3, 4e-3)
            return {"delay_s": delay if up else -delay}, "delay_s", 0.0
        case "sensor_mounting":
            mount = log_between(random, 0.8 * top_Hz, 3.0 * top_Hz)
            return {"mount_Hz": mount, "loss_factor": log_between(random, 0.03, 0.3)}, "mount_Hz", float("inf")
        case _:
            return {"noise_ratio": log_between(random, 6.0, 100.0)}, "noise_ratio", 1.0


def _mounted(at: Mapping[str, float]) -> Callable[[Reals], Complexes]:
    spring = 1.0 + 1j * at["loss_factor"]
    return lambda f: np.asarray(spring / (spring - (f / at["mount_Hz"]) ** 2))


_TRANSFER: dict[str, Callable[[Mapping[str, float]], Callable[[Reals], Complexes]]] = {
    "sensor_gain": lambda at: lambda f: np.full(f.shape, at["gain"] + 0j),
    "sensor_polarity": lambda at: lambda f: np.full(f.shape, -1.0 + 0j),
    "sensor_delay": lambda at: lambda f: np.asarray(np.exp(-2j * np.pi * f * at["delay_s"])),
    "sensor_mounting": _mounted,
    "noise_floor": lambda at: lambda f: np.ones(f.shape, complex),
}
