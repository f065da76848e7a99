"""Pairs of a record of responses: which of them the file has, and which of those lack something."""

from __future__ import annotations

from collections.abc import Callable
from difflib import get_close_matches

import numpy as np
from numpy.typing import NDArray

from permway.campaign.campaign import Campaign
from permway.campaign.parts import Record
from permway.errors import InputError
from permway.recordings.ratio import ratio_of
from permway.recordings.record import FrfRecord
from permway.units import check_same, parse_unit

Rows = NDArray[np.int64]
"""Row of the file for each response and reference of the record; -1 where the pair was not measured."""


def rows_of(record: Record, file: FrfRecord, whole: Callable[[], FrfRecord]) -> Rows:
    """Where the pairs of a record are in its file.

    Parameters
    ----------
    record : Record
    file : FrfRecord
        With the pairs of the record's labels, where it has them.
    whole : callable
        Reads the file with all its labels.

    Raises
    ------
    InputError
        For a label of the record that the file does not have at all.
    """
    pairs = {pair: i for i, pair in enumerate(zip(file.responses, file.references, strict=True))}
    sensors, points = list(record.responses), list(record.references)
    at = np.array([[pairs.get((sensor, point), -1) for point in points] for sensor in sensors], dtype=np.int64)
    for names, key, missing in (
        (sensors, "responses", (at < 0).all(axis=1)),
        (points, "references", (at < 0).all(axis=0)),
    ):
        if missing.any():
            raise _no_label(record, key, names[int(np.flatnonzero(missing)[0])], whole())
    return at


def _no_label(record: Record, key: str, label: str, file: FrfRecord) -> InputError:
    """That a file has no such label, with those that it has; or that `pairs` names another than the record."""
    known = sorted(set(getattr(file, key)))
    listed = f"it has {known[:12]}{', ...' if len(known) > 12 else ''}"
    stated = [pair[0 if key == "responses" else 1] for pair in (record.hints.pairs or {}).values()]
    odd = [name for name in dict.fromkeys(stated) if name not in getattr(record, key)]
    if odd:
        near = get_close_matches(label, odd, 1) or odd[:1]
        what = f"pairs names {near[0]!r}, which is none of the {key}"
        remedy = f"did you mean {label!r}? Of the {key} {label!r} is in no pair"
        return InputError(what, where="pairs", value=near[0], remedy=remedy)
    near = get_close_matches(label, known, 1)
    remedy = f"did you mean {near[0]!r}? {listed}" if near and near[0] != label else listed
    if label in known:
        what, remedy = "no pair of the record has this label", "see with which of the others the file has it"
        return InputError(what, where=f"{key}.{label}", remedy=f"{remedy}: permway look {record.file}")
    return InputError("the file has no such label", where=f"{key}.{label}", remedy=remedy)


def unsure(record: Record, file: FrfRecord, at: Rows) -> list[tuple[str, str]]:
    """Labels of the pairs that were measured and have no coherence on any line, where the file has one at all."""
    if file.coherence is None:
        return []
    none = np.asarray(np.isnan(file.coherence).all(axis=1))
    return [
        (label, struck)
        for i, label in enumerate(record.responses)
        for j, struck in enumerate(record.references)
        if at[i, j] >= 0 and none[at[i, j]]
    ]


def check_units(campaign: Campaign, record: Record, file: FrfRecord, at: Rows) -> None:
    """Refuse a file whose unit is not that of the sensor over that of the force point.

    Raises
    ------
    InputError
        With the pair, both units, and what would settle it.
    """
    for i, (label, name) in enumerate(record.responses.items()):
        for j, (struck, point) in enumerate(record.references.items()):
            found = None if at[i, j] < 0 else file.unit_of(int(at[i, j]))
            if found is None:
                continue
            sensor, force = campaign.sensor(name).unit, campaign.point(point).unit
            stated = f"({sensor})/{force}"
            where = f"{record.file}: {label} / {struck}"
            try:
                check_same(found, stated, where=where)
            except InputError as error:
                what = f"{error.what}: the sensor and the force point make it {stated!r}"
                if record.unit is not None:
                    what = f"the record states {found!r}, sensor and force point {stated!r}"
                raise InputError(what, where=where, value=found, remedy=_settled(found, stated)) from error


def _settled(found: str, stated: str) -> str:
    """What makes a file and its campaign agree on a unit: never another unit for the same numbers."""
    header = f'only if the file states it wrongly and its numbers are in {stated}, in the record unit = "{stated}"'
    ratio = ratio_of(found)
    if ratio is not None:
        quantity, top, force = ratio
        return f'sensor: quantity = "{quantity}", unit = "{top}", force point: unit = "{force}"; {header}'
    try:
        is_, wanted = parse_unit(found), parse_unit(stated)
    except InputError:
        return f"state a unit that is known; {header}"
    if is_.dimension == wanted.dimension and not is_.level:
        factor = is_.factor / wanted.factor
        copy = f"in a copy of the file multiply by {factor:.9g} and state {stated}"
        return f"no sensor and force point have this unit: {copy}"
    return f"correct the unit or quantity of the sensor, or the unit of the point; {header}"
