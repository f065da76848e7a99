"""The paper's page in a real browser: nothing asked of the network, no complaint, plots that answer."""

from __future__ import annotations

import pytest
from browser import DESK, PHONE, hidden, opened, overflow, smallest_print
from conftest import Report


@pytest.mark.parametrize("size", [DESK, PHONE], ids=["desk", "phone"])
def test_the_papers_page_fits_and_asks_for_nothing(report: Report, size: tuple[int, int]) -> None:
    with opened(report.folder / "report.html", size) as (page, complaints):
        plots = page.locator(".js-plotly-plot")
        count = plots.count()
        assert count >= 12
        for index in range(count):
            plots.nth(index).scroll_into_view_if_needed()
        page.wait_for_timeout(500)
        assert page.locator(".js-plotly-plot svg.main-svg").count() >= count
        assert page.locator(".js-plotly-plot .scatterlayer path.js-line").count() >= count
        assert complaints == []
        assert overflow(page) == 0
        assert hidden(page) == []
        assert smallest_print(page) >= 11.0


def test_its_plots_answer_to_the_mouse(report: Report) -> None:
    with opened(report.folder / "report.html") as (page, complaints):
        plot = page.locator(".js-plotly-plot").first
        plot.scroll_into_view_if_needed()
        area = plot.locator(".draglayer .nsewdrag").first.bounding_box()
        middle = (area["x"] + 0.5 * area["width"], area["y"] + 0.5 * area["height"])
        page.mouse.move(*middle)
        page.mouse.move(middle[0] + 3, middle[1])
        page.wait_for_selector(".hoverlayer .hovertext")
        before = plot.evaluate("p => p._fullLayout.xaxis.range.slice()")
        page.mouse.move(area["x"] + 0.3 * area["width"], area["y"] + 0.3 * area["height"])
        page.mouse.down()
        page.mouse.move(area["x"] + 0.6 * area["width"], area["y"] + 0.7 * area["height"], steps=5)
        page.mouse.up()
        page.wait_for_timeout(500)
        after = plot.evaluate("p => p._fullLayout.xaxis.range.slice()")
        assert before[0] < after[0] < after[1] < before[1]
        assert after[1] - after[0] == pytest.approx(0.3 * (before[1] - before[0]), rel=0.05)
        assert complaints == []


def test_it_prints_on_paper_no_wider_than_the_paper(report: Report) -> None:
    with opened(report.folder / "report.html", (794, 1123)) as (page, complaints):
        page.emulate_media(media="print")
        page.wait_for_timeout(500)
        assert overflow(page) == 0
        assert page.pdf(format="A4").startswith(b"%PDF")
        assert complaints == []
