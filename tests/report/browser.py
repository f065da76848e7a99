"""A real browser for the tests: Chromium of the system, driven by Playwright, headless."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

PLACES = ("chromium", "chromium-browser", "google-chrome")
PHONE, DESK = (390, 844), (1280, 900)

LONGEST_MS = 180_000
"""For a page with many plots on a busy machine."""


@contextmanager
def opened(path: Path, size: tuple[int, int] = DESK) -> Iterator[tuple[Any, list[str]]]:
    """A page in a browser, and what it complains of: errors, and requests for anything but itself.

    Skips the test where there is no browser.
    """
    found = next((where for name in PLACES if (where := shutil.which(name))), None)
    if found is None:
        pytest.skip(f"no browser: none of {', '.join(PLACES)} is installed")
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=found, args=["--no-sandbox"])
        try:
            page = browser.new_page(viewport={"width": size[0], "height": size[1]})
            page.set_default_timeout(LONGEST_MS)
            complaints: list[str] = []
            page.on("console", lambda m: complaints.append(m.text) if m.type == "error" else None)
            page.on("pageerror", lambda error: complaints.append(str(error)))
            page.on("request", lambda r: _note(r.url, path, complaints))
            page.goto(path.as_uri())
            page.wait_for_load_state("load")
            yield page, complaints
        finally:
            browser.close()


def _note(url: str, path: Path, complaints: list[str]) -> None:
    if not url.startswith(("data:", "blob:")) and url != path.as_uri():
        complaints.append(f"asks for {url}")


def overflow(page: Any) -> int:
    """Pixels by which the page is wider than its window."""
    return int(page.evaluate("document.documentElement.scrollWidth - window.innerWidth"))


def hidden(page: Any) -> list[str]:
    """Texts that begin beyond the window's right edge and lie in nothing that scrolls."""
    script = """() => {
      const scrolls = e => { for (; e; e = e.parentElement)
        if (['auto', 'scroll'].includes(getComputedStyle(e).overflowX)) return true; return false; };
      return [...document.querySelectorAll('p, li, h1, h2, h3, a, td, th, figcaption')]
        .filter(e => e.offsetParent && e.getBoundingClientRect().left >= window.innerWidth && !scrolls(e))
        .map(e => e.textContent.trim().slice(0, 40));
    }"""
    return list(page.evaluate(script))


def pictures(page: Any) -> tuple[int, int]:
    """Images on the page, and those of them that were not drawn."""
    script = "[document.images.length, [...document.images].filter(i => !(i.complete && i.naturalWidth)).length]"
    count, broken = page.evaluate(script)
    return int(count), int(broken)


def smallest_print(page: Any) -> float:
    """The smallest type of running text, px."""
    script = """Math.min(...[...document.querySelectorAll('p, li, td, th, figcaption')]
      .filter(e => e.offsetParent && e.textContent.trim()).map(e => parseFloat(getComputedStyle(e).fontSize)))"""
    return float(page.evaluate(script))
