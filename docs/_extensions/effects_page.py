"""The page of the catalogue, from the names of its modules: an effect added there is on the page."""

from __future__ import annotations

import re
from itertools import groupby

from permway.diagnosis.catalogue import entries
from permway.diagnosis.hypothesis import Entry
from sphinx.application import Sphinx

TITLES = {
    "path": "Track and structure",
    "irregularity": "Irregularity and contact",
    "vehicle": "Vehicle",
    "measurement": "Measurement",
}

MARKER = re.compile(r"^% effects.*$", re.MULTILINE)
"""The line of the page that the effects replace."""

RANGE = re.compile(r"^(?P<unit>\S+), (?P<range>\S+ to \S+): ")
"""How most parameters begin: "Hz, 4 to 1000: ", or "1, 0 to 1: " where there is no unit."""


def _section(entry: Entry) -> list[str]:
    lines = [f"({entry.ID})=", f"### `{entry.ID}`", "", entry.SUMMARY, ""]
    lines += ["| parameter | range and meaning |", "|---|---|"]
    lines += [f"| `{name}` | {_cell(_ranged(text))} |" for name, text in entry.PARAMETERS.items()]
    lines += ["", f"- **Signature.** {entry.SIGNATURE}"]
    lines += [f"- **Confused with** `{other}`: {_cell(text)}." for other, text in entry.CONFUSED_WITH.items()]
    lines += [f"- **Family** {entry.FAMILY}. **Source**: {entry.SOURCE}.", ""]
    return lines


def _ranged(text: str) -> str:
    """The unit behind the range, and no "1" for a ratio: beside a range it looks like a value."""
    found = RANGE.match(text)
    if found is None:
        return text.removeprefix("1, ")
    unit = "" if found["unit"] == "1" else f" {found['unit']}"
    return f"{found['range']}{unit}: {text[found.end() :]}"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def page(source: str) -> str:
    """The page's source with the effects in it."""
    order = list(TITLES)
    known = sorted(entries().values(), key=lambda e: (order.index(e.DOMAIN), e.ID))
    lines: list[str] = []
    for domain, group in groupby(known, key=lambda e: e.DOMAIN):
        lines += [f"## {TITLES[domain]}", ""]
        for entry in group:
            lines += _section(entry)
    # The rest of the marker's line is for readers of the source, where the list is not.
    return MARKER.sub(lambda _: "\n".join(lines), source).replace("% count", str(len(known)))


def _read(app: Sphinx, docname: str, source: list[str]) -> None:
    if not MARKER.search(source[0]):
        return
    app.env.note_reread()
    source[0] = page(source[0])


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the reading."""
    app.connect("source-read", _read)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
