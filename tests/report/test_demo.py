"""The demonstration: what it says of a campaign that comes with the package, how that was made, and its page."""

from __future__ import annotations

import contextlib
import io
import json
import tomllib
from dataclasses import dataclass
from pathlib import Path

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
    """What the command said and opened."""

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


def test_a_folder_that_cannot_be_made_is_said_before_the_work(tmp_path: Path) -> None:
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


def test_its_page_prints(shown: Shown) -> None:
    with opened(shown.report, (794, 1123)) as (page, complaints):
        page.emulate_media(media="print")
        assert overflow(page) == 0
        assert page.evaluate("[...document.images].every(i => i.getBoundingClientRect().right <= 794)")
        assert page.pdf(format="A4").startswith(b"%PDF")
        assert complaints == []
