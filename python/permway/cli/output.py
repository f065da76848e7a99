"""What commands share: options, progress, and how results and faults are stated."""

from __future__ import annotations

import json
import re
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import timedelta
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from permway.interrupt import interruptible

Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON, for machines.")]
Threads = Annotated[int | None, typer.Option(min=1, max=1024, help="Threads; by default all processors.")]
Outside = Annotated[
    bool,
    typer.Option("--allow-outside", help="Read files outside the campaign's folder, if the campaign names such."),
]
Scheduler = Annotated[
    str | None, typer.Option(help="Address of a Dask scheduler; by default this machine computes.")
]
Folder = Annotated[Path, typer.Argument(help="Folder to read.")]


def examples(*lines: str) -> str:
    """What stands at the end of a command's help: lines as they would be typed."""
    # The first character keeps the lines from being filled into a paragraph.
    return "\b\n" + "\n".join(["Examples:" if len(lines) > 1 else "Example:", *(f"  {line}" for line in lines)])


def over(scheduler: str | None) -> Any:
    """What does jobs on files of a folder on a cluster; None for this machine."""
    if scheduler is None:
        return None
    from permway.study.folders import on_cluster_in_folder

    return partial(on_cluster_in_folder, scheduler)


def print_message(message: object) -> None:
    """A line on stderr."""
    typer.echo(f"permway: {message}", err=True)


@contextmanager
def _unwinding() -> Iterator[None]:
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with interruptible():
        yield


@contextmanager
def progress_bar(title: str, quiet: bool) -> Iterator[Callable[[int, int], None]]:
    """A bar on the terminal; nothing when piped. Within it, and after, Ctrl-C unwinds what is under way."""
    with _unwinding():
        if quiet or not sys.stderr.isatty():
            yield lambda _done, _total: None
            return
        # A fifth of a second to load, which only a terminal needs.
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

        columns = TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn()
        with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
            task = bar.add_task(title, total=None)
            yield lambda done, total: bar.update(task, completed=done, total=total)


@contextmanager
def stage_bar(title: str, quiet: bool) -> Iterator[Callable[[str, int, int], None]]:
    """A bar that names the stage it is in, the time spent in all, and the time that is left of the stage.

    Of a stage whose length is not known it only shows that it moves.
    """
    with _unwinding():
        if quiet or not sys.stderr.isatty():
            yield lambda _stage, _done, _total: None
            return
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

        started = time.monotonic()
        columns = TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[spent]}, left of this")
        with Progress(*columns, TimeRemainingColumn(), console=Console(stderr=True), transient=True) as bar:
            task = bar.add_task(title, total=None, spent="0:00:00")
            current = ""

            def progress(stage: str, done: int, total: int) -> None:
                nonlocal current
                if stage != current:
                    # Its pace states nothing of the next stage's.
                    bar.reset(task, total=total or None)
                    current = stage
                spent = str(timedelta(seconds=int(time.monotonic() - started)))
                stated = f"{title}: {stage}"
                bar.update(task, description=stated, completed=done, total=total or None, spent=spent)

            yield progress


UNIT = re.compile(
    r"(?<!_per)_((?:dB|m|km|kg|N)_per_(?:m|s|h|N|kg|K)|(?:Hz|dB|kg|mm|km|m|s|us|deg|N|GiB)(?:_rms)?)$"
)
"""At the end of a key."""


def heading(key: str) -> str:
    """A key as people read it: "noise, dB rms" of "noise_dB_rms"."""
    found = UNIT.search(key)
    name, unit = (key[: found.start()], found.group(1)) if found else (key, "")
    words = name.replace("_", " ")
    return f"{words}, {unit.replace('_per_', '/').replace('_', ' ')}" if unit else words


def print_result(result: dict[str, Any], as_json: bool) -> None:
    """JSON on one line, or a line for each key; lists of records as columns."""
    if as_json:
        typer.echo(json.dumps(result, allow_nan=False))
        return
    width = max(len(heading(key)) for key in result)
    for key, value in result.items():
        first, *others = _lines(value)
        typer.echo(f"{heading(key):<{width}}  {first}".rstrip())
        for line in others:
            typer.echo(f"{'':<{width}}  {line}")


def _lines(value: object) -> list[str]:
    if isinstance(value, dict):
        return [f"{key}: {_text(item)}" for key, item in value.items()]
    if not isinstance(value, list):
        return [_text(value)]
    if not value or not all(isinstance(item, dict) for item in value):
        return [_text(item) for item in value] or ["none"]
    rows = [
        [heading(key) for key in value[0]],
        *([_text(item.get(key, "")) for key in value[0]] for item in value),
    ]
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return ["  ".join(f"{cell:<{w}}" for cell, w in zip(row, widths, strict=True)).rstrip() for row in rows]


def _text(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.{4 if abs(value) < 1e4 else 6}g}"
    return ", ".join(_text(item) for item in value) if isinstance(value, list) else str(value)
