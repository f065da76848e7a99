"""The response at fixed sensors to a passing train: histories, spectra, one-third octaves."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import get_args

import numpy as np
import xarray as xr

from permway import _core
from permway.arrays import Complexes, is_real
from permway.errors import InputError
from permway.model.irregularity import AnyIrregularity
from permway.model.line import Line
from permway.model.passby import Quantity
from permway.model.place import Place
from permway.model.train import Train
from permway.response.limits import check_answer
from permway.response.passby.carry import arrivals, carried, harmonic_moments, sampled_moments
from permway.response.passby.dataset import labelled
from permway.response.passby.loads import Axles, static_axles
from permway.response.passby.path import Path, path_of
from permway.response.passby.rough import Realisation, realise
from permway.response.passby.transfer import STATIC_SHARE, transfer
from permway.response.passby.window import FLAT, Window, window_of
from permway.response.receptance import CONVENTION, Formulation, Progress, check_places

_TRIALS = 4
_CHUNK = 2**22
"""Complex numbers of the transfer held at once."""
_MOST_LINES = 2_000_000


def passby(
    line: Line,
    train: Train | Axles,
    *,
    sensors: Sequence[Place],
    highest_Hz: float,
    window_s: float | None = None,
    quantity: Quantity = "velocity",
    irregularity: AnyIrregularity | None = None,
    seed: int | None = None,
    from_m: float | None = None,
    to_m: float | None = None,
    ramp_m: float | None = None,
    order: int = 6,
    averaging_s: float | None = None,
    wraparound_limit: float = 0.02,
    temperature_C: float | None = None,
    formulation: Formulation = "chain",
    threads: int | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Response at fixed sensors while a train runs from one end of a stretch to the other.

    The static loads move (quasi-static part); with an irregularity also one realisation of the random
    wheel-rail forces (dynamic part). See :mod:`permway.response.passby.carry` for the equation.

    Parameters
    ----------
    line : Line
    train : Train or Axles
        A train has its wheelsets' weights, of the share that the model carries; where it stands (`centre_m`)
        serves the random forces only.
    sensors : sequence of Place
    highest_Hz : float
        Kept whole up to here; a half cosine takes the spectra to zero at 1.25 times that.
    window_s : float, optional
        Period T of the time histories, 1 / T the step of the frequencies. Left out, as long as needed.
    quantity : "displacement", "velocity" or "acceleration"
    irregularity : irregularity, optional
        Needs a `Train`, and a `seed`.
    seed : int, optional
    from_m, to_m : float, optional
        Where wheels run; by default the ends of their body, or its first and last joint.
    ramp_m : float, optional
        Over which forces come on and go off at both ends; by default none at a pinned end, elsewhere a tenth of
        the stretch and at most 10 m.
    order : int
        Polynomials of x between two supports.
    averaging_s : float, optional
        Time that band levels are a mean of; by default from the first to the last axle at one place, and for one
        axle its time on the stretch.
    wraparound_limit : float
        Largest response allowed at the seam of the window, over the largest of all.
    temperature_C, formulation, threads, progress
        As in :func:`permway.response.receptance.receptance`.

    Returns
    -------
    xarray.Dataset
        `history` (part, sensor, time), `spectrum` (part, sensor, frequency; its transform, complex, per Hz),
        `energy` (the one-sided density 2 |spectrum|^2), `band_rms` and `band_level` (part, sensor, band; root
        mean square over `averaging_s`, and dB re ISO 1683), with an irregularity `wheel_force` (wheel, time).
        Time 0 is when the first wheel enters.

    Raises
    ------
    InputError
        For inputs that do not fit, a window in which the response wraps around, and a line that is not held.
    SolveError
        As the solver.
    """
    _check(train, irregularity, seed, quantity, highest_Hz, window_s, order, averaging_s, wraparound_limit)
    axles = train if isinstance(train, Axles) else static_axles(train)
    check_places(line, sensors, "sensors")
    if not sensors:
        raise InputError("none given", where="sensors", remedy="say where the response is wanted")
    top = highest_Hz / FLAT
    path = path_of(
        line,
        axles.body,
        from_m=from_m,
        to_m=to_m,
        ramp_m=ramp_m,
        highest_Hz=top,
        order=order,
        kinks_m=tuple(s.x_m for s in sensors),
    )
    passage = (path.stop - path.start + axles.lags_m[-1]) / axles.speed_m_per_s
    if window_s is not None and window_s <= passage:
        raise InputError(
            f"is shorter than the passage of {passage:.3g} s",
            where="window_s",
            value=window_s,
            remedy=f"give it more than {1.1 * passage:.3g}, or leave it out",
        )
    length = window_s
    for trial in range(_TRIALS):
        window = window_of(passage, highest_Hz, length)
        _check_size(window, len(sensors))
        record = None
        if irregularity is not None:
            assert isinstance(train, Train)
            assert seed is not None
            record = realise(
                line,
                train,
                irregularity,
                length_s=window.length_s,
                start_s=0.0,
                highest_Hz=top,
                seed=seed,
                temperature_C=temperature_C,
                formulation=formulation,
                threads=threads,
                progress=progress,
            )
        spectra, error = _spectra(
            line, axles, path, window, record, sensors, temperature_C, formulation, threads, progress
        )
        spectra *= (2j * np.pi * window.frequency) ** get_args(Quantity).index(quantity) * window.low_pass()
        history = window.history(spectra)
        level = window.seam_level(history[-1])
        if level <= wraparound_limit:
            break
        longer = window.longer(history[-1], wraparound_limit)
        if window_s is not None or trial == _TRIALS - 1:
            raise InputError(
                f"the response wraps around in {window.length_s:.3g} s: {level:.2g} of its largest value is left "
                f"at the seam, more than {wraparound_limit:g}",
                where="window_s",
                value=window_s,
                remedy=f"give about {longer:.3g} s, or a larger wraparound_limit",
            )
        length = longer
    averaged = averaging_s or (axles.lags_m[-1] / axles.speed_m_per_s or passage)
    data = labelled(spectra, history, window, record, sensors, quantity, averaged)
    data.attrs = {
        "convention": f"{CONVENTION}; transform integral x(t) exp(-i omega t) dt; energy one-sided",
        "permway_version": _core.__version__,
        "formulation": formulation,
        "speed_m_per_s": axles.speed_m_per_s,
        "path_m": [path.start, path.stop],
        "ramp_m": list(path.ramp_m),
        "window_s": window.length_s,
        "wraparound_level": level,
        "wraparound_limit": wraparound_limit,
        "level_before_entry": window.level_before(history[-1]),
        "highest_Hz": float(highest_Hz),
        "low_pass": f"whole up to {highest_Hz:g} Hz, half a cosine to 0 at {top:g} Hz",
        "quadrature": f"{path.order} Legendre polynomials on each of {path.half.size} panels, closed integrals",
        "quadrature_error": error,
        "zero_Hz": f"real part at {STATIC_SHARE * window.step_Hz:.3g} Hz",
        "averaging_s": averaged,
    }
    if temperature_C is not None:
        data.attrs["temperature_C"] = temperature_C
    if record is not None:
        data.attrs |= {"seed": int(seed or 0), "force_band_Hz": list(record.band_Hz)}
    return data


