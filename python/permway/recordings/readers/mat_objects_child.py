"""Takes tables and timetables out of a MAT file by mat-io, in a process of its own: `FILE TARGET`.

Run as a script by :func:`permway.recordings.readers.mat_objects.with_tables`. A damaged file can end a process
whose reader is compiled; here it ends this one. Writes plain arrays into the archive TARGET: for each table a list
of columns with their units, and its times. What is none of these is left out.

Source of the layout: foreverallama, matio, docs/field_contents.md, and mat-io 1.0.2, which reads tables up to
version 5 and timetables up to version 7; later ones must say that they are compatible.
"""

from __future__ import annotations

import json
import sys
import warnings
from typing import Any

import numpy as np

_NEWEST = {"table": 5, "timetable": 7}
_DEEPEST = 4


def main(source: str, target: str) -> None:
    """Read the one, write the other."""
    tables: list[dict[str, Any]] = []
    arrays: dict[str, Any] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from matio import load_from_mat

        held = load_from_mat(source, raw_data=True)
    for name, item in held.items():
        if not name.startswith("_"):
            _walk(name, item, tables, arrays, 0)
    np.savez(target, tables=np.array(json.dumps(tables)), **arrays)


def _walk(name: str, item: Any, tables: list[dict[str, Any]], arrays: dict[str, Any], depth: int) -> None:
    """Tables among the fields of structs, too."""
    kind = getattr(item, "classname", None)
    if kind in _NEWEST:
        found = _timetable(item.properties["any"]) if kind == "timetable" else _table(item.properties)
        tables.append({"name": name, **_put(found, arrays)})
    elif isinstance(item, np.ndarray) and item.dtype.names and item.size == 1 and depth < _DEEPEST:
        for field in item.dtype.names:
            _walk(f"{name}/{field}", item[field].item(), tables, arrays, depth + 1)


def _put(found: dict[str, Any], arrays: dict[str, Any]) -> dict[str, Any]:
    """Columns as arrays of their own, by a number."""
    columns = []
    for name, unit, values in found.pop("columns"):
        key = f"a{len(arrays)}"
        arrays[key] = values
        columns.append((name, unit, key))
    return {**found, "columns": columns}


def _table(properties: dict[str, Any]) -> dict[str, Any]:
    about = properties["props"]
    _check_version(about, "table")
    names = properties["varnames"]
    for flag, other in (
        ("useVariableNames2048", "VariableNames2048"),
        ("useVariableNamesOriginal", "VariableNamesOriginal"),
    ):
        if _is_set(about, flag):
            names = about[other].item()
            break
    return {"columns": _columns(names, about["VariableUnits"].item(), properties["data"])}


def _timetable(about: Any) -> dict[str, Any]:
    _check_version(about, "timetable")
    names = about["varNames"].item()
    for flag, other in (("useVarNames2048", "varNames2048"), ("useVarNamesOrig", "varNamesOrig")):
        if _is_set(about, flag):
            names = about[other].item()
            break
    found: dict[str, Any] = {"columns": _columns(names, about["varUnits"].item(), about["data"].item())}
    times = about["rowTimes"].item()
    if getattr(times, "classname", None) is not None:
        begins, values = _moments(times)
        columns = [("Time", "ms", values), *found["columns"]]
        return {**found, "columns": columns, "begins": begins, "resolution_ms": _resolution(times)}
    begins, _ = _moments(times["origin"].item())
    if bool(times["specifiedAsRate"].item().item()):
        return {**found, "rate_Hz": float(times["sampleRate"].item().item()), "begins": begins}
    _, step = _moments(times["stepSize"].item(), relative=False)
    return {**found, "step_s": float(step[0]) / 1e3, "begins": begins}


def _moments(item: Any, *, relative: bool = True) -> tuple[str, np.ndarray]:
    """When the first of some times is, in words, and all in ms, of dates from the first."""
    if item.classname == "duration":
        values = np.asarray(item.properties["millis"], dtype=np.float64).ravel()
        return ("" if not relative else f"{values[0]:.9g} ms"), values
    if item.classname != "datetime":
        raise ValueError(item.classname)
    data = np.asarray(item.properties["data"]).ravel()
    # The imaginary part is what the real one, in ms since 1970, has lost by rounding.
    values = (data.real - data.real[0]) + (data.imag - data.imag[0])
    return f"{data.real[0]:.17g} ms and {data.imag[0]:.17g} ms since 1970", values


def _resolution(item: Any) -> float:
    """What dates are rounded to, ms, where nothing states what their real parts have lost."""
    data = np.ravel(item.properties.get("data", 0.0))
    return 0.0 if np.any(data.imag) else float(np.spacing(np.abs(data.real).max(initial=0.0)))


def _columns(names: Any, units: Any, data: Any) -> list[tuple[str, str, np.ndarray]]:
    """A column for each of a variable, as splitvars names them."""
    found = []
    stated = [_text(unit) for unit in units.ravel()] if units.size else []
    for index, (name, values) in enumerate(zip(names.ravel(), data.ravel(), strict=True)):
        if not isinstance(values, np.ndarray) or values.dtype.kind not in "fiuc" or values.ndim != 2:
            continue
        unit = stated[index] if index < len(stated) else ""
        for column in range(values.shape[1]):
            label = _text(name) if values.shape[1] == 1 else f"{_text(name)}_{column + 1}"
            found.append((label, unit, values[:, column]))
    return found


def _check_version(about: Any, kind: str) -> None:
    for name in ("minCompatibleVersion", "versionSavedFrom"):
        if name in (about.dtype.names or ()):
            if float(about[name].item().item()) > _NEWEST[kind]:
                raise ValueError(f"{kind} of version {about[name].item().item()}")
            return
    raise ValueError(f"{kind} without a version")


def _is_set(about: Any, name: str) -> bool:
    return name in (about.dtype.names or ()) and bool(np.ravel(about[name].item())[:1].any())


def _text(cell: Any) -> str:
    return str(np.ravel(cell)[0]) if np.size(cell) else ""


if __name__ == "__main__":
    main(*sys.argv[1:])
