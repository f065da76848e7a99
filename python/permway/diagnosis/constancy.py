"""Parameters that should be constant, let vary: over frequency, place, speed, temperature and kind of record.

A parameter that will not stay constant over what it should not depend on is a first pointer to what is missing. No
solve is needed: the slopes of the deviations are split by groups of rows.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.compete import Ring


@dataclass(frozen=True)
class Inconstant:
    """A parameter that would be another over part of the records.

    Attributes
    ----------
    parameter : str
    axis : "kind", "band", "record", "temperature" or "channel"
    group : str
        The part of the records that has a value of its own.
    shift : float
        By how much it is another there, in standard deviations of the owner's prior.
    sigma : float
        Standard deviation of the shift.
    gain : float
        Of the heated objective, against 1 expected of noise.
    """

    parameter: str
    axis: str
    group: str
    shift: float
    sigma: float
    gain: float


def constancy(ring: Ring) -> list[Inconstant]:
    """Every parameter against every part of the records, the least constant first.

    Parameters
    ----------
    ring : Ring
        Of the recalibrated base.
    """
    fit = ring.fit
    found = []
    for axis, group, mine in groups(ring):
        columns = np.where(mine[:, None], fit.jacobian, 0.0)
        curvature = np.diag(ring.projected(columns, columns))
        slope = ring.pull(columns)
        for index, free in enumerate(fit.free):
            # What the part hardly sees, or sees alone, says nothing of constancy.
            if curvature[index] < 1.0:
                continue
            shift = -slope[index] / (curvature[index] + 1.0)
            found.append(
                Inconstant(
                    parameter=free.name,
                    axis=axis,
                    group=group,
                    shift=float(shift),
                    sigma=float(1.0 / np.sqrt(curvature[index] + 1.0)),
                    gain=float(slope[index] ** 2 / (curvature[index] + 1.0)),
                )
            )
    return sorted(found, key=lambda f: -f.gain)


def groups(ring: Ring) -> Iterator[tuple[str, str, np.ndarray]]:
    """Axis, name and rows (bool) of every part of the records that parameters may differ over."""
    evidence = ring.evidence
    block_of, rows = evidence.block_of, evidence.rows
    hammer = np.isin(block_of, [i for i, b in enumerate(evidence.blocks) if isinstance(b, FrfBlock)])
    if hammer.any() and not hammer.all():
        yield "kind", "hammer", hammer
    middle = np.sqrt(rows.frequency_Hz.min() * rows.frequency_Hz.max())
    yield "band", f"above {middle:.3g} Hz", rows.frequency_Hz > middle
    names = {index: evidence.blocks[index].dataset.record.name for index in evidence.records}
    if len(names) > 2:
        for index, name in names.items():
            yield "record", name, block_of == index
    temperatures = {b.dataset.condition.temperature_C for b in evidence.blocks}
    if len(temperatures) > 1:
        for value in sorted(t for t in temperatures if t is not None)[1:]:
            inside = [i for i, b in enumerate(evidence.blocks) if b.dataset.condition.temperature_C == value]
            yield "temperature", f"{value:g} degC", np.isin(block_of, inside)
    for sensor in dict.fromkeys(rows.sensor):
        yield "channel", str(sensor), rows.sensor == sensor
