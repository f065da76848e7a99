"""What stands beside an array and states what its numbers are: a text with its unit, a number that scales it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from permway.errors import InputError
from permway.recordings.readers.headers import clean_unit
from permway.recordings.readers.stored import MOST_TEXT_BYTES, Store, Variable, is_one_of

_GAINS = {"scale", "scaling", "scalefactor", "factor", "slope", "gain", "multiplier", "sensitivity", "lsb"}
_GAINS |= {"calibration", "calibration_factor", "cal", "cal_factor", "conversion", "conversion_factor"}
_GAINS |= {"volts_per_count", "counts_per_volt", "counts_per_unit", "units_per_count"}
_OFFSETS = {"offset", "intercept", "bias"}
_PACKED = {"scale_factor", "add_offset"}
"""Attributes of these names are applied where the file is read; arrays of these names are not."""


def with_units_beside(store: Store) -> Store:
    """The same, where an array without a unit has that of the text beside it: of `f` the one named `f_unit`.

    Raises
    ------
    InputError
        If array and text say different units.
    """
    texts = {name.lower(): x for name, x in store.variables.items() if x.kind == "text" and x.size == 1}
    attributes = {name.lower(): value for name, value in store.attributes.items() if isinstance(value, str)}
    found = {}
    for name, variable in store.variables.items():
        stated = None
        for end in ("_unit", "_units", "unit", "units"):
            key = f"{name}{end}".lower()
            if key in texts:
                stated = str(np.ravel(texts[key].all(store.source, max_bytes=MOST_TEXT_BYTES))[0])
            elif key in attributes:
                stated = str(attributes[key])
        unit, own = clean_unit(stated), variable.unit()
        if unit is None or variable.kind not in ("real", "complex"):
            continue
        if own is not None and own != unit:
            where = f"{store.source}: '{name}'"
            raise InputError(f"its own unit is {own!r}, the text beside it states {unit!r}", where=where)
        found[name] = replace(variable, attributes={**variable.attributes, "units": unit})
    return replace(store, variables={**store.variables, **found}) if found else store


def check_counts(
    store: Store, name: str, attributes: Mapping[str, object], folder: str, stated: str | None
) -> None:
    """Refuse whole numbers of a converter beside which a scale stands that nobody applied.

    Parameters
    ----------
    name : str
        Of the channel.
    attributes : mapping
        Of its array.
    folder : str
        The group or struct that its array is in.
    stated : str or None
        The unit that the caller stated of the channel as its numbers stand: with it they are taken.

    Raises
    ------
    InputError
        With the scale's name and value.
    """
    if stated is not None:
        return
    beside: list[Variable] = [
        x
        for x in store.variables.values()
        if x.kind == "real" and x.folder == folder and is_one_of(x.leaf, _GAINS | _OFFSETS | _PACKED)
    ]
    found = {x.leaf: np.ravel(x.all(store.source)) for x in beside if x.size <= 1024}
    found |= {key: np.ravel(np.asarray(x)) for key, x in attributes.items() if key.lower() in _GAINS | _OFFSETS}
    for key, values in found.items():
        nothing = 0.0 if key.lower() in _OFFSETS | {"add_offset"} else 1.0
        if values.dtype.kind in "fiu" and values.size and (values != nothing).any():
            raise InputError(
                f"whole numbers of a converter, and '{key}' beside them, which is not applied",
                where=f"{store.source}: channel '{name}'",
                value=float(values[0]),
                remedy="save the samples with their scale applied; or take the numbers as they stand: "
                f'unit = {{ "{name}" = "V" }} in the record, and the sensor\'s chain.gain',
            )
