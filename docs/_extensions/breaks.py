"""On a narrow screen a long name in a table or a heading breaks after `_` or `.`; copied, it stays whole."""

from __future__ import annotations

import re
from typing import Any

from sphinx.application import Sphinx

_NARROW = re.compile(r"<(t[dh]|h[1-6])\b.*?</\1>", re.DOTALL)
_NAME = re.compile(r'(?<=<span class="pre">)[^<]*(?=</span>)')
# Neither a unit, as in `x_m`, nor the end of a file's name stands alone.
_JOINT = re.compile(r"(?<=\w_)(?=[^\W\d_]{3})|(?<=\w\.)(?=\w{5})")


def broken(body: str) -> str:
    """A page's body with places to break in the names of its tables and headings.

    Parameters
    ----------
    body : str
        HTML.
    """
    return _NARROW.sub(lambda cell: _NAME.sub(lambda name: _JOINT.sub("<wbr>", name[0]), cell[0]), body)


def _page(app: Sphinx, name: str, template: str, context: dict[str, Any], doctree: object) -> None:
    if "body" in context:
        context["body"] = broken(context["body"])


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the breaks."""
    app.connect("html-page-context", _page)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
