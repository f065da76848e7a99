"""A supported beam on dashpots that axles on springs pass over random unevenness, marched in time by modes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import passages
from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.load import Dataset
from permway.laws.toml import to_toml
from scipy import signal

GRAVITY = 9.80665
UNSPRUNG_KG, STIFFNESS, DAMPING, CONTACT = 1.5e3, 2.5e6, 1.0e5, 4.0e8
SUSPENSION = {
    "stiffness_N_per_m": STIFFNESS,
    "damping_Ns_per_m": DAMPING,
    "unsprung_kg": UNSPRUNG_KG,
    "contact_N_per_m": CONTACT,
}
LOAD_N = 1.35e4 * GRAVITY
DASHPOTS_M, DASHPOT = tuple(3.0 * i for i in range(1, 8)), 8.0e4
"""Viscous, so that marching and harmonic response have the same beam: N s/m each, 0.04 of the first mode."""

PER_FORCE = 2.0 / (passages.MASS_KG_PER_M * passages.LENGTH_M)
MODES, STEP_S, APPROACH_S = 6, 0.001, 1.5
LINE_HZ, HIGHEST_HZ, FINE_S = 0.1, 30.0, 0.0005
"""Of the waves; time at which they are tabulated, between which they are straight."""


def model() -> dict[str, Any]:
    """The table of the model file."""
    table = passages.model(0.0)
    table["line"]["laws"] = {"dashpot": {"type": "kelvin_voigt", "stiffness": 1.0, "damping": DASHPOT}}
    table["line"]["joints"] = [{"between": ["deck", "ground"], "law": "dashpot", "at": list(DASHPOTS_M)}]
    return table


def campaign(folder: Path, columns: dict[str, Reals], x_m: float, *, speed: float, **axles: Any) -> Campaign:
    """Of axles on springs; loads, speed and time of entry are parameters."""
    table = passages.campaign("".join(columns), high_Hz=10.0)
    for sensor in table["sensors"]:
        sensor["x_m"] = x_m
    known = ("V", "t0", "P0", "P1")[: 2 + len(axles["loads_N"])]
    table["parameters"] = [p for p in table["parameters"] if p["name"] in known]
    table["conditions"][0]["speed_m_per_s"] = speed
    table["conditions"][0]["axles"] |= {"suspension": SUSPENSION, **axles}
    path = passages.write(folder, columns, table=table)
    (folder / "model.toml").write_text(to_toml(model()), encoding="utf-8")
    return read_campaign(path)


def spectra(histories: Reals, dataset: Dataset) -> Complexes:
    """Of histories (..., samples), at the dataset's lines, faded as records are."""
    count = histories.shape[-1]
    lines = np.fft.rfft(histories * signal.windows.tukey(count, 0.1), axis=-1) / passages.RATE_HZ
    number = np.round(dataset.data["frequency"].values * count / passages.RATE_HZ).astype(int)
    return lines[..., number]


def modal() -> tuple[Reals, Reals]:
    """Squares of natural frequencies, (modes,), and the matrix of damping, 1/s."""
    n = np.arange(1, MODES + 1)
    square = (n * np.pi / passages.LENGTH_M) ** 4 * passages.BENDING_NM2 / passages.MASS_KG_PER_M
    at_dashpots = np.sin(np.pi * np.outer(DASHPOTS_M, n) / passages.LENGTH_M)
    return square, PER_FORCE * DASHPOT * at_dashpots.T @ at_dashpots


@dataclass(frozen=True)
class Trains:
    """So many trains of some axles, each over an unevenness of its own.

    Attributes
    ----------
    speed, entry_s : ndarray, shape (trains,)
    loads_N : ndarray, shape (trains, axles)
    lags_m : tuple of float
    """

    speed: Reals
    entry_s: Reals
    loads_N: Reals
    lags_m: tuple[float, ...]


HERTZ = LINE_HZ * np.arange(1, int(HIGHEST_HZ / LINE_HZ) + 1)


