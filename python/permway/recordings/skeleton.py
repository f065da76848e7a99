"""A campaign file and a model file started from a folder of lab exports: what was found, and questions."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from permway.errors import InputError
from permway.files import prepare_folder, write_text
from permway.recordings.lab_folder import Export, StatedTable, read_folder
from permway.recordings.skeleton_model import first_body, model_text, parameter_lines

CAMPAIGN, MODEL = "campaign.toml", "model.toml"

HAMMER = "hammer tests"
"""Name of the condition of all hammer tests."""

NO_SAYING = "question: the file does not say it"

_NUMBER = r"(?P<x>[-+]?\d+(?:[.,]\d+)?)"

BODIES = ("rail", "sleeper", "slab", "base", "deck", "girder", "beam", "baseplate", "plate", "cap", "pier")

_BODY = f"(?P<body>{'|'.join(BODIES)})"

NAMED = (
    re.compile(rf"(?:.*\s)?(?P<body>[^\W\d]\w*) ?@ ?(?:x ?= ?)?{_NUMBER} ?m?"),
    re.compile(rf"(?:hit )?{_BODY}[ _-]*(?P<x>\d+(?:\.\d+)?) ?m?"),
    re.compile(
        rf"(?:.*[\W_])?{_BODY}[ _-]*(?P<x>\d+[.,]\d+(?= ?m?$)|\d+(?= ?m$)) ?m?",
        re.IGNORECASE,
    ),
    re.compile(rf".*?(?<![^\W_])x ?= ?{_NUMBER} ?m?(?:[^\w.,].*)?"),
    re.compile(rf"(?:.*[^\w.,+-])?{_NUMBER} ?m"),
)
"""Labels that seem to hold a place, some without the body: "beam@2.5", "A1 rail 9,10 m", "x=2.5m", "Hit 7.80m".

Behind other words a number alone, as in "A1 rail 2", may count sensors: it needs decimals or the unit.
"""


def write_skeleton(folder: Path) -> dict[str, Any]:
    """Write `campaign.toml` and `model.toml` into a folder of lab exports; nothing is written before all is read.

    What nobody but the user knows is left out, as a comment that begins with "question": where sensors stand,
    speeds, numbers of blows. Until they are answered the campaign is refused, each time with what is missing. A
    label that holds body and place (`"rail@10.5"`) is proposed as the answer.

    Parameters
    ----------
    folder : Path

    Returns
    -------
    dict
        `campaign`, `model`, `files` (a row each), `sensors`, `points`, `records` and `questions`, their numbers.

    Raises
    ------
    InputError
        If there is nothing to read, or one of the two files is there.
    """
    folder = Path(folder)
    for name in (CAMPAIGN, MODEL):
        if (folder / name).exists():
            raise InputError("is there already", where=str(folder / name), remedy="move it away, or go on with it")
    exports = read_folder(folder)
    started = Skeleton(exports)
    campaign, model = started.text(folder.resolve().name), model_text(started.body)
    prepare_folder(folder, (CAMPAIGN, MODEL))
    return {
        "campaign": str(write_text(folder / CAMPAIGN, campaign)),
        "model": str(write_text(folder / MODEL, model)),
        "files": [{"file": str(one.path), "format": one.format or "unknown", **one.shows} for one in exports],
        "sensors": len(started.sensors),
        "points": len(started.forces),
        "records": len(started.records),
        "questions": campaign.count("# question") + model.count("# question"),
    }


class Skeleton:
    """Sensors, force points and records of all files, each under one name.

    Parameters
    ----------
    exports : sequence of Export
    """

    def __init__(self, exports: Sequence[Export]) -> None:
        self.exports = exports
        self.sensors: dict[str, StatedTable] = {}
        self.forces: dict[str, StatedTable] = {}
        self.records: list[tuple[str, StatedTable, Export]] = []
        for export in exports:
            names = _named(self.sensors, export.sensors, export, ("quantity", "unit"))
            points = _named(self.forces, export.forces, export, ("unit",))
            for record in export.records:
                renamed = dict(record.table)
                for key, known in (("channels", names), ("responses", names), ("references", points)):
                    if key in renamed:
                        renamed[key] = {label: known.get(name, name) for label, name in renamed[key].items()}
                name = self._record_name(export, record.table)
                self.records.append((name, StatedTable(renamed, record.unstated), export))

    @property
    def body(self) -> str:
        """What the model begins with."""
        held = [_held(name)["body"] for name in (*self.sensors, *self.forces)]
        return first_body({one for one in held if one})

    def text(self, title: str) -> str:
        """The campaign file."""
        lines = [
            '# Started by `permway new`. Answer what begins with "question": correct the value; if the line',
            '# begins with #, delete that #. "option" lines may stay. Then: permway check campaign.toml',
            "format = 1",
            f"title = {_quoted(title)}",
            f"model = {_quoted(MODEL)}",
            "",
        ]
        for key, found in (("sensors", self.sensors), ("forces", self.forces)):
            for name, one in found.items():
                place = _place(name, one.table, key, self.body)
                lines += [f"[[{key}]]", f"name = {_quoted(name)}", *place, *_unit(one), ""]
        lines += [line for name in self._conditions() for line in (*_condition(*name), "")]
        for name, record, export in self.records:
            lines += [*_record(name, record, export), ""]
        lines += [
            "# question: which numbers of the model are not known exactly, and how well? One table each:",
            "# [[parameters]]",
            *parameter_lines(self.body),
            "# tolerance_2sigma = 0.3            # 30 %: two standard deviations, relative",
            "",
        ]
        for export in self.exports:
            if not export.records:
                lines += [f"# {export.path}: {remark}" for remark in _plain(export.remarks)]
        return "\n".join(lines).rstrip() + "\n"

    def _record_name(self, export: Export, record: Mapping[str, Any]) -> str:
        taken = {name for name, *_ in self.records}
        stem = export.path.stem
        return next(
            name
            for name in (stem, f"{stem} {record['name']}", str(export.path), f"{export.path} {len(taken)}")
            if name not in taken
        )

    def _conditions(self) -> Iterator[tuple[str, str]]:
        struck = any(record.table["statistic"] == "frf" for _, record, _ in self.records)
        if struck:
            yield HAMMER, "hammer"
        for name, record, _ in self.records:
            if record.table["statistic"] != "frf":
                yield name, "train"


def _named(
    known: dict[str, StatedTable], tables: Sequence[StatedTable], export: Export, alike: Sequence[str]
) -> dict[str, str]:
    """Names under which a file's sensors or points are known: one of another unit is another."""
    names: dict[str, str] = {}
    for one in tables:
        name = str(one.table["name"])
        other = known.get(name)
        if other is not None and any(other.table.get(key) != one.table.get(key) for key in alike):
            name = f"{name} ({export.path})"
        # A file that states the unit answers for those that do not.
        if name not in known or len(one.unstated) < len(known[name].unstated):
            known[name] = one
        names[str(one.table["name"])] = name
    return names


