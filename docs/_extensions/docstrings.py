"""Docstrings are written to be read as they are: a bar in them is a bar, not a substitution."""

from __future__ import annotations

import re
from typing import Any

from sphinx.application import Sphinx

_LITERAL = re.compile(r"(``.+?``|`[^`]+`)")


def _escaped(app: Sphinx, what: str, name: str, thing: object, options: Any, lines: list[str]) -> None:
    for index, line in enumerate(lines):
        parts = _LITERAL.split(line)
        parts[::2] = [part.replace("|", r"\|") for part in parts[::2]]
        lines[index] = "".join(parts)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the escaping, after napoleon's turn."""
    app.connect("autodoc-process-docstring", _escaped, priority=900)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
