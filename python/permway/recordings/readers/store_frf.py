"""Frequency responses and tables among named arrays."""

from __future__ import annotations

from itertools import permutations

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.readers.headers import clean_unit, split_header
from permway.recordings.readers.hints import NO_HINTS, Hints
from permway.recordings.readers.limits import MOST_BYTES, check_size
from permway.recordings.readers.scales import hertz_in
from permway.recordings.readers.stored import UNITS, Store, Variable
from permway.recordings.record import Cells, FrfRecord, TableRecord

FREQUENCIES = {"f", "freq", "freqs", "frequency", "frequencies", "frequency_hz", "freq_hz", "f_hz"}
COHERENCES = {"coh", "coherence", "gamma2", "g2", "coherence2"}
RESPONSES = ("sensor", "sensors", "response", "responses", "output", "outputs", "channels", "channel")
REFERENCES = (
    "hammer",
    "hammers",
    "reference",
    "references",
    "force",
    "forces",
    "point",
    "points",
    "input",
    "inputs",
)
AVERAGES = {"averages", "n_averages", "navg", "n_avg", "blows", "n_blows"}
_USUAL = {"frf", "frfs", "h", "h1", "accelerance", "mobility", "receptance"}


def as_frf(
    store: Store, part: str | None = None, *, hints: Hints = NO_HINTS, max_bytes: int = MOST_BYTES
) -> FrfRecord:
    """Find frequency responses among arrays: one complex array over frequency, response and reference.

    Axes are determined by what the caller or an array of texts named `axes` states, by their names where the
    format has them, else by their lengths. Where lengths do not decide, arrays of MATLAB and NumPy stand in the
    order frequency, response, reference; those of HDF5 and NetCDF are refused.

    Raises
    ------
    InputError
        If something is missing, or more than one thing can be meant.
    """
    if part is not None and part not in store.variables:
        inner = store.within(part)
        if inner is not None:
            store, part = inner, None
    values = _complex(store, part)
    near = values.folder
    frequency = _vector(store, FREQUENCIES, "frequencies", max_bytes, near)
    responses, references = _pairs(store, values, frequency.size, near)
    wanted = (frequency.size, len(responses), len(references))
    order = _order(store, values, wanted, hints, near)
    pairs = [(response, reference) for response in responses for reference in references]
    found = store.named(COHERENCES, near)
    coherence = found[0] if found else None
    orders = order
    if coherence is not None and coherence.axes and coherence.axes != values.axes:
        orders = _order(store, coherence, wanted, hints, near)
    averages = store.number(AVERAGES, near=near)
    unit = store.texts(UNITS, near)
    return FrfRecord(
        responses=tuple(pair[0] for pair in pairs),
        references=tuple(pair[1] for pair in pairs),
        frequency_Hz=frequency,
        values=_table(store, values, order, wanted, max_bytes).astype(np.complex128),
        coherence=None if coherence is None else _coherence(store, coherence, values, orders, wanted, max_bytes),
        unit=values.unit() or (clean_unit(unit[0]) if unit is not None and len(unit) == 1 else None),
        averages=None if averages is None else round(averages),
        source=store.source,
    )


def as_table(store: Store, *, max_bytes: int = MOST_BYTES) -> TableRecord:
    """All arrays of one length and one axis, as columns.

    Raises
    ------
    InputError
        If there is none, or they differ in length.
    """
    columns: dict[str, Cells] = {}
    units: dict[str, str | None] = {}
    taken = 0
    for key, variable in store.variables.items():
        if (
            variable.kind in ("complex", "unread")
            or sum(length != 1 for length in variable.shape) > 1
            or not variable.shape
        ):
            continue
        taken += variable.size
        check_size(taken, store.source, max_bytes=max_bytes)
        name, unit = split_header(key)
        cells = np.ravel(variable.all(store.source, max_bytes=max_bytes))
        columns[name] = tuple(str(x) for x in cells) if variable.kind == "text" else cells.astype(np.float64)
        units[name] = variable.unit() or unit
    if not columns:
        raise InputError(
            "holds no columns: no array of one axis", where=store.source, value=list(store.variables)[:12]
        )
    return TableRecord(columns=columns, units=units, source=store.source)


def _vector(store: Store, names: set[str], what: str, max_bytes: int, near: str) -> Reals:
    found = store.named(names, near)
    if len(found) != 1 or found[0].kind != "real":
        raise InputError(
            f"no array of {what}" if not found else f"more than one array of {what}, or not of real numbers",
            where=store.source,
            value=list(store.variables)[:12],
            remedy=f"name one of them {sorted(names)[0]!r}",
        )
    where = f"{store.source}: '{found[0].name}'"
    scale = hertz_in(found[0].unit(), where)
    return np.ravel(found[0].all(store.source, max_bytes=max_bytes)).astype(np.float64) * scale


