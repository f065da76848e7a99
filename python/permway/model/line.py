"""The line: bodies and joints along x, and its compilation to the core's tables."""

from __future__ import annotations

import re
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field, model_validator

from permway.arrays import Complexes, Reals, check_track_temperature, real_numbers
from permway.errors import InputError
from permway.laws import AnyLaw, Hysteretic
from permway.laws.base import Law
from permway.model.beam_columns import beam_columns
from permway.model.bodies import AnyBody, Beam, Mass, Shaft
from permway.model.faults import fault
from permway.model.joint_table import JointTable as JointTable
from permway.model.joint_table import joint_table
from permway.model.joints import GROUND, Ends, Joints
from permway.model.kept import Kept
from permway.model.rods import check_rods, passes_through
from permway.model.segments import Segment as Segment
from permway.model.segments import check_ends, check_rows, find, segments_of
from permway.notebook import Shown
from permway.records import FrozenModel

_NAME = re.compile(r"^[A-Za-z][A-Za-z0-9_-]*$")


_COMPILED: Kept[Line, JointTable] = Kept(8)
"""Joints of lines: a search goes back and forth between a few."""

_STIFFNESS: Kept[Law, Complexes] = Kept(256)
"""Of laws, at the last frequencies of each temperature: lines of a search differ in few of their laws."""


class Line(FrozenModel, Shown):
    """A line: track, viaduct and what lies beside them.

    Parameters
    ----------
    bodies : dict of name to Beam, Shaft or Mass
    joints : sequence of Joints, optional
    laws : dict of name to law, optional
        Complex stiffness in N/m that the joints refer to; in N m/rad of a beam's rotational springs.
    """

    bodies: dict[str, AnyBody]
    joints: tuple[Joints, ...] = ()
    laws: dict[str, AnyLaw] = Field(default_factory=dict)

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
        for name, body in self.bodies.items():
            for turned in body.rotation_laws if isinstance(body, Beam) else ():
                if turned is not None and turned not in self.laws:
                    what = f"there is no law {turned!r}; there are {sorted(self.laws)}"
                    raise fault(what, "bodies", name, "rotation_law")
        for index, layer in enumerate(self.joints):
            if layer.law not in self.laws:
                what = f"there is no law {layer.law!r}; there are {sorted(self.laws)}"
                raise fault(what, "joints", index, "law")
            if isinstance(layer.at, Ends):
                check_ends(self.bodies, layer.at, "joints", index, "at")
        check_rows(self.bodies)
        check_rods(self.joints, self.laws)
        return self

    def segments(self) -> list[Segment]:
        """Beams and shafts one by one, then masses: the bodies of the core."""
        return segments_of(self.bodies)

    def locate(self, body: str, x_m: float, *, where: str) -> int:
        """Index of the segment of `body` at `x_m`.

        Raises
        ------
        InputError
            If there is no such body, if x lies off it, or if two beams of a row meet there.
        """
        place = find(self.segments(), body, np.array([x_m], dtype=np.float64), lambda _: where)
        return int(place[0])

    def joint_table(self) -> JointTable:
        """The joints one by one.

        Raises
        ------
        InputError
            If a joint lies off one of its bodies, or nothing holds a mass of a row.
        """
        return _COMPILED.of(self, lambda: joint_table(self.bodies, self.joints, list(self.laws), self.segments()))

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
        frequency = np.atleast_1d(real_numbers(frequency_Hz, "frequency_Hz"))
        check_track_temperature(temperature_C)
        at, columns = frequency.tobytes(), []
        for name, law in self.laws.items():
            values = partial(_stiffness, name, law, frequency, temperature_C)
            # What is no temperature, an array say, is for the law to refuse.
            columns.append(_STIFFNESS.of(law, values, use=repr(temperature_C), given=at))
        return np.stack(columns, axis=-1) if columns else np.zeros((frequency.size, 0), dtype=np.complex128)

    @property
    def needs_temperature(self) -> bool:
        """Whether a law depends on temperature."""
        return any(law.needs_temperature for law in self.laws.values())

    def beams(self) -> list[tuple[Beam | Shaft, Segment]]:
        """The beams and shafts with their segments, in the core's order."""
        pairs: list[tuple[Beam | Shaft, Segment]] = []
        for segment in self.segments():
            body = self.bodies[segment.body]
            if not isinstance(body, Mass):
                pairs.append((body, segment))
        return pairs

    def beam_columns(self) -> dict[str, Any]:
        """Beams and shafts as the core's columns, with the stretches where their sections change."""
        return beam_columns(self.beams())

    def masses_kg(self) -> Reals:
        """Point masses in the core's order, kg."""
        bodies = [self.bodies[segment.body] for segment in self.segments()]
        return np.array([body.mass_kg for body in bodies if isinstance(body, Mass)], dtype=np.float64)


def _stiffness(name: str, law: Law, frequency: Reals, temperature_C: float | None) -> Complexes:
    """Of one law, checked."""
    try:
        with np.errstate(all="ignore"):
            values = law.complex(frequency, temperature_C)
    except InputError as error:
        raise InputError(
            error.what, where=f"laws.{name}: {error.where}", value=error.value, remedy=error.remedy
        ) from error
    _check_stiffness(name, values, frequency, active=passes_through(law))
    return values


def _check_stiffness(name: str, values: Complexes, frequency: Reals, *, active: bool) -> None:
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
    if bad.size and not active:
        raise InputError(
            f"the law creates energy at {frequency[bad[0]]:g} Hz",
            where=f"laws.{name}",
            value=complex(values[bad[0]]),
            remedy="under exp(+i omega t) a loss is positive",
        )
