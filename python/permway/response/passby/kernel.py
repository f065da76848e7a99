"""What a line answers in time to a force that rises and falls over two steps, between places of a path."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.fft import irfft

from permway.arrays import Reals
from permway.errors import InputError
from permway.model.line import Line
from permway.model.place import Place
from permway.response.passby.path import Path
from permway.response.passby.transfer import transfer
from permway.response.receptance import Formulation, Progress

LARGEST_KERNEL = 2**30
"""Bytes of kernels that one run keeps."""
_FINER = 4
"""Frequencies reach this many times the one that a step can show; there the triangle has no spectrum."""
_BLOCK = 2**23
"""Complex numbers of the transfer held at once."""


def kernels(
    line: Line,
    path: Path,
    sensors: Sequence[Place],
    *,
    step_s: float,
    steps: int,
    window_s: float,
    temperature_C: float | None,
    formulation: Formulation,
    threads: int | None,
    progress: Progress | None,
) -> tuple[Reals, Reals, float]:
    """Responses to a triangle of force, 1 N high and two steps long, at its middle and the steps that follow.

    A force that varies linearly between steps is a sum of such triangles, so no other error is made in time than
    that; and the triangle's spectrum falls as 1/f^2, which bounds the frequencies.

    Parameters
    ----------
    line : Line
    path : Path
    sensors : sequence of Place
    step_s : float
    steps : int
        Values kept.
    window_s : float
        Period T of the transform; what has not decayed in it wraps around.
    temperature_C, formulation, threads, progress
        As in :func:`permway.response.receptance.receptance`.

    Returns
    -------
    (ndarray, ndarray, float)
        Between nodes (reader, steps, source) and at sensors (sensor, steps, source), m/N; and the largest value
        left in the middle of the window, over the largest of all: what wraps around.

    Raises
    ------
    InputError
        For kernels larger than :data:`LARGEST_KERNEL`.
    """
    places = path.places()
    count = len(places)
    size = 8 * steps * count * (count + len(sensors))
    if size > LARGEST_KERNEL:
        raise InputError(
            f"the kernels of {count} places over {steps} steps would take {size / 2**30:.3g} GiB",
            where="step_s, from_m, to_m",
            remedy=f"at most {LARGEST_KERNEL / 2**30:g}: a longer step, a shorter stretch, or a lower order",
        )
    samples = int(np.ceil(window_s / step_s)) * _FINER
    frequency = np.arange(samples // 2 + 1) / (samples * step_s / _FINER)
    # Triangle of half width step_s about 0.
    spectrum = step_s * np.sinc(frequency * step_s) ** 2
    readers = [*places, *sensors]
    answer = np.empty((len(readers), steps, count))
    width = max(1, _BLOCK // (frequency.size * len(readers)))
    early = top = 0.0
    for first in range(0, count, width):
        block = places[first : first + width]
        # By reciprocity the solver's forces are the sources here, its sensors the readers.
        values = transfer(
            line,
            frequency,
            sensors=block,
            places=readers,
            temperature_C=temperature_C,
            formulation=formulation,
            threads=threads,
            progress=_still(progress, first, count),
        )
        values *= spectrum[:, None, None]
        history = irfft(values, n=samples, axis=0)[::_FINER] * (_FINER / step_s)
        # Causal, and with the real part of the receptance: what stands before the force is put behind it. Only
        # laws of constant loss have any; without it they would lose some of their flexibility at rest.
        causal = history[:steps].copy()
        causal[1:] += history[:-steps:-1]
        answer[:, :, first : first + len(block)] = causal.transpose(2, 0, 1)
        half, apart = history.shape[0] // 2, max(1, history.shape[0] // 40)
        before = history[half - apart : half + apart]
        early, top = max(early, float(np.abs(before).max())), max(top, float(np.abs(history).max()))
        if progress is not None:
            progress(first + len(block), count)
    return answer[:count], answer[count:], early / top if top > 0.0 else 0.0


def _still(progress: Progress | None, done: int, total: int) -> Progress | None:
    """Progress that stands while a block is solved, but may stop it."""
    return None if progress is None else lambda *_: progress(done, total)