def _complex(store: Store, part: str | None) -> Variable:
    if part is not None:
        found = [variable for name, variable in store.variables.items() if name == part]
    else:
        found = [variable for variable in store.variables.values() if variable.kind == "complex"]
    usual = [variable for variable in found if variable.leaf.lower() in _USUAL]
    found = usual if len(found) > 1 and len(usual) == 1 else found
    if not found and (aside := store.left_aside()) is not None:
        raise aside
    if len(found) != 1 or found[0].kind != "complex":
        raise InputError(
            "no array of complex numbers"
            if not found
            else "not one array of complex numbers, which must be the FRFs",
            where=store.source,
            value=[variable.name for variable in found] or store.held(),
            remedy='say which array it is, as in part="frf"',
        )
    return found[0]


def _pairs(store: Store, values: Variable, lines: int, near: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of responses and references; where there is one only, and no name of it, that is what it is called."""
    responses = _names(store, RESPONSES, near)
    references = _names(store, REFERENCES, near)
    if references is None and values.size == lines * len(responses or ("response",)):
        references = ("reference",)
    if responses is None and values.size == lines * len(references or ()):
        responses = ("response",)
    for found, what, names in ((responses, "responses", RESPONSES), (references, "references", REFERENCES)):
        if found is None:
            raise InputError(
                f"no names of the {what}",
                where=f"{store.source}: '{values.name}'",
                value=values.shape,
                remedy=f"give an array of texts named {' or '.join(names[:4])}",
            )
    assert responses is not None
    assert references is not None
    return responses, references


def _names(store: Store, names: tuple[str, ...], near: str) -> tuple[str, ...] | None:
    for name in names:
        found = store.texts({name}, near)
        if found is not None:
            twice = next((x for i, x in enumerate(found) if x in found[:i]), None)
            if twice is not None or not found:
                where = f"{store.source}: '{name}'"
                raise InputError("a name that stands twice" if found else "no names", where=where, value=twice)
            return found
    return None


def _order(
    store: Store, values: Variable, wanted: tuple[int, ...], hints: Hints, near: str
) -> tuple[int, int, int]:
    """Axes of frequency, response and reference."""
    where = f"{store.source}: '{values.name}'"
    shape, axes = values.shape, values.axes
    stated = hints.axes or store.texts({"axes", "dims", "dimensions"}, near)
    if stated is not None and len(stated) == len(shape) == 3:
        axes = stated
    if len(shape) in (1, 2) and 1 in wanted[1:]:
        shape = (*shape, *(1,) * (3 - len(shape)))
    if len(axes) == len(shape) == 3:
        kinds = ({*FREQUENCIES}, {*RESPONSES}, {*REFERENCES})
        named = [[i for i, axis in enumerate(axes) if axis.lower() in kind] for kind in kinds]
        if all(len(found) == 1 for found in named):
            order = (named[0][0], named[1][0], named[2][0])
            if tuple(shape[axis] for axis in order) == wanted:
                return order
            if stated is not None:
                what = f"{shape} is not {wanted} of {', '.join(axes)}"
                raise InputError(what, where=where, remedy="state the axes in their order")
    fits = [p for p in permutations(range(len(shape)), 3) if tuple(shape[axis] for axis in p) == wanted]
    if len(shape) != 3 or not fits:
        raise InputError(
            f"is not {wanted[0]} frequencies by {wanted[1]} responses by {wanted[2]} references",
            where=where,
            value=values.shape,
            remedy="give names and frequencies for each axis",
        )
    # Axes of length one may change places: nothing depends on it.
    apart = {tuple(axis for axis in p if shape[axis] > 1) for p in fits}
    if len(apart) > 1 and not (values.ordered and (0, 1, 2) in fits):
        raise InputError(
            "which axis counts the responses and which the references cannot be determined: their lengths are one",
            where=where,
            value=values.shape,
            remedy='state it in the record: axes = ["frequency", "response", "reference"] in their order, '
            "or in an array of texts named axes",
        )
    first = (0, 1, 2) if values.ordered and (0, 1, 2) in fits else fits[0]
    return first[0], first[1], first[2]


def _table(
    store: Store, variable: Variable, order: tuple[int, int, int], wanted: tuple[int, ...], max_bytes: int
) -> np.ndarray:
    array = np.asarray(variable.all(store.source, max_bytes=max_bytes))
    array = array.reshape((*array.shape, *(1,) * (3 - array.ndim))).transpose(order[1], order[2], order[0])
    return np.ascontiguousarray(array).reshape(wanted[1] * wanted[2], wanted[0])


def _coherence(
    store: Store,
    coherence: Variable,
    values: Variable,
    order: tuple[int, int, int],
    wanted: tuple[int, ...],
    max_bytes: int,
) -> Reals:
    shape = coherence.shape if coherence.axes != values.axes else values.shape
    if coherence.kind != "real" or coherence.shape != shape:
        raise InputError(
            f"the coherence must be real and of the shape of '{values.name}', {values.shape}",
            where=f"{store.source}: '{coherence.name}'",
            value=coherence.shape,
        )
    percent = coherence.unit() == "%"
    return _table(store, coherence, order, wanted, max_bytes).astype(np.float64) / (100.0 if percent else 1.0)
