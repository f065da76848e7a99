"""Counts the words of the site, page by page: run `python docs/count_words.py`.

A page counts with what it includes: files of the repository, examples, the catalogue of effects. Docstrings on the
pages of the Python reference do not count; they belong to the code.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

DOCS = Path(__file__).parent
sys.path.insert(0, str(DOCS / "_extensions"))

import effects_page  # noqa: E402

_WHOLE = re.compile(r"% of (\S+)\s*")
_WORD = re.compile(r"[^\s]*\w[^\s]*")
_INCLUDED = re.compile(r"^```\{literalinclude\} (\S+)", re.MULTILINE)


def text(page: Path) -> str:
    """A page's source with all that it includes; an excerpt counts as the whole file.

    Parameters
    ----------
    page : Path
        A Markdown file of the site.
    """
    source = page.read_text("utf-8")
    if whole := _WHOLE.fullmatch(source):
        return (DOCS.parent / whole[1]).read_text("utf-8")
    included = [(page.parent / name).read_text("utf-8") for name in set(_INCLUDED.findall(source))]
    return "\n".join([effects_page.page(source), *included])


def pages() -> list[Path]:
    """Every Markdown file that the site is made of."""
    outside = {"_build", "_extensions", "examples"}
    return sorted(p for p in DOCS.rglob("*.md") if not outside & set(p.relative_to(DOCS).parts))


def words() -> dict[str, int]:
    """Words by page: what stands between blanks and holds a letter or a digit, so no rule of a table."""
    return {page.relative_to(DOCS).as_posix(): len(_WORD.findall(text(page))) for page in pages()}


if __name__ == "__main__":
    counts = words()
    for name, count in sorted(counts.items(), key=lambda item: -item[1]):
        print(f"{count:6} {name}")
    print(f"{sum(counts.values()):6} in all")
