"""How a line, a model or a campaign shows itself in a notebook.

The drawing lies in a package above those that are drawn, so it is handed in from there.
"""

from __future__ import annotations

from collections.abc import Callable

_draw: Callable[[object], str] | None = None


def draw_with(draw: Callable[[object], str]) -> None:
    """Use a function from an object to HTML for all objects shown from now on."""
    global _draw
    _draw = draw


class Shown:
    """An object that notebooks show as a drawing."""

    def _repr_html_(self) -> str | None:
        return None if _draw is None else _draw(self)
