"""The report on the paper: one page and one file of numbers."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

from permway.files import prepare_folder, write_text
from permway.paper.report_tables import count
from permway.paper.reproduce import Reproduction, reproduce
from permway.response.receptance import Progress

PAGE, NUMBERS = "report.html", "tables.json"


def write_report(output: Path, *, threads: int | None = None, progress: Progress | None = None) -> dict[str, Any]:
    """Reproduce the paper, and write its figures and tables.

    Parameters
    ----------
    output : Path
        Folder for `report.html` and `tables.json`; made if its parent exists.
    threads : int, optional
        By default all processors.
    progress : callable, optional
        Called with (done, total).

    Returns
    -------
    dict
        Paths, how many rows of the tables hold, are missed and open, how many statements hold, and seconds.

    Raises
    ------
    InputError
        If the folder cannot be written; raised before the work.
    """
    output = Path(output)
    prepare_folder(output, (PAGE, NUMBERS))
    started = time.perf_counter()
    result = reproduce(threads=threads, progress=progress)
    return {**write_result(result, output), "seconds": round(time.perf_counter() - started, 1)}


def write_result(result: Reproduction, output: Path) -> dict[str, Any]:
    """Write page and numbers of a reproduction that is there already. See :func:`write_report`."""
    # Drawing is slow to import and not needed for the numbers.
    from permway.paper.page import render

    prepare_folder(output, (PAGE, NUMBERS))
    numbers = json.dumps(result.tables(), allow_nan=False, indent=1, ensure_ascii=False) + "\n"
    page = render(result)
    return {
        "tables": str(write_text(output / NUMBERS, numbers)),
        "report": str(write_text(output / PAGE, page)),
        "rows held": count(result.rows, "holds"),
        "rows missed": count(result.rows, "missed"),
        "rows open": count(result.rows, "open"),
        "statements": f"{sum(s.holds for s in result.statements)} of {len(result.statements)} hold",
    }
