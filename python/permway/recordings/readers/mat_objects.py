"""Tables and timetables of MATLAB, where mat-io is installed: `pip install 'permway[mat]'`.

Tried on a table and a timetable that mat-io 1.0.2 wrote as -v7 and -v7.3: mat-io returns them as written; scipy
1.17 gives a list of numbers in place of a table, pymatreader 1.3 too, mat73 0.65 None and a line on the screen.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from permway.errors import InputError
from permway.recordings.readers import mat_objects_child
from permway.recordings.readers.limits import MOST_BYTES, check_size
from permway.recordings.readers.stored import OBJECT, Store, Variable

WAIT_S = 60.0
"""Longest time that taking tables out of a file may last, beside a second for each 10 MB of it."""

_BYTES_PER_S = 10_000_000


def with_tables(store: Store, source: Path, *, max_bytes: int = MOST_BYTES) -> Store:
    """The same arrays with the columns of tables and timetables, as those of structs are, if there are any.

    Where mat-io is not installed, tables stay left aside, with the words how to export or install.

    Raises
    ------
    InputError
        For tables that mat-io does not read: of a later version, or damaged.
    """
    if not any(variable.reason == OBJECT for variable in store.variables.values()) or find_spec("matio") is None:
        return store
    check_size(source.stat().st_size, str(source), max_bytes=max_bytes, item=1)
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "tables.npz"
        _extract(source, target)
        with np.load(target, allow_pickle=False) as archive:
            tables = json.loads(str(archive["tables"]))
            arrays = {name: archive[name] for name in archive.files}
    found: dict[str, Variable] = dict(store.variables)
    for table in tables:
        found.pop(table["name"], None)
        for variable in _variables(table, arrays):
            if variable.name in found:
                raise InputError("a column named twice", where=str(source), value=variable.name)
            found[variable.name] = variable
    return replace(store, variables=found).without_common()


def _extract(source: Path, target: Path) -> None:
    """Run mat-io in a process of its own.

    Raises
    ------
    InputError
        If it does not come to an end, or ends without a result.
    """
    command = [sys.executable, "-P", mat_objects_child.__file__, str(source), str(target)]
    seconds, nothing = WAIT_S + source.stat().st_size / _BYTES_PER_S, subprocess.DEVNULL
    try:
        done = subprocess.run(command, stdin=nothing, capture_output=True, timeout=seconds, check=False)
    except subprocess.TimeoutExpired as error:
        raise _unread(source, "mat-io does not come to an end") from error
    if done.returncode != 0 or not target.exists():
        stated = (done.stderr.decode("utf-8", "replace").strip().splitlines() or ["it ended"])[-1]
        raise _unread(source, stated[:120])


def _unread(source: Path, stated: str) -> InputError:
    what = "holds a table or timetable of MATLAB that mat-io does not read"
    remedy = "save a struct of arrays, as by table2struct(T, 'ToScalar', true), or a text by writetimetable"
    return InputError(what, where=str(source), value=stated, remedy=remedy)


def _variables(table: Mapping[str, Any], arrays: Mapping[str, NDArray[np.generic]]) -> list[Variable]:
    folder = table["name"]
    begins = {"start_time": table["begins"]} if table.get("begins") else {}
    found = []
    for name, unit, key in table["columns"]:
        attributes = {**begins, **({"units": unit} if unit else {})}
        variable = _variable(f"{folder}/{name}", arrays[key], attributes)
        if name == "Time" and table.get("resolution_ms"):
            variable = replace(variable, resolution=table["resolution_ms"])
        found.append(variable)
    if table.get("rate_Hz") is not None:
        found.append(_variable(f"{folder}/fs", np.array([table["rate_Hz"]]), {"units": "Hz"}))
    if table.get("step_s") is not None:
        found.append(_variable(f"{folder}/dt", np.array([table["step_s"]]), {"units": "s"}))
    return found


def _variable(name: str, values: NDArray[np.generic], attributes: Mapping[str, object]) -> Variable:
    kind = "complex" if values.dtype.kind == "c" else "real"
    plain = values if kind == "complex" else values.astype(np.float64)
    step = float(np.finfo(np.float32).eps) if values.dtype == np.float32 else 2.0**-52
    return Variable(name, values.shape, kind, lambda slices: plain[slices], attributes, step=step, ordered=True)
