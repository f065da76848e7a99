"""Vehicles coupled to the line in time: each wheel sees how the line differs from place to place.

u_w(t) = sum_w' integral h(x_w(t), x_w'(t'), t - t') F_w'(t') dt' with forces linear between steps and h by its
kernels between the nodes of the path; F_w = k (z_w - u_w - r_w) with a linear contact spring; z from the vehicle's
own equations. All wheels are solved together at each step, so nothing lags.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy.fft import irfft, next_fast_len, rfft

from permway import _core
from permway.arrays import Reals, is_real, real_numbers
from permway.errors import InputError
from permway.model.irregularity_spectra import check_speed
from permway.model.line import Line
from permway.model.place import Place
from permway.response.passby.kernel import kernels
from permway.response.passby.path import Path, path_of
from permway.response.passby.sprung import AnyVehicle, Stepper, stepper
from permway.response.receptance import CONVENTION, Formulation, Progress, check_places

_MOST_STEPS = 200_000
_OFTEN = 16
"""Steps between two calls of progress."""


def couple(
    line: Line,
    vehicle: AnyVehicle,
    *,
    speed_m_per_s: float,
    contact_N_per_m: float,
    step_s: float,
    sensors: Sequence[Place] = (),
    body: str = "rail",
    profile: tuple[ArrayLike, ArrayLike] | None = None,
    from_m: float | None = None,
    to_m: float | None = None,
    ramp_m: float | None = None,
    after_s: float = 0.0,
    window_s: float | None = None,
    order: int = 4,
    wraparound_limit: float = 0.02,
    temperature_C: float | None = None,
    formulation: Formulation = "chain",
    threads: int | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """March a vehicle over a line.

    Before and behind the stretch wheels run on rigid ground; over its ramps the line yields gradually.

    Parameters
    ----------
    line : Line
    vehicle : Vehicle, SprungMass or MassOnSpring
    speed_m_per_s : float
    contact_N_per_m : float
        Contact spring under each wheelset of the model; of a `MassOnSpring` its suspension.
    step_s : float
        Time step. Wheels on their contact springs set its upper limit.
    sensors : sequence of Place
        Further places whose displacement is wanted.
    body : str
        What the wheels run on.
    profile : (x_m, height_m), optional
        Running surface, positive down, straight between points and 0 outside.
    from_m, to_m, ramp_m, order, temperature_C, formulation, threads, progress
        As in :func:`permway.response.passby.run.passby`.
    after_s : float
        Time to go on after the last wheel has left.
    window_s : float, optional
        Period of the kernels' transform; by default four times the run. A line with little loss needs more.
    wraparound_limit : float
        Largest value allowed in a kernel after half the window, over the largest of all.

    Returns
    -------
    xarray.Dataset
        Over `time` (0 when the first wheel enters): `wheel_x` (m), `contact_force` (total, N),
        `line_displacement` under the wheels (m), each (wheel, time); `vehicle_displacement` (degree, time), from
        unstrained springs; `displacement` (sensor, time).

    Raises
    ------
    InputError
        For inputs that do not fit, kernels too large, and a window in which they wrap around.
    SolveError
        As the solver.
    """
    speed = check_speed(speed_m_per_s)
    _check(vehicle, contact_N_per_m, step_s, after_s, window_s, order)
    check_places(line, sensors, "sensors")
    path = path_of(
        line,
        body,
        from_m=from_m,
        to_m=to_m,
        ramp_m=ramp_m,
        highest_Hz=0.25 / step_s,
        order=order,
        kinks_m=tuple(s.x_m for s in sensors),
    )
    lags = vehicle.lags_m()
    run = (path.stop - path.start + float(lags[-1])) / speed + after_s
    steps = int(np.ceil(run / step_s)) + 1
    if not 2 <= steps <= _MOST_STEPS:
        raise InputError(
            f"{run:.3g} s take {steps} steps, 2 to {_MOST_STEPS} are allowed", where="step_s", value=step_s
        )
    length = 4.0 * run if window_s is None else window_s
    if length < 2.0 * run:
        raise InputError(
            f"is shorter than twice the run of {run:.3g} s",
            where="window_s",
            value=window_s,
            remedy="lengthen it, or leave it out",
        )
    time = step_s * np.arange(steps)
    x = path.start + speed * time[None, :] - lags[:, None]
    surface = _surface(profile, x)
    parts = stepper(vehicle, contact_N_per_m, step_s)
    between, to_sensors, level = kernels(
        line,
        path,
        sensors,
        step_s=step_s,
        steps=steps,
        window_s=length,
        temperature_C=temperature_C,
        formulation=formulation,
        threads=threads,
        progress=progress,
    )
    if level > wraparound_limit:
        raise InputError(
            f"the line's answer wraps around in {length:.3g} s: {level:.2g} of its largest value is left after "
            f"half of that, more than {wraparound_limit:g}",
            where="window_s",
            value=window_s,
            remedy=f"give about {2.0 * length:.3g} s, or more loss",
        )
    force, under, state, nodal = _march(path, between, x, surface, parts, contact_N_per_m, progress)
    degrees = vehicle.degrees
    data = xr.Dataset(
        coords={
            "time": ("time", time, {"long_name": "time from the first wheel's entry", "units": "s"}),
            "wheel": [f"wheel{i + 1}" for i in range(lags.size)],
            "degree": degrees,
        },
        attrs={
            "convention": f"{CONVENTION}; contact force positive in compression",
            "permway_version": _core.__version__,
            "formulation": formulation,
            "speed_m_per_s": speed,
            "contact_N_per_m": contact_N_per_m,
            "step_s": step_s,
            "path_m": [path.start, path.stop],
            "ramp_m": list(path.ramp_m),
            "window_s": length,
            "wraparound_level": level,
            "kernel_bytes": int(between.nbytes + to_sensors.nbytes),
        },
    )
    data["wheel_x"] = (("wheel", "time"), x, {"long_name": "place of the wheel", "units": "m"})
    data["contact_force"] = (("wheel", "time"), force, {"long_name": "contact force", "units": "N"})
    data["line_displacement"] = (("wheel", "time"), under, {"long_name": "line under the wheel", "units": "m"})
    data["vehicle_displacement"] = (
        ("degree", "time"),
        state[:, : len(degrees)].T,
        {"long_name": "vehicle", "units": "m", "comment": "pitch in rad; from unstrained springs"},
    )
    if sensors:
        padded = int(next_fast_len(2 * steps, real=True))
        product = (rfft(to_sensors, padded, axis=1) * rfft(nodal, padded, axis=0)).sum(axis=2)
        imposed = irfft(product, padded, axis=1)[:, :steps]
        data.coords["sensor"] = [s.label for s in sensors]
        data.coords["sensor_x"] = ("sensor", [s.x_m for s in sensors], {"units": "m"})
        data["displacement"] = (("sensor", "time"), imposed, {"long_name": "displacement", "units": "m"})
    return data


def _march(
    path: Path,
    between: Reals,
    x: Reals,
    surface: Reals,
    parts: Stepper,
    contact: float,
    progress: Progress | None,
) -> tuple[Reals, Reals, Reals, Reals]:
    """Forces and displacements (wheels, steps), states (steps, 2 n) and forces on the nodes (steps, nodes)."""
    wheels, steps = x.shape
    nodes, order = between.shape[0], path.order
    panel, weights = path.interpolation(x.ravel())
    first = (panel * order).reshape(wheels, steps)
    weights = weights.reshape(wheels, steps, order)
    # Latest first, so that history and kernel lie alike and one product does a step.
    latest_first = np.zeros((steps, nodes))
    force, under = np.zeros((wheels, steps)), np.zeros((wheels, steps))
    state = np.zeros((steps, parts.rest.size))
    state[0] = parts.rest
    force[:, 0] = contact * (parts.rest[parts.wheels] - surface[:, 0])
    loose = np.eye(wheels) / contact + np.zeros((wheels, wheels)) - parts.after[parts.wheels]
    for n in range(steps):
        rows = [slice(first[w, n], first[w, n] + order) for w in range(wheels)]
        past = latest_first[steps - n :]
        own = np.zeros((wheels, wheels))
        imposed = np.zeros(wheels)
        for w in range(wheels):
            if not weights[w, n].any():
                continue
            if n:
                imposed[w] = weights[w, n] @ (between[rows[w], 1 : n + 1].reshape(order, -1) @ past.ravel())
            own[w] = [weights[w, n] @ between[rows[w], 0, rows[v]] @ weights[v, n] for v in range(wheels)]
        if n:
            free = parts.state @ state[n - 1] + parts.weight + parts.before @ force[:, n - 1]
            force[:, n] = np.linalg.solve(loose + own, free[parts.wheels] - imposed - surface[:, n])
            state[n] = free + parts.after @ force[:, n]
        under[:, n] = imposed + own @ force[:, n]
        for w in range(wheels):
            latest_first[steps - 1 - n, rows[w]] += weights[w, n] * force[w, n]
        if progress is not None and n % _OFTEN == 0:
            progress(n, steps)
    return force, under, state, latest_first[::-1]


def _surface(profile: tuple[ArrayLike, ArrayLike] | None, x: Reals) -> Reals:
    if profile is None:
        return np.zeros_like(x)
    places, height = (real_numbers(part, "profile") for part in profile)
    if places.ndim != 1 or places.shape != height.shape or places.size < 2:
        raise InputError("must be two lists of the same length, two points or more", where="profile")
    if not (np.isfinite(places).all() and np.isfinite(height).all() and (np.diff(places) > 0.0).all()):
        raise InputError("places must ascend, and all be finite", where="profile")
    return np.asarray(np.interp(x, places, height, left=0.0, right=0.0))


def _check(
    vehicle: object, contact: float, step_s: float, after_s: float, window_s: float | None, order: int
) -> None:
    if not isinstance(vehicle, AnyVehicle):
        raise InputError("must be a Vehicle, SprungMass or MassOnSpring", where="vehicle", value=vehicle)
    for name, value, least in (
        ("contact_N_per_m", contact, "above"),
        ("step_s", step_s, "above"),
        ("after_s", after_s, "from"),
        ("window_s", window_s, "above"),
    ):
        if value is None:
            continue
        number = is_real(value) and np.isfinite(value)
        if not number or value < 0.0 or (value == 0.0 and least == "above"):
            raise InputError(f"must be a number {least} 0", where=name, value=value)
    if isinstance(order, bool) or not isinstance(order, int) or not 3 <= order <= 16:
        raise InputError("must be a whole number from 3 to 16", where="order", value=order)
