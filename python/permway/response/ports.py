"""Receptances across ports: the two ends of a joint that is there, or might be.

Of all that a line does, what changes of its joints need is here (:mod:`permway.diagnosis.joint_changes`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from permway.arrays import Complexes, Reals
from permway.model.joint_table import JointTable
from permway.model.line import Line
from permway.model.place import Place
from permway.response.core import run
from permway.response.receptance import check_places

Port = tuple[int, int, float]
"""Segments of its upper and its lower end, -1 the ground, and x in m."""

AT_ONCE = 2**26
"""Bytes of receptances between ends that are held at once."""


def from_places(
    line: Line,
    frequency_Hz: Reals,
    places: Sequence[Place],
    ports: Sequence[Port],
    *,
    temperature_C: float | None,
    threads: int | None = None,
) -> tuple[Complexes, Complexes]:
    """What ports open by, upper end less lower.

    Parameters
    ----------
    line : Line
        With one law at least.
    frequency_Hz : ndarray, shape (F,)
    places : sequence of Place
    ports : sequence of Port
        One at least.
    temperature_C : float, optional
    threads : int, optional

    Returns
    -------
    reached : ndarray of complex128, shape (F, ports, places)
        By a unit force at each place, m/N.
    own : ndarray of complex128, shape (F, ports)
        By a unit tension in itself, m/N.

    Raises
    ------
    InputError, SolveError
        As :func:`permway.response.receptance.receptance`.
    """
    table, count = line.joint_table(), len(ports)
    size = table.x.size + count
    upper, lower, x = zip(*ports, strict=True)
    none = np.zeros(count, dtype=np.int64)
    # As joints without stiffness, of which the core knows how far they extend.
    further = {
        "layer": none,
        "x": np.array(x, dtype=np.float64),
        "upper": np.array(upper, dtype=np.int64),
        "lower": np.array(lower, dtype=np.int64),
        "law": none,
        "scale": np.zeros(count),
    }
    joints = JointTable(**{name: np.concatenate([getattr(table, name), more]) for name, more in further.items()})
    at = check_places(line, places, "places")
    nowhere = np.zeros(0, dtype=np.int64)
    solved = run(
        line,
        frequency_Hz,
        {"forces": at, "sensors": {name: column[:0] for name, column in at.items()}},
        temperature_C=temperature_C,
        extensions=True,
        threads=threads,
        joints=joints,
        derived={
            "groups": np.full(size, -1, dtype=np.int64),
            "weights": np.zeros(size),
            "n_groups": 0,
            "bodies": False,
            "sensors": nowhere,
            "forces": nowhere,
            "own": True,
        },
    )
    assert solved.extension is not None
    assert solved.own is not None
    return solved.extension[:, table.x.size :], solved.own[:, table.x.size :]


def between_pairs(
    line: Line,
    frequency_Hz: Reals,
    pairs: Sequence[tuple[Port, Port]],
    *,
    temperature_C: float | None,
    threads: int | None = None,
) -> Complexes:
    """What the first port of each pair opens by for a unit tension in the second, m/N, shape (F, pairs).

    Parameters and errors as of :func:`from_places`.
    """
    ports = sorted({port for pair in pairs for port in pair})
    known = {port: i for i, port in enumerate(ports)}
    first, second = (np.array([known[pair[side]] for pair in pairs], dtype=np.int64) for side in (0, 1))
    ends = sorted({(body, x) for *bodies, x in ports for body in bodies if body >= 0})
    at = _columns(ends)
    place = {end: i for i, end in enumerate(ends)}
    # The ground, which does not move, comes last.
    upper, lower = (
        [place.get((body, x), len(ends)) for body, x in side]
        for side in ([(port[0], port[2]) for port in ports], [(port[1], port[2]) for port in ports])
    )
    found = np.empty((frequency_Hz.size, len(pairs)), dtype=np.complex128)
    lines = max(1, AT_ONCE // (16 * len(ends) ** 2))
    for start in range(0, frequency_Hz.size, lines):
        part = slice(start, start + lines)
        points = {"forces": at, "sensors": at}
        moves = run(line, frequency_Hz[part], points, temperature_C=temperature_C, threads=threads).receptance
        moves = np.pad(moves, ((0, 0), (0, 1), (0, 1)))
        moves = moves[:, upper] - moves[:, lower]
        found[part] = (moves[:, :, upper] - moves[:, :, lower])[:, first, second]
    return found


def _columns(ends: Sequence[tuple[int, float]]) -> Mapping[str, np.ndarray]:
    """As the core has places."""
    return {
        "body": np.array([body for body, _ in ends], dtype=np.int64),
        "x": np.array([x for _, x in ends], dtype=np.float64),
    }