def _held(name: str) -> dict[str, str]:
    """Body and x that a label seems to hold, "" for each that it does not."""
    match = next((found for found in (one.fullmatch(name) for one in NAMED) if found), None)
    held = {"body": "", "x": ""} | (match.groupdict() if match else {})
    return held | ({"body": held["body"].lower()} if held["body"].lower() in BODIES else {})


def _place(name: str, table: Mapping[str, Any], key: str, first: str) -> list[str]:
    """Body and place: what the file states, or a question, with what the label seems to say as its answer."""
    x, held = float(table.get("x_m", 0.0)), _held(name)
    body = held["body"] or first
    at = f"{float(held['x'].replace(',', '.')):.9g}" if held["x"] else "0.0"
    on, where = "on which body of the model?", "where on it, m?"
    if held["body"]:
        on += " By its name this one."
    if held["x"]:
        where += " By its name here"
    if key == "sensors":
        on += ' On the vehicle: degree = "car1.wheelset1" and no x_m'
    up = "is up positive?" if key == "sensors" else "is a push up positive?"
    return [
        _asked(f"body = {_quoted(body)}", f"question: {on}"),
        f"x_m = {x:.9g}" if x else _asked(f"x_m = {at}", f"question: {where}"),
        _asked('direction = "up"', f"option: {up} By default down"),
    ]


def _asked(line: str, remark: str) -> str:
    """A line that is no statement yet, and what it needs."""
    return f"# {line:<33}# {remark}"


def _unit(one: StatedTable) -> list[str]:
    keys = [key for key in ("quantity", "unit") if key in one.table]
    lines = [f"{key} = {_quoted(one.table[key])}" for key in keys]
    if "unit" in one.unstated:
        return [_asked(line, NO_SAYING) for line in lines]
    return lines


def _condition(name: str, kind: str) -> list[str]:
    lines = ["[[conditions]]", f"name = {_quoted(name)}", f"kind = {_quoted(kind)}"]
    if kind == "train":
        lines.append(_asked("speed_km_per_h = 100.0", "question: how fast?"))
    return [*lines, _asked("temperature_C = 15.0", "option: how warm? Asked for where a law depends on it")]


def _record(name: str, found: StatedTable, export: Export) -> list[str]:
    record = found.table
    struck = record["statistic"] == "frf"
    stated = ", ".join(value for value in export.shows.values() if value)
    lines = [
        "[[records]]",
        f"# {stated}",
        *(f"# {remark}" for remark in _plain(export.remarks)),
        f"name = {_quoted(name)}",
        f"file = {_quoted(export.path.as_posix())}",
        f"condition = {_quoted(HAMMER if struck else name)}",
        f"statistic = {_quoted(record['statistic'])}",
    ]
    for key, value in record.items():
        if key in ("name", "file", "condition", "statistic"):
            continue
        if key in found.unstated or (key == "sampling_Hz" and not value):
            line = f"{key} = {json.dumps(value)}"
            lines.append(_asked(line, NO_SAYING))
        elif isinstance(value, dict):
            lines.append(f"{key} = {_labels(value)}")
        else:
            lines.append(f"{key} = {json.dumps(value, ensure_ascii=False)}")
    return [*lines, _asked("band_Hz = [5.0, 500.0]", "option: which band is to be trusted? By default all")]


def _labels(pairs: Mapping[str, Any]) -> str:
    """Labels that are names as a list."""
    if all(label == name for label, name in pairs.items()):
        return json.dumps(list(pairs), ensure_ascii=False)
    return "{ " + ", ".join(f"{_quoted(a)} = {json.dumps(b, ensure_ascii=False)}" for a, b in pairs.items()) + " }"


def _plain(remarks: Sequence[str]) -> list[str]:
    return [" ".join(remark.split()) for remark in remarks]


def _quoted(text: object) -> str:
    """A text as TOML quotes it, which is as JSON does."""
    return json.dumps(str(text), ensure_ascii=False)
