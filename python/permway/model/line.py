"""The line: bodies and joints along x, and its compilation to the core's tables."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from pydantic import model_validator

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.laws import AnyLaw, Hysteretic
from permway.model.bodies import AnyBody, Beam, Mass
from permway.model.faults import fault
from permway.model.joints import GROUND, Ends, Joints, Spread
from permway.records import FrozenModel

Integers = np.ndarray[tuple[int], np.dtype[np.int64]]

_TOUCH_M = 1e-9
_NAME = re.compile(r"^[A-Za-z][A-Za-z0-9_-]*$")


@dataclass(frozen=True)
class Segment:
    """One beam or mass of the core: a body's name, or "girder[2]" for the second of a row."""

    name: str
    body: str
    start: float
    stop: float


@dataclass(frozen=True)
class JointTable:
    """The joints of a line one by one, in the order of the model's layers, then along x.

    Arrays of shape (J,): layer's index, x in m, upper and lower segment (-1 for the ground), law, scale.
    """

    layer: Integers
    x: Reals
    upper: Integers
    lower: Integers
    law: Integers
    scale: Reals


class Line(FrozenModel):
    """A line: track, viaduct and what lies beside them.

    Parameters
    ----------
    bodies : dict of name to Beam or Mass
    joints : sequence of Joints
    laws : dict of name to law
        Complex stiffness in N/m that the joints refer to.
    """

    bodies: dict[str, AnyBody]
    joints: tuple[Joints, ...]
    laws: dict[str, AnyLaw]

    @model_validator(mode="after")
    def _check(self) -> Line:
        if not self.bodies:
            raise fault("a line needs at least one body", "bodies")
        for name in self.bodies:
            if name == GROUND or not _NAME.match(name):
                what = f"{name!r} cannot name a body: use letters, digits, _ and -, and not 'ground'"
                raise fault(what, "bodies", name)
        for name, law in self.laws.items():
            stiffness = getattr(law, "stiffness", 0.0)
            if stiffness < 0.0:
                raise fault("must not be negative", "laws", name, "stiffness", value=stiffness)
            if isinstance(law, Hysteretic) and law.eta > 5.0:
                what = "is above any material's: give it as a ratio, not in percent"
                raise fault(what, "laws", name, "loss_factor", value=law.eta)
        for index, layer in enumerate(self.joints):
            if layer.law not in self.laws:
                what = f"there is no law {layer.law!r}; there are {sorted(self.laws)}"
                raise fault(what, "joints", index, "law")
            if isinstance(layer.at, Ends):
                self._check_ends(index, layer.at)
        return self

    def _check_ends(self, index: int, ends: Ends) -> None:
        if ends.of not in self.bodies:
            what = f"there is no body {ends.of!r}; there are {sorted(self.bodies)}"
            raise fault(what, "joints", index, "at", "of")
        body = self.bodies[ends.of]
        if isinstance(body, Mass) or body.intervals_m is None:
            raise fault(f"{ends.of} has no ends: give it intervals_m", "joints", index, "at", "of")
        shortest = min(stop - start for start, stop in body.intervals_m)
        if not ends.inset_m < 0.5 * shortest:
            what = f"does not lie in from the ends of {ends.of}, which is {shortest:g} m long"
            raise fault(what, "joints", index, "at", "inset_m", value=ends.inset_m)

    def segments(self) -> list[Segment]:
        """Beams one by one, then masses: the bodies of the core."""
        beams, masses = [], []
        for name, body in self.bodies.items():
            if isinstance(body, Mass):
                masses.append(Segment(name, name, -np.inf, np.inf))
                continue
            intervals = body.intervals_m or ((-np.inf, np.inf),)
            for index, (start, stop) in enumerate(intervals):
                label = name if len(intervals) == 1 else f"{name}[{index + 1}]"
                beams.append(Segment(label, name, start, stop))
        return beams + masses

    def locate(self, body: str, x_m: float, *, where: str) -> int:
        """Index of the segment of `body` at `x_m`.

        Raises
        ------
        InputError
            If there is no such body, if x lies off it, or if two beams of a row meet there.
        """
        place = _find(self.segments(), body, np.array([x_m], dtype=np.float64), lambda _: where)
        return int(place[0])

    def joint_table(self) -> JointTable:
        """The joints one by one.

        Raises
        ------
        InputError
            If a joint lies off one of its bodies.
        """
        laws, segments = list(self.laws), self.segments()
        columns: list[tuple[Reals, Integers, Integers, Reals]] = []
        for index, layer in enumerate(self.joints):
            if isinstance(layer.at, Ends):
                columns.append(_at_ends(segments, index, layer, layer.at))
                continue
            given = layer.at.stations() if isinstance(layer.at, Spread) else np.asarray(layer.at, dtype=np.float64)
            stations = np.sort(given)
            near = np.flatnonzero(np.diff(stations) < _TOUCH_M)
            if near.size:
                raise InputError(
                    "two joints of the layer share a station",
                    where=f"joints[{index}].at",
                    value=float(stations[near[0]]),
                    remedy="name each station once; for two joints at one place write two layers",
                )
            upper, lower = (_side(segments, body, stations, index) for body in layer.between)
            columns.append((stations, upper, lower, layer.weights(stations)))
        sizes = [len(x) for x, _, _, _ in columns]
        table = JointTable(
            layer=np.repeat(np.arange(len(sizes)), sizes),
            x=np.concatenate([c[0] for c in columns] or [np.zeros(0)]),
            upper=np.concatenate([c[1] for c in columns] or [np.zeros(0, dtype=np.int64)]),
            lower=np.concatenate([c[2] for c in columns] or [np.zeros(0, dtype=np.int64)]),
            law=np.repeat(np.array([laws.index(layer.law) for layer in self.joints], dtype=np.int64), sizes),
            scale=np.concatenate([c[3] for c in columns] or [np.zeros(0)]),
        )
        itself = np.flatnonzero(table.upper == table.lower)
        if itself.size:
            layer_index = int(table.layer[itself[0]])
            raise InputError(
                f"ties {segments[table.upper[itself[0]]].name} to itself",
                where=f"joints[{layer_index}].between",
                value=self.joints[layer_index].between,
                remedy="name two bodies",
            )
        return table

    def stiffness(self, frequency_Hz: ArrayLike, temperature_C: float | None = None) -> Complexes:
        """Complex stiffness of every law.

        Parameters
        ----------
        frequency_Hz : array_like, shape (F,)
        temperature_C : float, optional
            Needed by laws that depend on it.

        Returns
        -------
        ndarray of complex128, shape (F, L)
            N/m, laws in the order of `laws`.

        Raises
        ------
        InputError
            From a law, for a frequency or a temperature outside what it knows; for a stiffness that is not
            finite, or that creates energy.
        """
        frequency = np.atleast_1d(np.asarray(frequency_Hz, dtype=np.float64))
        columns = []
        for name, law in self.laws.items():
            try:
                with np.errstate(all="ignore"):
                    values = law.complex(frequency, temperature_C)
            except InputError as error:
                raise InputError(
                    error.what, where=f"laws.{name}: {error.where}", value=error.value, remedy=error.remedy
                ) from error
            _check_stiffness(name, values, frequency)
            columns.append(values)
        return np.stack(columns, axis=-1) if columns else np.zeros((frequency.size, 0), dtype=np.complex128)

    def beams(self) -> list[tuple[Beam, Segment]]:
        """The beams with their segments, in the core's order."""
        pairs = []
        for segment in self.segments():
            body = self.bodies[segment.body]
            if isinstance(body, Beam):
                pairs.append((body, segment))
        return pairs

    def masses_kg(self) -> Reals:
        """Point masses in the core's order, kg."""
        return np.array([b.mass_kg for b in self.bodies.values() if isinstance(b, Mass)], dtype=np.float64)


