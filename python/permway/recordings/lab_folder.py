"""A folder of lab exports, every file looked at, and what of it a campaign would use."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from permway.errors import InputError
from permway.recordings.look import Asked, look
from permway.recordings.readers import read_frf
from permway.recordings.readers.text_frf_wide import ALONE, names_of

LEFT_ALONE = {
    ".toml",
    ".md",
    ".py",
    ".png",
    ".jpg",
    ".jpeg",
    ".pdf",
    ".svg",
    ".html",
    ".docx",
    ".xlsx",
    ".zip",
    ".json",
}
"""Endings of what is no recording, and not looked at."""

MOST_FILES = 2000
"""Files of a folder: a look takes up to a second each."""

UNDETERMINED = "what was read and what was struck cannot be determined from a name"
"""What the reader states about a column that names a sensor alone."""

MOST_COLUMNS = 500
"""Sensors side by side that are named so."""

FEWEST_SAMPLES = 16
"""Samples below which a table is a list of something, and no record in time."""

_UNSTATED = re.compile(r"^(\w+) = [^#\n]*# .*does not say.*$", re.MULTILINE)
_BLOCK = re.compile(r"^(?=\[\[)", re.MULTILINE)
_REMARK = re.compile(r"^# (.*)$", re.MULTILINE)


@dataclass(frozen=True)
class StatedTable:
    """A table of a campaign file, and those of its keys that the file of recordings does not say."""

    table: dict[str, Any]
    unstated: set[str]


@dataclass(frozen=True)
class Export:
    """One file, as it was looked at.

    Attributes
    ----------
    path : Path
        From the folder on.
    format : str
        "" if none is known.
    sensors, forces, records : list of StatedTable
        Tables of a campaign file that would use it, as `permway look` gives them.
    remarks : list of str
        What was left aside, and why.
    shows : dict
        What there is, for people.
    """

    path: Path
    format: str
    sensors: list[StatedTable] = field(default_factory=list)
    forces: list[StatedTable] = field(default_factory=list)
    records: list[StatedTable] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    shows: dict[str, Any] = field(default_factory=dict)


def read_folder(folder: Path) -> list[Export]:
    """Look at every file of a folder and of the folders in it.

    Raises
    ------
    InputError
        If there is no such folder, nothing in it, or nothing that can be read.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise InputError("there is no such folder", where=str(folder), remedy="name the folder of the exports")
    files = sorted(path for path in folder.rglob("*") if _wanted(path.relative_to(folder), path))
    if not files:
        raise InputError("holds no recordings", where=str(folder), remedy="put the lab's exports into it")
    if len(files) > MOST_FILES:
        remedy = "name a folder of one campaign"
        raise InputError(f"more than {MOST_FILES} files", where=str(folder), value=len(files), remedy=remedy)
    exports = [_export(folder, path) for path in files]
    if not any(export.records for export in exports):
        first = exports[0]
        why = first.remarks[0] if first.remarks else "no record"
        raise InputError("no file of it is read as a record", where=str(folder), remedy=f"{first.path}: {why}")
    return exports


def _wanted(inside: Path, path: Path) -> bool:
    hidden = any(part.startswith(".") for part in inside.parts)
    return path.is_file() and not hidden and path.suffix.lower() not in LEFT_ALONE


def _export(folder: Path, path: Path) -> Export:
    name = path.relative_to(folder)
    try:
        seen = examine(path)
    except InputError as error:
        return Export(name, "", remarks=[f"{error.what}; {error.remedy}".rstrip("; ")])
    part = str(seen.get("campaign", ""))
    stated = tomllib.loads(part)
    remarks = [*_REMARK.findall(part), *(str(one) for one in seen.get("notes", ()))]
    if _short(seen):
        stated, part = {}, ""
        remarks = [f"fewer than {FEWEST_SAMPLES} rows: no record is made of it"]
    if not stated.get("records"):
        remarks += [str(one) for one in seen.get("problems", ())][:1] or ["no record of it can be used"]
    return Export(
        name,
        str(seen["format"]),
        _tables(part, stated, "sensors"),
        _tables(part, stated, "forces"),
        _tables(part, stated, "records"),
        # Whoever reads them knows the folder.
        list(dict.fromkeys(remark.replace(f"{path}: ", "") for remark in remarks)),
        _shown(seen),
    )


