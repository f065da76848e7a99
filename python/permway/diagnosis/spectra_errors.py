"""What errors of chains, and of an irregularity's level, do to parts of cross spectra.

An error need not be the same all over what Hann's window takes in about a line. To first order it then acts on a
spectrum by its value at the line, and by its growth there on the spectrum times the distance from the line
(:func:`permway.campaign.predict.away_from_lines`). Of what one channel does not share with another that comes
late, the second is most: a phase that grows with frequency makes it come later, and share less.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from permway.arrays import Complexes, Reals
from permway.diagnosis.gaussian_process import GaussianProcess
from permway.diagnosis.spectra_parts import Part, remainder, transfer

SMALL = 1e-4
"""Neper, of the errors by which answers to them are found."""


@dataclass(frozen=True)
class Moved:
    """Spectra that a model expects, and what of them errors act on.

    Attributes
    ----------
    parts : tuple of Part
    model : ndarray of complex128, shape (channels, channels, F)
    added : ndarray of complex128, shape (channels, channels, F)
        Noise and hum, on which errors do not act.
    away : ndarray of complex128, shape (channels, channels, F)
        What moves, times the distance from the line, in lines.
    """

    parts: tuple[Part, ...]
    model: Complexes
    added: Complexes
    away: Complexes

    def answers(self, value: Complexes, rate: Complexes) -> list[Complexes]:
        """Growth of each part's logarithm with that of errors.

        Parameters
        ----------
        value, rate : ndarray of complex128, shape (channels,)
            Of each channel's error, log gain and i times phase: itself, and its growth from line to line.
        """
        each, more = SMALL * value, SMALL * rate
        moved = (self.model - self.added) * np.exp(each[:, None, None] + each[:, None].conj())
        moved = moved + (more[:, None, None] + more[:, None].conj()) * self.away + self.added
        before, after = (self.logarithms(csd) for csd in (self.model, moved))
        return [(new - old) / SMALL for new, old in zip(after, before, strict=True)]

    def logarithms(self, csd: Complexes) -> list[Complexes]:
        """Of each part; the imaginary part of a transfer's is its phase."""
        found = []
        for what, c, o, at, _ in self.parts:
            if what == "power":
                found.append(np.log(csd[c, c, at].real).astype(np.complex128))
            elif what == "transfer":
                found.append(np.log(transfer(csd, c, o, at)))
            else:
                found.append(np.log(remainder(csd, c, o, at)).astype(np.complex128))
        return found

    def columns(self, channels: Complexes, of: GaussianProcess, at: Reals, step: float) -> Reals:
        """What errors in these channels that are sums of functions do to residuals, a column a function.

        Parameters
        ----------
        channels : ndarray of complex128, shape (channels,)
            How much of the error each has.
        of : GaussianProcess
        at : ndarray, shape (F,)
            Where its functions are taken, line by line.
        step : float
            From line to line.
        """
        values, rates = of.values(at), of.values(at + 0.5 * step) - of.values(at - 0.5 * step)
        nothing, found = np.zeros_like(channels), []
        both = (self.answers(channels, nothing), self.answers(nothing, channels))
        for (what, _, _, lines, sigma), by_value, by_rate in zip(self.parts, *both, strict=True):
            moved = (by_value[:, None] * values[lines] + by_rate[:, None] * rates[lines]) / sigma[:, None]
            found.extend([moved.real, moved.imag] if what == "transfer" else [moved.real])
        return np.vstack(found)


def at_most(added: Reals, model: Complexes) -> Complexes:
    """Noise and hum, at most what is expected of each channel; shapes (channels, channels, F)."""
    own = np.arange(len(model))
    share = np.sqrt(np.minimum(1.0, model[own, own].real / np.maximum(added[own, own], 1e-300)))
    return np.asarray(added * share * share[:, None], dtype=np.complex128)
