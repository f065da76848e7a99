"""The line: bodies and joints along x, and its compilation to the core's tables."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from pydantic import model_validator

from permway.errors import InputError
from permway.laws import AnyLaw
from permway.laws.base import Complexes, FrozenModel, Reals
from permway.model.bodies import AnyBody, Beam, Mass
from permway.model.joints import GROUND, Ends, Joints, Spread

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
            raise ValueError("a line needs at least one body")
        for name in self.bodies:
            if name == GROUND or not _NAME.match(name):
                raise ValueError(f"{name!r} cannot name a body: use letters, digits, _ and -, and not 'ground'")
        for index, layer in enumerate(self.joints):
            if layer.law not in self.laws:
                raise ValueError(
                    f"joints.{index}.law: there is no law {layer.law!r}; there are {sorted(self.laws)}"
                )
            if isinstance(layer.at, Ends) and layer.at.of not in self.bodies:
                raise ValueError(
                    f"joints.{index}.at.of: there is no body {layer.at.of!r}; there are {sorted(self.bodies)}"
                )
        return self

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
        segments = self.segments()
        named = [i for i, s in enumerate(segments) if body in (s.name, s.body)]
        if not named:
            raise InputError(
                "there is no such body",
                where=where,
                value=body,
                remedy=f"use one of {[s.name for s in segments]}",
            )
        if not np.isfinite(x_m):
            raise InputError("the place must be finite", where=where, value=x_m, remedy="give x in m")
        found = [i for i in named if segments[i].start - _TOUCH_M <= x_m <= segments[i].stop + _TOUCH_M]
        if not found:
            spans = ", ".join(f"{segments[i].start:g} to {segments[i].stop:g} m" for i in named)
            raise InputError(
                f"off the {body}, which runs {spans}", where=where, value=x_m, remedy="move it onto the body"
            )
        if len(found) > 1:
            names = [segments[i].name for i in found]
            raise InputError(
                f"two beams meet there: {names}", where=where, value=x_m, remedy="name the one that is meant"
            )
        return found[0]

    def joint_table(self) -> JointTable:
        """The joints one by one.

        Raises
        ------
        InputError
            If a joint lies off one of its bodies.
        """
        rows: list[tuple[int, float, int, int, int, float]] = []
        laws = list(self.laws)
        for index, layer in enumerate(self.joints):
            law = laws.index(layer.law)
            if isinstance(layer.at, Ends):
                rows += self._at_ends(index, layer, layer.at, law)
                continue
            given = layer.at.stations() if isinstance(layer.at, Spread) else np.asarray(layer.at, dtype=np.float64)
            stations = np.sort(given)
            if (np.diff(stations) < _TOUCH_M).any():
                raise InputError("two joints of the layer share a station", where=f"joints.{index}.at")
            for number, (x, weight) in enumerate(zip(stations, layer.weights(stations), strict=True)):
                where = f"joints.{index}.at[{number}]"
                upper, lower = (
                    -1 if body == GROUND else self.locate(body, float(x), where=where) for body in layer.between
                )
                rows.append((index, float(x), upper, lower, law, float(weight)))
        columns = list(zip(*rows, strict=True)) or [()] * 6
        layer_, x_, upper_, lower_, law_, scale_ = columns
        return JointTable(
            layer=np.array(layer_, dtype=np.int64),
            x=np.array(x_, dtype=np.float64),
            upper=np.array(upper_, dtype=np.int64),
            lower=np.array(lower_, dtype=np.int64),
            law=np.array(law_, dtype=np.int64),
            scale=np.array(scale_, dtype=np.float64),
        )

    def _at_ends(
        self, index: int, layer: Joints, ends: Ends, law: int
    ) -> list[tuple[int, float, int, int, int, float]]:
        rows = []
        for number, segment in enumerate(self.segments()):
            if segment.body != ends.of:
                continue
            if not np.isfinite(segment.start + segment.stop):
                raise InputError(
                    f"{ends.of} has no ends", where=f"joints.{index}.at.of", remedy="give it intervals_m"
                )
            for x in (segment.start + ends.inset_m, segment.stop - ends.inset_m):
                where = f"joints.{index}.at"
                # Each end belongs to its own beam, even where two beams of a row meet.
                upper, lower = (
                    -1 if body == GROUND else number if body == ends.of else self.locate(body, x, where=where)
                    for body in layer.between
                )
                rows.append((index, x, upper, lower, law, layer.scale))
        return rows

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
            From a law, for a frequency or a temperature outside what it knows.
        """
        frequency = np.atleast_1d(np.asarray(frequency_Hz, dtype=np.float64))
        columns = []
        for name, law in self.laws.items():
            try:
                columns.append(law.complex(frequency, temperature_C))
            except InputError as error:
                raise InputError(
                    error.what, where=f"laws.{name}: {error.where}", value=error.value, remedy=error.remedy
                ) from error
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
