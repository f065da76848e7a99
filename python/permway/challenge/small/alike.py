"""Entries of the catalogue that are the same mathematics on a layout: either is a right name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from permway.challenge.score import NOVEL

ALIKE: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    # Parts of a girder that move on springs all along it are a second track without unsprung mass.
    ("girder_local_modes", "second_track", ("deck", "slab", "beam")),
    # On a rig any layer below a mass is a rubber, and a bed.
    ("ballast_frequency", "pad_frequency", ("rig",)),
    ("pad_frequency", "ballast_frequency", ("rig",)),
)
"""What is concealed, what may be stated instead, and on which layouts."""


def right_names(truth: Mapping[str, Any]) -> set[str]:
    """All names that are right in a campaign; "novel" of what is in no catalogue."""
    ids = {effect["id"] or NOVEL for effect in truth["effects"]}
    return ids | {named for true, named, layouts in ALIKE if true in ids and truth["layout"] in layouts}