def examine(path: Path, asked: Asked | None = None) -> dict[str, Any]:
    """A look; of a table whose names do not say what was struck, the file's name does: one point a file.

    A table of one response needs no name. Without one its labels would be the same in every file of a folder, and
    so its sensor and its point.

    Parameters
    ----------
    path : Path
    asked : Asked, optional
        As of :func:`permway.recordings.look.look`, whose dict this is, too.
    """
    asked = asked or Asked()
    seen = look(path, asked)
    if seen["format"] != "text" or asked.hints.pairs:
        return seen
    pairs: dict[str, tuple[str, str]] = {}
    if _unnamed(seen):
        pairs = {name: (name or path.stem, path.stem) for name in names_of(path, asked.hints)}
    elif "responses" in seen or "columns" not in seen:
        return seen
    while len(pairs) < MOST_COLUMNS:
        hints = replace(asked.hints, pairs=pairs or None)
        try:
            read_frf(path, format=asked.format, part=asked.part, hints=hints, keep_nonfinite=True)
        except InputError as error:
            name = str(error.value)
            if not error.what.startswith(UNDETERMINED) or name in pairs:
                return seen
            pairs[name] = (name, path.stem)
        else:
            break
    if not pairs:
        return seen
    found = look(path, replace(asked, hints=replace(asked.hints, pairs=pairs)))
    note = f"what was struck stands in no column, and is taken from the file's name: {path.stem!r}"
    return found | {"notes": [*found.get("notes", ()), note]}


def _unnamed(seen: Mapping[str, Any]) -> bool:
    """Whether the reader made up the labels of a table's only response."""
    found = seen.get("responses", {})
    return (found.get("read"), found.get("struck")) == ([ALONE[0]], [ALONE[1]])


def _short(seen: Mapping[str, Any]) -> bool:
    rows = seen.get("channels", ())
    return "responses" not in seen and bool(rows) and all((row["samples"] or 0) < FEWEST_SAMPLES for row in rows)


def _tables(part: str, stated: Mapping[str, Any], key: str) -> list[StatedTable]:
    """Tables of one kind, each with the keys that stand there with a remark that the file does not say them."""
    blocks = [block for block in _BLOCK.split(part) if block.startswith(f"[[{key}]]")]
    tables = stated.get(key, ())
    return [
        StatedTable(dict(table), set(_UNSTATED.findall(block)))
        for table, block in zip(tables, blocks, strict=True)
    ]


def _shown(seen: dict[str, Any]) -> dict[str, Any]:
    """Kind, number, units, rate and reach of what a file holds."""
    if "responses" in seen:
        found = seen["responses"]
        holds = f"{len(found['read'])} x {len(found['struck'])} responses"
        if found["missing"]:
            holds += f", {found['pairs']} of {found['pairs'] + len(found['missing'])} pairs"
        reach = f"{found['from_Hz']:g} to {found['to_Hz']:g} Hz"
        unit = ", ".join(one for one in found["unit"] if one != "None") or "no unit"
        return {"holds": holds, "unit": unit, "reach": reach}
    rows = [row for row in seen.get("channels", ()) if not row["problem"]]
    if rows:
        units = dict.fromkeys(str(row["unit"] or "no unit") for row in rows)
        rates = dict.fromkeys(f"{row['sampling_Hz']:g} Hz" for row in rows if row["sampling_Hz"])
        return {"holds": f"{len(rows)} channels", "unit": ", ".join(units), "reach": ", ".join(rates) or "no rate"}
    columns = seen.get("columns", ())
    return {
        "holds": f"a table of {len(columns)} columns" if columns else "nothing that is read",
        "unit": "",
        "reach": "",
    }
