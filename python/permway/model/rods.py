"""Rods between bodies: what passes through one is passive only together with its two ends."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from permway.laws import Waves
from permway.laws.base import Law
from permway.model.faults import fault
from permway.model.joints import GROUND, Joints


def passes_through(law: Law) -> bool:
    """Whether a law is the part of a rod that is not passive for itself."""
    return isinstance(law, Waves) and law.part == "through"


def check_rods(layers: Sequence[Joints], laws: Mapping[str, Law]) -> None:
    """Refuse a rod without its ends on both bodies, at the same stations and with the same factors.

    Raises
    ------
    ValueError
        With the layer at fault, and what it lacks.
    """
    for index, layer in enumerate(layers):
        law = laws[layer.law]
        if not passes_through(law):
            continue
        end = law.model_copy(update={"part": "end"})
        for body in layer.between:
            wanted = layer.model_copy(update={"between": (body, GROUND), "law": layer.law})
            if body != GROUND and not any(
                laws[other.law] == end and other.model_copy(update={"law": layer.law}) == wanted
                for other in layers
            ):
                what = (
                    f"waves pass through it, and {body!r} has no end of the rod: add joints between [{body!r}, "
                    f"'ground'] at the same stations, of a law with the same numbers and part = \"end\""
                )
                raise fault(what, "joints", index, "law", value=layer.law)
