"""Spectra of a universal file: auto spectra (type 2), densities (type 9), and cross spectra (type 3) of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.recordings.readers.hints import NO_HINTS, Hints
from permway.recordings.readers.limits import MOST_BYTES, check_size
from permway.recordings.readers.uff import Text, open_text
from permway.recordings.readers.uff58 import AUTO, CROSS, DENSITY, over_frequency, same_lines
from permway.recordings.readers.uff58_function import Function, functions
from permway.recordings.readers.uff58_labels import channel_labels, type_name
from permway.recordings.readers.uff58_units import ordinate_unit

COHERENT_OFF = 1e-3
"""How much the squared coherence of two channels may exceed one, by printed digits.

Half or twice of it matters in no file met: one in another unit or scaling is off by much more, or by nothing.
"""


@dataclass(frozen=True)
class SpectraRecord:
    """Auto and cross spectra, as they stand in the file.

    Attributes
    ----------
    channels : tuple of str
    frequency_Hz : ndarray, shape (F,)
    csd : ndarray of complex128, shape (channel, channel, F)
        E[X_channel conj(X_channel2)], exp(+i omega t).
    units : tuple of (str or None)
        Of each auto spectrum.
    plain : tuple of bool
        Whether a channel's spectrum is stated to be a density by its type; that of others their unit has to say.
    source : str
    """

    channels: tuple[str, ...]
    frequency_Hz: Reals
    csd: Complexes
    units: tuple[str | None, ...]
    plain: tuple[bool, ...]
    source: str


def read_spectra(
    source: Path, channels: Sequence[str], *, hints: Hints = NO_HINTS, max_bytes: int = MOST_BYTES
) -> SpectraRecord:
    """Read the spectra of some channels, and the cross spectra of each two.

    The phase of a cross spectrum is that of its response over its reference.

    Raises
    ------
    InputError
        For a channel without its spectrum, or two without their cross spectrum; for numbers that no channels have.
    """
    with open_text(source, hints.encoding) as text:
        everything = list(functions(text))
        autos = [item for item in everything if item.function in (AUTO, DENSITY) and _of_one(item)]
        labels = channel_labels(autos)
        rows: list[Function] = []
        for name in channels:
            if labels.count(name) != 1:
                held = list(labels) or sorted({type_name(item.function) for item in everything})
                what = (
                    "there is no auto spectrum of this channel" if name not in labels else "several auto spectra"
                )
                remedy = f"it has {held[:12]}"
                raise InputError(what, where=str(source), value=name, remedy=remedy)
            rows.append(autos[labels.index(name)])
        check_size(len(rows) ** 2 * rows[0].count, str(source), max_bytes=max_bytes, item=16)
        csd = np.zeros((len(rows), len(rows), rows[0].count), dtype=np.complex128)
        frequency: Reals | None = None
        for i, item in enumerate(rows):
            abscissa, ordinate = over_frequency(text, item)
            frequency = same_lines(text, item, abscissa, frequency, rows[0])
            if np.any(ordinate.imag) or np.any(ordinate.real < 0.0):
                raise text.error("an auto spectrum must be real, and not below 0", item.at, value=channels[i])
            csd[i, i] = ordinate
        assert frequency is not None
        for i in range(len(rows)):
            for j in range(i):
                csd[i, j] = _cross(text, everything, (rows[i], rows[j]), frequency)
                csd[j, i] = csd[i, j].conj()
                _check_coherent(source, csd, (i, j), frequency, (channels[i], channels[j]))
        return SpectraRecord(
            channels=tuple(channels),
            frequency_Hz=frequency,
            csd=csd,
            units=tuple(ordinate_unit(item.ordinate, item.denominator, item.system) for item in rows),
            plain=tuple(item.function == DENSITY for item in rows),
            source=str(source),
        )


def spectra_held(source: Path, hints: Hints = NO_HINTS) -> list[dict[str, object]]:
    """The auto spectra of a file, a dict each: channel, unit, lines, from, to and step in Hz."""
    with open_text(source, hints.encoding) as text:
        autos = [item for item in functions(text) if item.function in (AUTO, DENSITY) and _of_one(item)]
        rows: list[dict[str, object]] = []
        for label, item in zip(channel_labels(autos), autos, strict=True):
            frequency, _ = over_frequency(text, item)
            rows.append(
                {
                    "channel": label,
                    "what": type_name(item.function),
                    "unit": ordinate_unit(item.ordinate, item.denominator, item.system),
                    "lines": item.count,
                    "from_Hz": float(frequency[0]),
                    "to_Hz": float(frequency[-1]),
                    "step_Hz": float(np.mean(np.diff(frequency))) if item.count > 1 else None,
                }
            )
        return rows


def _of_one(item: Function) -> bool:
    """Whether response and reference are one, or there is no reference."""
    return item.reference.degree in (None, item.response.degree)


def _cross(text: Text, everything: list[Function], pair: tuple[Function, Function], frequency: Reals) -> Complexes:
    """Of two channels; where it stands the other way round in the file, its conjugate."""
    one, other = (item.response.label for item in pair)
    for first, second, turned in ((one, other, False), (other, one, True)):
        found = [
            item
            for item in everything
            if item.function in (CROSS, DENSITY)
            and item.complex
            and (item.response.label, item.reference.label) == (first, second)
        ]
        if len(found) > 1:
            remedy = "keep one, or put repeats into files of their own"
            raise text.error(
                "several cross spectra of one pair", found[1].at, value=f"{one} / {other}", remedy=remedy
            )
        if found:
            abscissa, values = over_frequency(text, found[0])
            same_lines(text, found[0], abscissa, frequency, pair[0])
            units = [ordinate_unit(item.ordinate, item.denominator, item.system) for item in (found[0], *pair)]
            if len(set(units)) > 1:
                what = "a cross spectrum in another unit than the auto spectra of its channels"
                remedy = "export all spectra in one unit, or the record in time"
                raise text.error(what, found[0].at, value=units, remedy=remedy)
            return values.conj() if turned else values
    remedy = "export it (type 3), give each channel a record of its own, or export the record in time"
    raise InputError(
        "holds no cross spectrum of two channels", where=text.source, value=(one, other), remedy=remedy
    )


def _check_coherent(
    source: Path, csd: Complexes, at: tuple[int, int], frequency: Reals, names: tuple[str, str]
) -> None:
    i, j = at
    with np.errstate(invalid="ignore"):
        off = np.abs(csd[i, j]) ** 2 > (1.0 + COHERENT_OFF) * csd[i, i].real * csd[j, j].real
    off &= frequency > 0.0
    if off.any():
        line = int(np.flatnonzero(off)[0])
        what = "the cross spectrum is larger than the auto spectra allow: of another scale, or of other averages"
        where = f"{source}: {names[0]} / {names[1]}, {frequency[line]:g} Hz"
        raise InputError(what, where=where, value=float(np.abs(csd[i, j, line])), remedy="export them together")
