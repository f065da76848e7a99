"""Tables of the pages on a phone: lists of their rows, with nothing to scroll sideways."""

from __future__ import annotations

from pathlib import Path

import permway
import pytest
from browser import DESK, PHONE, opened

TEMPLATES = Path(permway.__file__).parent / "report" / "templates"
HEADS = ("Effect", "Place", "Mechanics", "Gain", "Followed")
WIDE = (
    "fastener_loss",
    "pad at 6 m of the first span",
    "0.2 of the stiffness is left over one metre",
    "5.1",
    "no",
)
MANY = [f"{10.0 * 1.26**i:.4g}" for i in range(20)]


def table(heads: tuple[str, ...] | list[str], cells: tuple[str, ...] | list[str]) -> str:
    head = "".join(f"<th>{text}</th>" for text in heads)
    row = "".join(f"<td style='white-space: nowrap'>{text}</td>" for text in cells)
    return f"<div class='scroll'><table><thead><tr>{head}</tr></thead><tbody><tr>{row}</tr></tbody></table></div>"


@pytest.fixture
def page(tmp_path: Path) -> Path:
    css, script = ((TEMPLATES / name).read_text("utf-8") for name in ("paper.css", "readout.js"))
    tables = table(HEADS, WIDE) + table(("a", "b"), ("1", "2")) + table(MANY, MANY)
    path = tmp_path / "page.html"
    head = f"<!DOCTYPE html><meta name='viewport' content='width=device-width'><style>{css}</style>"
    path.write_text(f"{head}<main>{tables}</main><script>{script}</script>", "utf-8")
    return path


def state(page: object) -> list[tuple[bool, bool]]:
    """Of each table whether it is a list, and whether it has to be scrolled."""
    script = """() => [...document.querySelectorAll('.scroll')].map(frame => [
      frame.firstElementChild.classList.contains('stack'), frame.scrollWidth > frame.clientWidth + 1])"""
    return [tuple(one) for one in page.evaluate(script)]  # type: ignore[attr-defined]


def test_a_wide_table_is_a_list_on_a_phone(page: Path) -> None:
    with opened(page, PHONE) as (shown, complaints):
        assert complaints == []
        assert state(shown) == [(True, False), (False, False), (False, True)]
        labels = shown.evaluate("[...document.querySelectorAll('td[data-label]')].map(c => c.dataset.label)")
        assert labels == list(HEADS[1:])


def test_on_a_desk_it_stays_a_table(page: Path) -> None:
    with opened(page, DESK) as (shown, complaints):
        assert complaints == []
        assert not any(listed for listed, _ in state(shown))
