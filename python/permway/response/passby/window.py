"""Frequencies and times of a passage: a window that is periodic, and a check of what wraps around in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len

from permway.arrays import Complexes, Reals

FLAT = 0.8
"""Share of the computed band that is kept whole; above it a half cosine takes spectra to zero."""
_LEAD = 0.1
_SHORTEST_LEAD_S = 0.1


@dataclass(frozen=True)
class Window:
    """A window of time and its lines of frequency.

    Attributes
    ----------
    length_s : float
        Period T.
    lead_s : float
        Time before the first wheel enters, in which nothing should move.
    leave_s : float
        When the last wheel leaves.
    lines : int
        Frequencies 0, 1/T, ..., (lines - 1)/T.
    """

    length_s: float
    lead_s: float
    leave_s: float
    lines: int

    @property
    def step_Hz(self) -> float:
        """1/T."""
        return 1.0 / self.length_s

    @property
    def frequency(self) -> Reals:
        """Hz, from 0."""
        return np.asarray(np.arange(self.lines) * self.step_Hz, dtype=np.float64)

    @property
    def samples(self) -> int:
        """Number of times: four times the lines and a little more, twice what they need, for smooth curves."""
        return int(next_fast_len(4 * self.lines, real=True))

    @property
    def time(self) -> Reals:
        """Seconds; 0 when the first wheel enters."""
        return np.asarray(np.arange(self.samples) * (self.length_s / self.samples) - self.lead_s, dtype=np.float64)

    def low_pass(self) -> Reals:
        """1 up to :data:`FLAT` of the band, then half a cosine to 0."""
        share = np.arange(self.lines) / max(self.lines - 1, 1)
        return np.asarray(0.5 * (1.0 + np.cos(np.pi * np.clip((share - FLAT) / (1.0 - FLAT), 0.0, 1.0))))

    def history(self, spectrum: Complexes) -> Reals:
        """Time history of a one-sided transform of shape (..., lines)."""
        whole = np.zeros((*spectrum.shape[:-1], self.samples // 2 + 1), dtype=np.complex128)
        whole[..., : self.lines] = spectrum
        return np.asarray(irfft(whole, n=self.samples, axis=-1) * (self.samples / self.length_s))

    def seam_level(self, history: Reals) -> float:
        """Largest value about the seam of the window, over the largest of all: what wraps around.

        The seam is the first quarter of the time before entry, and as much at the end.
        """
        quarter = 0.25 * self.lead_s
        since = self.time + self.lead_s
        return _share(history, (since < quarter) | (since > self.length_s - quarter))

    def level_before(self, history: Reals) -> float:
        """Largest value before the first wheel enters, over the largest of all.

        More than the seam's if the line answers before it is asked, as laws of constant loss do.
        """
        return _share(history, self.time < 0.0)

    def longer(self, history: Reals, limit: float) -> float:
        """Length that would hold the level, judged by how the free vibration after the passage decays."""
        after = np.abs(history[..., self.time > self.leave_s - self.lead_s])
        free = self.length_s - self.leave_s
        parts = np.array_split(after, 2, axis=-1)
        early, late = (float(part.max()) for part in parts)
        level = self.seam_level(history)
        rate = np.log(early / late) / (0.5 * free) if early > late > 0.0 else 0.0
        needed = np.log(2.0 * level / limit) / rate if rate > 0.0 else np.inf
        return float(self.length_s + min(max(needed, 0.5 * self.length_s), 7.0 * self.length_s))


def window_of(passage_s: float, highest_Hz: float, length_s: float | None) -> Window:
    """A window of a given length, or half as long again as the passage, and a second more.

    Parameters
    ----------
    passage_s : float
        From the first wheel's entry to the last one's leaving.
    highest_Hz : float
        Kept whole up to here.
    length_s : float, optional
    """
    length = 1.5 * passage_s + 1.0 if length_s is None else length_s
    lead = min(max(_LEAD * length, _SHORTEST_LEAD_S), 0.2 * max(length - passage_s, 0.0))
    lines = int(np.ceil(highest_Hz / FLAT * length)) + 1
    return Window(length_s=length, lead_s=lead, leave_s=lead + passage_s, lines=lines)


def _share(history: Reals, part: NDArray[np.bool_]) -> float:
    top = np.abs(history).max(axis=-1)
    chosen = np.abs(history[..., part]).max(axis=-1, initial=0.0)
    return float(np.max(np.divide(chosen, top, out=np.zeros_like(top), where=top > 0.0)))
