"""Hypotheses as far as they were followed, as arrays and back."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from permway.diagnosis.hypothesis import Hypothesis
from permway.diagnosis.journal import Arrays
from permway.diagnosis.quick import Quick

OPTIONAL = ("columns", "direction", "start")


def noted(quicks: Sequence[Quick], offered: Sequence[Hypothesis], name: str) -> dict[str, np.ndarray]:
    """Arrays by names that begin with `name`.

    Parameters
    ----------
    quicks : sequence of Quick
        Of hypotheses among `offered`.
    offered : sequence of Hypothesis
    name : str
    """
    place = {id(hypothesis): index for index, hypothesis in enumerate(offered)}
    found = {
        name: np.array([place[id(q.hypothesis)] for q in quicks], dtype=np.int64),
        f"{name}.gain": np.array([q.gain for q in quicks]),
        f"{name}.promise": np.array([q.promise for q in quicks]),
    }
    for index, quick in enumerate(quicks):
        found |= {f"{name}.{index}.z": quick.z, f"{name}.{index}.base_z": quick.base_z}
        for key in OPTIONAL:
            value = getattr(quick, key)
            if value is not None:
                found[f"{name}.{index}.{key}"] = value
    return found


def recalled(kept: Arrays, offered: Sequence[Hypothesis], name: str) -> list[Quick]:
    """What :func:`noted` was given."""
    return [
        Quick(
            offered[int(place)],
            kept[f"{name}.{index}.z"],
            kept[f"{name}.{index}.base_z"],
            float(kept[f"{name}.gain"][index]),
            **{key: kept.get(f"{name}.{index}.{key}") for key in OPTIONAL},
            promise=float(kept[f"{name}.promise"][index]),
        )
        for index, place in enumerate(kept[name])
    ]
