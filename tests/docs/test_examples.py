"""The examples of the documentation: each runs, draws its picture, and computes the numbers that a page quotes."""

from __future__ import annotations

import io
import re
import shutil
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest
from matplotlib.figure import Figure

DOCS = Path(__file__).parents[2] / "docs"
EXAMPLES = sorted(p.stem for p in (DOCS / "examples").glob("*.py") if "def numbers" in p.read_text("utf-8"))
_TABLE = re.compile(r"^% numbers of (\w+)\n\n\| what \| value \|\n\|---\|---\|\n((?:\|.*\|\n)+)", re.MULTILINE)


def quoted() -> list[tuple[str, str, dict[str, str]]]:
    """Page, example, and the numbers as printed."""
    found = []
    for page in sorted(DOCS.rglob("*.md")):
        for example, rows in _TABLE.findall(page.read_text("utf-8")):
            cells = [[cell.strip() for cell in row.strip("|").split("|")] for row in rows.splitlines()]
            found.append((page.relative_to(DOCS).as_posix(), example, dict(cells)))
    return found


@pytest.fixture(scope="module", autouse=True)
def beside():
    """The examples import each other, as scripts of one folder do."""
    sys.path.insert(0, str(DOCS / "examples"))
    yield
    sys.path.remove(str(DOCS / "examples"))


@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example_computes_what_its_pages_quote(name: str) -> None:
    example = import_module(name)
    found = example.compute()
    numbers = example.numbers(found)
    tables = [(page, table) for page, which, table in quoted() if which == name]
    assert tables, f"no page quotes {name}"
    for page, table in tables:
        for what, printed in table.items():
            digits = len(printed.partition(".")[2])
            # Half a unit of the last digit printed, and a hundredth of it for rounding on the edge.
            assert numbers[what] == pytest.approx(float(printed), abs=0.505 * 10.0**-digits), f"{page}: {what}"
    figure = example.picture(found)
    assert isinstance(figure, Figure)
    figure.savefig(drawn := io.BytesIO(), dpi=40)
    assert len(drawn.getvalue()) > 2000
    assert (DOCS / "images" / "examples" / f"{name}.png").is_file()


@pytest.mark.injection
def test_the_tutorial_s_diagnosis_states_what_its_page_states(tmp_path: Path) -> None:
    """Half a minute: the two fasteners that carry 5 %, in folders made as the tutorial makes them."""
    import numpy as np
    from permway.campaign.campaign import read_campaign
    from permway.posterior.diagnose import diagnose

    import_module("make_deck").write(tmp_path)
    np.savez(tmp_path / "blows.npz", **import_module("blows_to_frf").responses(tmp_path))
    verdict = diagnose(read_campaign(tmp_path / "campaign.toml"), threads=1).verdict
    page = (DOCS / "tutorials" / "diagnosis.md").read_text("utf-8")
    assert verdict.status == "named"
    assert verdict.sentence in " ".join(page.split())
    factor = verdict.effects[0].parameters["factor"]
    assert f"{factor.value:.4f} (90 %: {factor.low:.4f} to {factor.high:.4f})" in page
    script = (DOCS / "how-to" / "verdict-script.md").read_text("utf-8")
    for name, one in verdict.effects[0].parameters.items():
        assert f"{name} = {one.value:.4g} {one.unit} ({one.low:.4g} to {one.high:.4g})" in script


def survey(folder: Path) -> Path:
    """The campaign file of the tutorial's survey, made as the tutorial makes it."""
    concealed, files = import_module("make_survey").measured()
    page = (DOCS / "tutorials" / "survey.md").read_text("utf-8")
    assert concealed in " ".join(page.split())
    (folder / "csv").mkdir()
    for name, content in files:
        (folder / "csv" / name).write_text(content)
    script = DOCS / "examples" / "survey_to_frf.py"
    subprocess.run([sys.executable, str(script), str(folder / "csv"), str(folder / "impacts.csv")], check=True)
    for path in (DOCS / "examples" / "survey").glob("*.toml"):
        shutil.copy(path, folder)
    return folder / "campaign.toml"


def test_the_survey_is_read_from_csv_as_its_page_states(tmp_path: Path) -> None:
    from permway.campaign.campaign import read_campaign

    (dataset,) = read_campaign(survey(tmp_path)).load()
    assert dict(dataset.data.sizes) == {"sensor": 6, "force": 7, "frequency": 100}
    assert bool(dataset.data["log_variance"].notnull().all())
    first = (tmp_path / "impacts.csv").read_text().splitlines()[:2]
    page = (DOCS / "tutorials" / "survey.md").read_text("utf-8")
    assert all(line in page for line in first)


@pytest.mark.injection
def test_the_survey_s_diagnosis_states_what_its_page_states(tmp_path: Path) -> None:
    """Most of a minute: the four fasteners that keep 6 %."""
    from permway.campaign.campaign import read_campaign
    from permway.posterior.diagnose import diagnose

    verdict = diagnose(read_campaign(survey(tmp_path)), threads=1).verdict
    page = (DOCS / "tutorials" / "survey.md").read_text("utf-8")
    assert verdict.status == "named"
    assert verdict.sentence in " ".join(page.split())


def test_every_example_is_in_the_gallery() -> None:
    shown = {example for page, example, _ in quoted() if page == "gallery.md"}
    assert shown == set(EXAMPLES)


def test_a_user_s_picture_is_written_where_the_user_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    look = import_module("look")
    look.show(str(DOCS / "examples" / "deck.py"), lambda: 1.0, lambda _: {"one": 1.0}, lambda _: look.axes()[0])
    assert [path.name for path in tmp_path.iterdir()] == ["deck.png"]