def _spectra(
    line: Line,
    axles: Axles,
    path: Path,
    window: Window,
    record: Realisation | None,
    sensors: Sequence[Place],
    temperature_C: float | None,
    formulation: Formulation,
    threads: int | None,
    progress: Progress | None,
) -> tuple[Complexes, float]:
    """Displacement spectra (parts, sensors, lines), and the share of the last two polynomials in them."""
    frequency, speed = window.frequency, axles.speed_m_per_s
    # When each wheel would be at x = 0, on a clock that starts with the window.
    entry = window.lead_s + (axles.lags - path.start) / speed
    parts = 1 if record is None else 3
    answer = np.zeros((parts, len(sensors), window.lines), dtype=np.complex128)
    tail = np.zeros((len(sensors), window.lines), dtype=np.complex128)
    places = path.places()
    courses = [] if record is None else record.courses()
    step = max(1, _CHUNK // (len(places) * len(sensors)))
    for first in range(0, window.lines, step):
        chunk = slice(first, min(first + step, window.lines))
        values = transfer(
            line,
            frequency[chunk],
            sensors=sensors,
            places=places,
            temperature_C=temperature_C,
            formulation=formulation,
            threads=threads,
            progress=_offset(progress, first, window.lines),
        )
        coefficients = path.coefficients(values)
        omega = 2.0 * np.pi * frequency[chunk]
        moments = harmonic_moments(path, omega, speed) * arrivals(omega, axles.loads, entry)[:, None, None]
        spectrum, last = carried(coefficients, moments)
        answer[0][:, chunk], tail[:, chunk] = spectrum.T, last.T
        if record is not None:
            forces = 2.0 * np.pi * record.band_Hz[1]
            moving = sampled_moments(path, omega, speed, courses, entry, forces)
            spectrum, last = carried(coefficients, moving)
            answer[1][:, chunk] = spectrum.T
            tail[:, chunk] += last.T
    if record is not None:
        answer[2] = answer[0] + answer[1]
    return answer, float(np.abs(tail).max() / max(float(np.abs(answer[-1]).max()), np.finfo(float).tiny))


def _check(
    train: object,
    irregularity: object,
    seed: int | None,
    quantity: str,
    highest_Hz: float,
    window_s: float | None,
    order: int,
    averaging_s: float | None,
    wraparound_limit: float,
) -> None:
    if not isinstance(train, Train | Axles):
        raise InputError(f"must be a Train or Axles, not a {type(train).__name__}", where="train")
    if irregularity is not None and not isinstance(train, Train):
        raise InputError("needs a Train: Axles have no vehicle to be shaken", where="irregularity")
    if (irregularity is None) != (seed is None):
        raise InputError(
            "an irregularity and a seed go together", where="seed", value=seed, remedy="give both or neither"
        )
    if quantity not in get_args(Quantity):
        raise InputError(
            "unknown", where="quantity", value=quantity, remedy=f"use one of {list(get_args(Quantity))}"
        )
    for name, value in (
        ("highest_Hz", highest_Hz),
        ("window_s", window_s),
        ("averaging_s", averaging_s),
        ("wraparound_limit", wraparound_limit),
    ):
        if value is None:
            continue
        number = is_real(value)
        if not number or not (np.isfinite(value) and value > 0.0):
            raise InputError("must be a number above 0", where=name, value=value)
    if isinstance(order, bool) or not isinstance(order, int) or not 3 <= order <= 16:
        raise InputError("must be a whole number from 3 to 16", where="order", value=order)
    if wraparound_limit > 0.5:
        warnings.warn(
            f"wraparound_limit = {wraparound_limit:g}: half the response may lie where it does not belong",
            stacklevel=3,
        )


def _check_size(window: Window, sensors: int) -> None:
    if window.lines > _MOST_LINES:
        raise InputError(
            f"{window.length_s:.3g} s need {window.lines} frequencies, more than {_MOST_LINES}",
            where="highest_Hz, window_s",
            remedy="lower highest_Hz or shorten the window",
        )
    check_answer(window.lines, 5, sensors)


def _offset(progress: Progress | None, first: int, total: int) -> Progress | None:
    if progress is None:
        return None
    return lambda done, _: progress(first + done, total)