def drawn(trains: Trains, density: Callable[[Reals, float], Reals], random: np.random.Generator) -> Complexes:
    """Amplitudes of the waves that each train meets at :data:`HERTZ`, (trains, waves), m.

    Parameters
    ----------
    density : callable
        One-sided, from Hz and speed to m2/Hz.
    """
    normal = random.standard_normal((trains.speed.size, HERTZ.size, 2)) @ np.array([1.0, 1.0j])
    return normal * np.sqrt([density(HERTZ, speed) * LINE_HZ for speed in trains.speed.tolist()])


def under_axles(trains: Trains, waves: Complexes, times_s: Reals) -> Reals:
    """Unevenness under each axle, (trains, axles, times): real parts of waves that begin where the beam does."""
    fine = np.arange(round(1.0 / LINE_HZ / FINE_S)) * FINE_S
    found = np.empty((*trains.loads_N.shape, times_s.size))
    for number, speed in enumerate(trains.speed.tolist()):
        whole = np.zeros(fine.size // 2 + 1, dtype=np.complex128)
        whole[1 : HERTZ.size + 1] = 0.5 * fine.size * waves[number]
        profile = np.fft.irfft(whole, n=fine.size)
        for axle, lag in enumerate(trains.lags_m):
            since = times_s - trains.entry_s[number] - lag / speed
            found[number, axle] = np.interp(since, fine, profile, period=1.0 / LINE_HZ)
    return found


def marched(trains: Trains, waves: Complexes, x_m: float, *, static: bool = False) -> Reals:
    """Displacement and acceleration at a place at the times of a record, (2, trains, samples), SI.

    Runge and Kutta's fourth order. Before the beam axles run over the same unevenness on rigid ground.

    Parameters
    ----------
    trains : Trains
    waves : ndarray of complex128, shape (trains, waves)
        As of :func:`drawn`.
    x_m : float
    static : bool
        Whether loads push the beam, too.
    """
    n = np.arange(1, MODES + 1)
    square, damping = modal()
    count, axles = trains.loads_N.shape
    sprung, speed, lags = trains.loads_N / GRAVITY - UNSPRUNG_KG, trains.speed[:, None], np.array(trains.lags_m)
    time = passages.time_s()
    start, steps = -APPROACH_S, round((time[-1] + APPROACH_S) / STEP_S)
    uneven = under_axles(trains, waves, start + 0.5 * STEP_S * np.arange(2 * steps + 3))

    def rates(now: float, state: Reals) -> tuple[Reals, Reals]:
        """Rates of the state, and the modes' accelerations."""
        q, qd = state[:, :MODES], state[:, MODES : 2 * MODES]
        zs, vs, zu, vu = np.split(state[:, 2 * MODES :], 4, axis=1)
        at = speed * (now - trains.entry_s)[:, None] - lags
        on = (at >= 0.0) & (at <= passages.LENGTH_M)
        shape = np.sin(np.pi * at[:, :, None] * n / passages.LENGTH_M) * on[:, :, None]
        push = CONTACT * (zu - np.einsum("tan,tn->ta", shape, q) - uneven[:, :, round(2 * (now - start) / STEP_S)])
        whole = push + trains.loads_N if static else push
        spring = STIFFNESS * (zs - zu) + DAMPING * (vs - vu)
        qdd = PER_FORCE * np.einsum("tan,ta->tn", shape, whole) - qd @ damping - square * q
        return np.hstack([qd, qdd, vs, -spring / sprung, vu, (spring - push) / UNSPRUNG_KG]), qdd

    state = np.zeros((count, 2 * MODES + 4 * axles))
    every = round(1.0 / passages.RATE_HZ / STEP_S)
    place = np.sin(n * np.pi * x_m / passages.LENGTH_M)
    read = []
    for index in range(steps + 1):
        now = start + index * STEP_S
        one, qdd = rates(now, state)
        if now > -0.5 * STEP_S and round(now / STEP_S) % every == 0:
            read.append((state[:, :MODES] @ place, qdd @ place))
        two, _ = rates(now + 0.5 * STEP_S, state + 0.5 * STEP_S * one)
        three, _ = rates(now + 0.5 * STEP_S, state + 0.5 * STEP_S * two)
        four, _ = rates(now + STEP_S, state + STEP_S * three)
        state = state + STEP_S / 6.0 * (one + 2.0 * (two + three) + four)
    return np.moveaxis(np.array(read), 0, -1)