def _check_stiffness(name: str, values: Complexes, frequency: Reals) -> None:
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        raise InputError(
            f"the stiffness is not finite at {frequency[bad[0]]:g} Hz",
            where=f"laws.{name}",
            value=complex(values[bad[0]]),
            remedy="check the law's parameters",
        )
    # A law of no loss may come out a rounding error below.
    bad = np.flatnonzero(values.imag < -1e-9 * np.abs(values))
    if bad.size:
        raise InputError(
            f"the law creates energy at {frequency[bad[0]]:g} Hz",
            where=f"laws.{name}",
            value=complex(values[bad[0]]),
            remedy="under exp(+i omega t) a loss is positive",
        )


def _find(segments: Sequence[Segment], body: str, x_m: Reals, where: Callable[[int], str]) -> Integers:
    """Index of the segment of a body at each of the places; refused as :meth:`Line.locate` says."""
    named = np.array([i for i, s in enumerate(segments) if body in (s.name, s.body)], dtype=np.int64)
    if not named.size:
        names = list(dict.fromkeys(s.body for s in segments))
        row = f'; of a row, "{names[0]}[2]" is the second' if "[" in body else ""
        raise InputError("there is no such body", where=where(0), value=body, remedy=f"use one of {names}{row}")
    bad = np.flatnonzero(~np.isfinite(x_m))
    if bad.size:
        raise InputError(
            "the place must be finite", where=where(int(bad[0])), value=float(x_m[bad[0]]), remedy="give x in m"
        )
    starts, stops = (np.array([getattr(segments[i], end) for i in named]) for end in ("start", "stop"))
    # The beams of a row stand from left to right, so at most two of them reach a place.
    last = np.searchsorted(starts - _TOUCH_M, x_m, side="right") - 1
    bad = np.flatnonzero((last < 0) | (x_m > stops[last] + _TOUCH_M))
    if bad.size:
        spans = ", ".join(f"{a:g} to {b:g} m" for a, b in zip(starts[:4], stops[:4], strict=True))
        raise InputError(
            f"off the {body}, which runs {spans}" + (", ..." if named.size > 4 else ""),
            where=where(int(bad[0])),
            value=float(x_m[bad[0]]),
            remedy="move it onto the body",
        )
    bad = np.flatnonzero((last > 0) & (x_m <= stops[last - 1] + _TOUCH_M))
    if bad.size:
        second = last[bad[0]]
        names = [segments[i].name for i in named[second - 1 : second + 1]]
        raise InputError(
            f"two beams meet there: {names}",
            where=where(int(bad[0])),
            value=float(x_m[bad[0]]),
            remedy="name the one that is meant",
        )
    return named[last]


def _side(segments: Sequence[Segment], body: str, stations: Reals, index: int) -> Integers:
    if body == GROUND:
        return np.full(stations.shape, -1, dtype=np.int64)
    return _find(segments, body, stations, lambda number: f"joints[{index}].at[{number}]")


def _at_ends(
    segments: Sequence[Segment], index: int, layer: Joints, ends: Ends
) -> tuple[Reals, Integers, Integers, Reals]:
    """Stations, upper and lower segments and scales of a layer at the ends of a body."""
    own = np.array([i for i, s in enumerate(segments) if s.body == ends.of], dtype=np.int64)
    x = np.array([(segments[i].start + ends.inset_m, segments[i].stop - ends.inset_m) for i in own]).reshape(-1)
    # Each end belongs to its own beam, even where two beams of a row meet.
    upper, lower = (
        np.repeat(own, 2) if body == ends.of else _side(segments, body, x, index) for body in layer.between
    )
    return x, upper, lower, np.full(x.shape, layer.scale)
