"""Layers of a deck at the fasteners' stations, also where two slabs or two spans meet at one."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

MEET_M = 1e-6
"""A station so near to where two beams meet is there, m.

Decimals of a sheet leave less, and no fastener is placed so well: half and double of it decide the same.
"""


def between(
    upper: str,
    lower: str,
    law: str,
    length_m: float,
    spacing_m: float,
    row_m: Sequence[Sequence[float]],
    *,
    total: bool,
) -> list[dict[str, Any]]:
    """Joints of one layer over the whole deck, as the model file has them.

    A layer's total goes over the stations by the length that each stands for, half a share at the ends of the
    deck. A station where two beams of a row meet is shared: half of its joint is on either beam, so that each
    beam carries what its own length does.

    Parameters
    ----------
    upper, lower, law : str
        One of the two bodies is a slab or a girder, the beams of `row_m`; the other is one piece.
    length_m, spacing_m : float
        Of the deck, and of the stations along it.
    row_m : sequence of (from, to)
        The beams, from left to right.
    total : bool
        Whether the law is that of the whole layer, or of each joint.
    """
    bays = round(length_m / spacing_m)
    met = [
        (number, end)
        for number, (_, end) in enumerate(row_m[:-1], start=1)
        if abs(end - round(end / spacing_m) * spacing_m) < MEET_M
    ]
    if not met:
        deck = {"from_m": 0.0, "to_m": length_m, "spacing_m": spacing_m}
        whole = {"stiffness_is": "total"} if total else {}
        return [{"between": [upper, lower], "law": law, "at": deck, **whole}]
    share = 1.0 / bays if total else 1.0
    inner = [
        {"from_m": round(start + spacing_m, 9), "to_m": round(stop - spacing_m, 9), "spacing_m": spacing_m}
        for start, stop in pairwise([0.0, *(end for _, end in met), length_m])
        if stop - start > 1.5 * spacing_m
    ]
    row = "slab" if "slab" in (upper, lower) else "girder"

    def joints(at: Any, scale: float, number: int | None = None) -> dict[str, Any]:
        bodies = [f"{name}[{number}]" if number and name == row else name for name in (upper, lower)]
        return {"between": bodies, "law": law, "at": at, "scale": scale}

    return [
        *([joints(inner, share)] if inner else []),
        joints([0.0, length_m], 0.5 * share if total else share),
        *(joints([end], 0.5 * share, number + side) for number, end in met for side in (0, 1)),
    ]
