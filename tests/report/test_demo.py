"""The demonstration: its result for a campaign that comes with the package, how that was made, and its page."""

from __future__ import annotations

import contextlib
import io
import json
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import DESK, PHONE, hidden, opened, overflow, pictures, smallest_print
from permway.cli import app
from permway.demo import make, run
from permway.demo.run import CAMPAIGN, campaign_files
from permway.errors import InputError
from permway.recordings.readers import read_frf


@dataclass(frozen=True)
class Shown:
    """What the command stated and opened."""

    folder: Path
    out: str
    status: int
    opened: list[str]

    @property
    def report(self) -> Path:
        return self.folder / "diagnosis" / "report.html"


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> Shown:
    folder, out, addresses = tmp_path_factory.mktemp("demo") / "demo", io.StringIO(), list[str]()
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(out):
        patch.setattr("webbrowser.open", addresses.append)
        with pytest.raises(SystemExit) as end:
            app(["demo", "-o", str(folder), "--threads", "1"], prog_name="permway")
    return Shown(folder, out.getvalue(), int(end.value.code or 0), addresses)


def test_the_embedded_campaign_is_what_its_maker_makes(tmp_path: Path) -> None:
    """By the generator that shares no code with the solver; the last digits are the machine's."""
    make.make(tmp_path)
    kept = campaign_files()
    assert sum(map(len, kept.values())) < 100_000
    for name in ("campaign.toml", "model.toml"):
        assert tomllib.loads(kept[name].decode()) == tomllib.loads((tmp_path / name).read_text())
    assert json.loads(kept["truth.json"]) == json.loads((tmp_path / "truth.json").read_text())
    (tmp_path / "kept.mat").write_bytes(kept["hammer_+12C.mat"])
    made, packed = read_frf(tmp_path / "hammer_+12C.mat"), read_frf(tmp_path / "kept.mat")
    assert (made.responses, made.references) == (packed.responses, packed.references)
    np.testing.assert_allclose(made.values, packed.values, rtol=1e-5)


def test_what_is_concealed_is_found_and_the_report_opened(shown: Shown) -> None:
    assert shown.status == 0
    assert "fasteners between 4.8 and 6.72 m keep 0.05 of k" in shown.out
    assert shown.opened == [shown.report.as_uri()]
    assert {path.name for path in (shown.folder / "campaign").iterdir()} == set(CAMPAIGN)
    verdict = json.loads((shown.folder / "diagnosis" / "verdict.json").read_text())
    assert verdict["status"] == "named"
    (effect,) = verdict["effects"]
    assert effect["name"] == "fastener_loss"
    low, high = effect["place"]["x"]
    # Between the last fastener that holds and the first that is lost nothing can tell.
    assert 4.48 <= low <= 5.12 + 1e-6
    assert 6.4 - 1e-6 <= high <= 7.04
    assert effect["parameters"]["factor"]["value"] == pytest.approx(0.05, abs=0.02)


def test_a_folder_that_cannot_be_made_is_reported_before_the_work(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no such folder"):
        run(tmp_path / "no" / "demo")


@pytest.mark.parametrize("size", [DESK, PHONE], ids=["desk", "phone"])
def test_its_page_fits_and_asks_for_nothing(shown: Shown, size: tuple[int, int]) -> None:
    with opened(shown.report, size) as (page, complaints):
        count, broken = pictures(page)
        assert count >= 5
        assert broken == 0
        assert complaints == []
        assert overflow(page) == 0
        assert hidden(page) == []
        assert smallest_print(page) >= 11.0
        # What is folded away opens.
        page.locator("details summary").first.click()
        assert page.locator("details[open]").count() == 1
        assert overflow(page) == 0
        for link in page.locator("nav a").all():
            assert page.locator(link.get_attribute("href")).count() == 1


def test_its_pictures_state_what_lies_under_the_pointer_and_grow_when_clicked(shown: Shown) -> None:
    with opened(shown.report, (1280, 3000)) as (page, complaints):
        page.evaluate("document.querySelectorAll('details').forEach(one => { one.open = true })")
        shots = page.locator("figure.shot")
        telling = 0
        for index in range(shots.count()):
            shot = shots.nth(index)
            panels = json.loads(shot.locator("script").text_content())
            shot.scroll_into_view_if_needed()
            area = shot.locator("img").bounding_box()
            for panel in panels:
                # A point of the first line, or the middle of the first map's first row.
                x, y = _point(panel)
                left, top, right, bottom = panel["box"]
                across = left + (right - left) * _share(panel["x"], x)
                down = bottom - (bottom - top) * _share(panel["y"], y)
                page.mouse.move(area["x"] + across * area["width"], area["y"] + down * area["height"])
                stated = shot.locator("output.readout").inner_text()
                label = panel["lines"][0]["label"] if panel["lines"] else panel["x"]["label"]
                assert label in stated
                telling += 1
        assert telling >= 5
        image = shots.first.locator("img")
        before = image.bounding_box()["width"]
        image.click()
        assert image.bounding_box()["width"] > 1.3 * before
        assert overflow(page) == 0
        image.click()
        assert image.bounding_box()["width"] == pytest.approx(before)
        assert complaints == []


def _point(panel: dict[str, Any]) -> tuple[float, float]:
    if panel["lines"]:
        line = panel["lines"][0]
        inside = [
            (x, y)
            for x, y in zip(line["x"], line["y"], strict=True)
            if 0.0 <= _share(panel["x"], x) <= 1.0 and 0.0 <= _share(panel["y"], y) <= 1.0
        ]
        return inside[len(inside) // 2]
    edges = panel["maps"][0]
    middle = len(edges["x"]) // 2
    return 0.5 * (edges["x"][middle] + edges["x"][middle + 1]), 0.5 * (edges["y"][0] + edges["y"][1])


def _share(scale: dict[str, Any], value: float) -> float:
    """How far along an axis a value stands."""
    low, high = scale["limits"]
    if scale["log"]:
        return float(np.log(value / low) / np.log(high / low))
    return float((value - low) / (high - low))


def test_its_page_prints(shown: Shown) -> None:
    with opened(shown.report, (794, 1123)) as (page, complaints):
        page.emulate_media(media="print")
        assert overflow(page) == 0
        assert page.evaluate("[...document.images].every(i => i.getBoundingClientRect().right <= 794)")
        assert page.pdf(format="A4").startswith(b"%PDF")
        assert complaints == []
