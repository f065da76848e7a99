"""Clamped ends, and ends on rotational springs, as the core has them: a rigid piece of beam beyond the end.

The core's ends are free or pinned. A beam whose end may not turn is continued by a massless piece a tenth of
the beam long and so stiff that it does not bend: it is pinned at its far end, and a joint holds it where the
beam ends. The end then neither moves nor turns. With a spring k_r / h^2 in place of the far pin, h being the
piece's length, the end turns against k_r (N m/rad). What is not quite rigid changes the receptance of a 10 m
cantilever by less than 1e-9 of itself up to 400 Hz, and by 3e-7 at 3 kHz.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from permway.arrays import Complexes, Reals
from permway.model.beam_columns import Section, section
from permway.model.bodies import Beam, Shaft
from permway.model.segments import Segment

PIECE = 0.1
"""Length of the piece over that of the beam. Half and twice change the error by half and twice."""
STIFFER = 1e10
"""Bending and shear stiffness of the piece over the beam's, mass of the beam over the piece's. The error goes as
its inverse; half and twice are as good, a hundredth leaves 1e-7 at 60 Hz on a 10 m beam."""
JOINT = 1e14
"""Stiffness of the joint at the end over the beam's E I / L^3. The error goes as its inverse; half and twice are
as good, a hundredth leaves 3e-5 at 3 kHz on a 10 m beam."""


@dataclass(frozen=True)
class HeldEnd:
    """One end: its beam (the core's index), place, the far end of its piece, and the law that it turns against."""

    beam: int
    side: int
    at_m: float
    far_m: float
    joint_N_per_m: float
    section: Section
    law: int | None


def held_ends(pairs: Sequence[tuple[Beam | Shaft, Segment]], laws: Sequence[str]) -> tuple[HeldEnd, ...]:
    """Ends that are clamped or turn against a spring.

    Parameters
    ----------
    pairs : sequence of (Beam or Shaft, Segment)
        In the core's order.
    laws : sequence of str
        Names of the line's laws.
    """
    found = []
    for index, (body, segment) in enumerate(pairs):
        if not isinstance(body, Beam):
            continue
        for side in (0, 1):
            law = body.rotation_laws[side]
            if not body.clamped[side] and law is None:
                continue
            length = segment.stop - segment.start
            at = (segment.start, segment.stop)[side]
            bending, shear, mass, rotary, _ = section(body)
            found.append(
                HeldEnd(
                    beam=index,
                    side=side,
                    at_m=at,
                    far_m=at + (2 * side - 1) * PIECE * length,
                    joint_N_per_m=JOINT * abs(bending) / length**3,
                    section=(bending * STIFFER, shear * STIFFER, mass / STIFFER, rotary / STIFFER, (0.0,) * 4),
                    law=None if law is None else laws.index(law),
                )
            )
    return tuple(found)


def with_held_ends(
    held: Sequence[HeldEnd], beams: Mapping[str, Any], joints: Mapping[str, np.ndarray], laws: Complexes
) -> tuple[dict[str, Any], dict[str, np.ndarray], Complexes]:
    """The core's columns with the pieces, their joints after all others, and a law of 1 N/m after all others.

    Parameters
    ----------
    held : sequence of HeldEnd
    beams : mapping
        From :func:`permway.model.beam_columns.beam_columns`.
    joints : mapping
        Columns x, upper, lower, law and scale.
    laws : ndarray, shape (F, L)
    """
    interval, pinned = np.array(beams["interval"]), np.array(beams["pinned"])
    rows: list[tuple[float, int, int, float]] = []
    for end in held:
        interval[end.beam, end.side] = end.far_m
        pinned[end.beam, end.side] = end.law is None
        rows.append((end.at_m, end.beam, laws.shape[1], end.joint_N_per_m))
        if end.law is not None:
            rows.append((end.far_m, end.beam, end.law, 1.0 / (end.far_m - end.at_m) ** 2))
    x, body, law, scale = (np.array(column) for column in zip(*rows, strict=True))
    added = {"x": x, "upper": body, "lower": np.full(len(rows), -1), "law": law, "scale": scale}
    return (
        {**beams, "interval": interval, "pinned": pinned, "stretches": _stretches(held, beams["stretches"])},
        {name: np.concatenate([joints[name], added[name].astype(joints[name].dtype)]) for name in joints},
        np.concatenate([laws, np.ones((laws.shape[0], 1))], axis=1),
    )


def held_groups(held: Sequence[HeldEnd], derived: Mapping[str, Any], *, by_law: bool) -> dict[str, Any]:
    """Groups and weights of derivatives with those of the added joints: of no group but a law's own springs."""
    groups: list[int] = []
    weights: list[float] = []
    for end in held:
        groups.append(-1)
        weights.append(0.0)
        if end.law is not None:
            groups.append(end.law if by_law else -1)
            weights.append(1.0 / (end.far_m - end.at_m) ** 2)
    return {
        **derived,
        "groups": np.concatenate([derived["groups"], np.array(groups, dtype=np.int64)]),
        "weights": np.concatenate([derived["weights"], np.array(weights, dtype=np.float64)]),
    }


def _stretches(held: Sequence[HeldEnd], stretches: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Stretches of other sections, the pieces among them, beam by beam from left to right."""
    reach: Reals = np.array([sorted((end.at_m, end.far_m)) for end in held])
    added = {
        "body": np.array([end.beam for end in held], dtype=np.int64),
        "interval": reach,
        **{
            name: np.array([end.section[i] for end in held])
            for i, name in enumerate(("bending", "shear", "mass", "rotary", "dashpots"))
        },
    }
    joined = {
        name: np.concatenate([column, added[name].astype(column.dtype)]) for name, column in stretches.items()
    }
    order = np.lexsort((joined["interval"][:, 0], joined["body"]))
    return {name: column[order] for name, column in joined.items()}
