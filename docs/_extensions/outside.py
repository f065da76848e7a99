"""Pages whose text lies at the top of the repository, so that it is written once.

A page holding `% of FILE` alone becomes that file, its links turned to where they lead from here.
"""

from __future__ import annotations

import re
from pathlib import Path

from sphinx.application import Sphinx

ROOT = Path(__file__).parents[2]
_LINK = re.compile(r"(?<=\])\(([^)\s]+)\)")


def _turned(match: re.Match[str]) -> str:
    target = match[1]
    if "://" in target or target.startswith("#"):
        return match[0]
    if target.startswith("docs/"):
        return f"({target.removeprefix('docs/')})"
    # What is no page of the site stays a file of the repository.
    pages = {
        "benches/README.md": "performance.md",
        "README.md": "readme.md",
        "CONTRIBUTING.md": "contributing.md",
        "CHANGELOG.md": "changelog.md",
    }
    path, hash_, heading = target.partition("#")
    return f"({pages[path]}{hash_}{heading})" if path in pages else "(#file)"


def _read(app: Sphinx, docname: str, source: list[str]) -> None:
    pointer = re.fullmatch(r"% of (\S+)\s*", source[0])
    if pointer is None:
        return
    text = (ROOT / pointer[1]).read_text("utf-8")
    app.env.note_dependency(str(ROOT / pointer[1]))
    text = _LINK.sub(_turned, text)
    source[0] = re.sub(r"\[([^\]]*)\]\(#file\)", r"`\1`", text)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the reading."""
    app.connect("source-read", _read)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
