"""What a sweep would need, refused before it begins: memory, and elements shorter than the waves."""

from __future__ import annotations

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.model.beam_columns import sections
from permway.model.bodies import Beam, Shaft
from permway.model.line import JointTable, Line

MOST_THREADS = 1024
LARGEST_ANSWER = 16 * 2**30
"""Bytes of complex numbers that one call returns at most."""

MOST_DENSE_JOINTS = 5000
"""Joints of the receptance formulation: its dense system then takes 0.4 GB on each thread."""

MOST_ELEMENTS = 250_000
"""Elements of the chain formulation, over all beams."""

MOST_BODIES = 100_000
"""Beams and masses of the chain formulation, each counted: sleepers of 60 km, set up in a third of a second.

Time and memory are linear in them: half as many would refuse lines that are solved in seconds, twice as many take
twice the time.
"""

_ELEMENT = 4.0
"""Longest element of the core as a multiple of the steepest wave's length scale."""


def check_threads(threads: int | None) -> None:
    """Refuse a number of threads that is not 1 to :data:`MOST_THREADS`."""
    if threads is None:
        return
    if isinstance(threads, bool) or not isinstance(threads, int) or not 1 <= threads <= MOST_THREADS:
        raise InputError(
            "must be a whole number from 1 on",
            where="threads",
            value=threads,
            remedy=f"at most {MOST_THREADS}; leave it out for all processors",
        )


def check_answer(*sizes: int) -> None:
    """Refuse an answer too large to hold: sizes are frequencies, then rows, then forces."""
    size = 16 * int(np.prod([float(s) for s in sizes]))
    if size > LARGEST_ANSWER:
        raise InputError(
            f"the answer would take {size / 2**30:.3g} GiB, more than {LARGEST_ANSWER // 2**30}",
            where="frequencies, sensors and forces",
            value=sizes,
            remedy="ask for fewer, or in several calls",
        )


def check_dense(table: JointTable) -> None:
    """Refuse a line with too many joints for the receptance formulation."""
    if table.x.size > MOST_DENSE_JOINTS:
        raise InputError(
            f"the receptance formulation takes at most {MOST_DENSE_JOINTS} joints",
            where="formulation",
            value=f"{table.x.size} joints",
            remedy='use "chain"',
        )


def check_elements(line: Line, table: JointTable, places_m: Reals, highest_Hz: float) -> None:
    """Refuse too many bodies, and a beam that the highest frequency would cut into too many elements."""
    segments = line.segments()
    if len(segments) > MOST_BODIES:
        most = max(line.bodies, key=lambda name: sum(s.body == name for s in segments))
        raise InputError(
            f"the chain formulation takes at most {MOST_BODIES} beams and masses",
            where=f"line.bodies.{most}",
            value=len(segments),
            remedy="take a shorter line, or a wider spacing",
        )
    finite = [x for s in segments for x in (s.start, s.stop) if np.isfinite(x)]
    x = np.concatenate([table.x, places_m, np.array(finite, dtype=np.float64)])
    if not x.size:
        return
    omega = 2.0 * np.pi * np.float64(highest_Hz)
    total = 0.0
    for beam, segment in line.beams():
        length = min(segment.stop, float(x.max())) - max(segment.start, float(x.min()))
        with np.errstate(all="ignore"):
            total += _steepest(beam, omega) * max(length, 0.0) / _ELEMENT
        if not total <= MOST_ELEMENTS:
            raise InputError(
                f"waves at {highest_Hz:g} Hz are too short: {segment.name} would need {total:.3g} elements",
                where="frequency_Hz",
                value=highest_Hz,
                remedy=f"at most {MOST_ELEMENTS}: lower the highest frequency, or check the beam's units",
            )


def _steepest(beam: Beam | Shaft, omega: np.float64) -> float:
    """A bound on the modulus of the exponents of a body's waves, 1/m, in any of its sections."""
    bound = 0.0
    for bending, shear, mass, rotary, dashpots in sections(beam):
        if bending == 0.0:
            bound = max(bound, float(omega * np.sqrt(mass / abs(shear))))
            continue
        # On both roots of z^2 - s z + p = 0, the squared exponents.
        viscous = 1j * omega * np.array(dashpots)
        compliance = np.complex128(1.0 / (shear + viscous[1]) if shear else 0.0)
        flexibility = 1.0 / np.complex128(bending + viscous[0])
        inertia, turning = mass * omega**2 - viscous[2], rotary * omega**2 - viscous[3]
        s = abs(turning * flexibility + compliance * inertia)
        p = abs(inertia * flexibility * (compliance * turning - 1.0))
        bound = max(bound, float(np.sqrt(s + np.sqrt(p))))
    return bound
