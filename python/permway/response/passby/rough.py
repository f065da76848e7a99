"""Random wheel-rail forces: seeded realisations of what train_response gives as densities."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.fft import irfft, next_fast_len
from scipy.interpolate import make_interp_spline

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.model.irregularity import AnyIrregularity
from permway.model.line import Line
from permway.model.train import Train
from permway.response.passby.carry import Course
from permway.response.receptance import Formulation, Progress
from permway.response.train import train_response

_FINER = 8
"""Samples of the spline a shortest period, over the two that are needed."""

_BEYOND = 16


@dataclass(frozen=True)
class Realisation:
    """Forces of all wheels over one stretch of irregularity.

    Attributes
    ----------
    amplitude : ndarray, shape (lines, wheels)
        Complex amplitudes at the lines 0, 1/T, ..., N.
    length_s : float
        Period T.
    band_Hz : (float, float)
        Lowest and highest frequency in it.
    start_s : float
        Time of the clock at which the record begins.
    """

    amplitude: Complexes
    length_s: float
    band_Hz: tuple[float, float]
    start_s: float

    def samples(self) -> tuple[Reals, Reals]:
        """Times (s) over one period, and forces (wheels, times) in N."""
        count = int(next_fast_len(2 * _FINER * self.amplitude.shape[0], real=True))
        whole = np.zeros((count // 2 + 1, self.amplitude.shape[1]), dtype=np.complex128)
        whole[: self.amplitude.shape[0]] = 0.5 * count * self.amplitude
        time = self.start_s + self.length_s / count * np.arange(count, dtype=np.float64)
        return np.asarray(time, dtype=np.float64), irfft(whole, n=count, axis=0).T

    def courses(self) -> list[Course]:
        """Force of each wheel over the clock's time."""
        time, force = self.samples()
        # The record is periodic: a little of it on either side keeps the spline's ends away.
        beyond = self.length_s / time.size * np.arange(1, _BEYOND + 1)
        time = np.concatenate([time[0] - beyond[::-1], time, time[-1] + beyond])
        courses: list[Course] = []
        for row in force:
            courses.append(make_interp_spline(time, np.pad(row, _BEYOND, mode="wrap"), k=5))
        return courses


def realise(
    line: Line,
    train: Train,
    irregularity: AnyIrregularity,
    *,
    length_s: float,
    start_s: float,
    highest_Hz: float,
    seed: int,
    temperature_C: float | None = None,
    formulation: Formulation = "chain",
    threads: int | None = None,
    progress: Progress | None = None,
) -> Realisation:
    """Draw the forces of all wheels: one irregularity under all of them, the later ones later.

    F_w(t) = Re sum_k sqrt(2 / T) P_w(f_k) xi_k exp(i omega_k t), with P of
    :func:`permway.response.train.train_response` where the train stands (N/sqrt(Hz), the lags in its phase) and
    xi_k complex normal numbers of mean square 1. Its mean square is the integral of the density.

    Parameters
    ----------
    line, train, irregularity, temperature_C, formulation, threads, progress
        As in `train_response`.
    length_s : float
        Period T of the record.
    start_s : float
        Where it begins on the clock.
    highest_Hz : float
        No force above; none either at wavelengths that the irregularity's source does not cover.
    seed : int
        The same seed gives the same record.

    Raises
    ------
    InputError
        For a seed that is no whole number from 0 on, and a band in which the irregularity has nothing.
    """
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise InputError("must be a whole number from 0 on", where="seed", value=seed)
    shortest, longest = irregularity.valid_wavelength_m
    frequency = np.arange(1, int(np.floor(highest_Hz * length_s * (1.0 + 1e-12))) + 1) / length_s
    slack = 1e-9
    kept = (frequency >= train.speed_m_per_s / longest * (1.0 + slack)) & (
        frequency <= train.speed_m_per_s / shortest * (1.0 - slack)
    )
    if not kept.any():
        raise InputError(
            f"covers wavelengths from {shortest:g} to {longest:g} m, none of them between "
            f"{1.0 / length_s:.3g} and {highest_Hz:g} Hz",
            where="irregularity",
            remedy="raise highest_Hz, or take an irregularity with longer waves",
        )
    lines = frequency[kept]
    data = train_response(
        line,
        train,
        irregularity,
        lines,
        temperature_C=temperature_C,
        formulation=formulation,
        threads=threads,
        progress=progress,
    )
    generator = np.random.default_rng(seed)
    draws = generator.standard_normal((frequency.size, 2)) @ np.array([1.0, 1j]) / np.sqrt(2.0)
    amplitude = np.zeros((frequency.size + 1, len(train.wheels())), dtype=np.complex128)
    force = data["wheel_rail_force"].values
    amplitude[1:][kept] = np.sqrt(2.0 / length_s) * force * draws[kept][:, None]
    return Realisation(
        amplitude=amplitude, length_s=length_s, band_Hz=(float(lines[0]), float(lines[-1])), start_s=start_s
    )
