"""The page of the first hour: its commands are run in a fresh folder, and print what the page prints."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from exported import TOLERANCES, answered, wide
from permway.cli import app
from typer.testing import CliRunner

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "first-hour.md").read_text("utf-8")
SHOWN = dict(re.findall(r"```text\n\$ permway (\w+) .*\n((?:.*\n)*?)```", PAGE))
"""By command, what is shown below it."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A fresh one, outside the repository, which is where the user stands."""
    fresh = tmp_path_factory.mktemp("fresh")
    (fresh / "exports").mkdir()
    wide(fresh / "exports")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(fresh)
        yield fresh


@pytest.fixture(scope="module")
def begun(folder: Path) -> str:
    """What `permway new` prints; the questions are answered then."""
    printed = command("new", "exports")
    campaign, model = (folder / "exports" / name for name in ("campaign.toml", "model.toml"))
    for path, text in zip((campaign, model), answered(campaign.read_text(), model.read_text()), strict=True):
        path.write_text(text)
    return printed


def command(*words: str) -> str:
    done = CliRunner().invoke(app, list(words))
    assert done.exit_code == 0, done.output
    return done.output


def test_the_exports_are_as_shown(folder: Path) -> None:
    head = (folder / "exports" / "rail_9.csv").read_text().splitlines()[0]
    (shown,) = re.findall(r"^(Frequency.*),\.\.\.$", PAGE, re.MULTILINE)
    assert head.startswith(shown)
    assert all(f"exports/{path.name}" in PAGE for path in (folder / "exports").glob("*.csv"))


def test_new_states_what_the_page_states(begun: str) -> None:
    assert begun == SHOWN["new"]


def test_the_page_has_the_tolerances(begun: str) -> None:
    assert f"```toml{TOLERANCES}```" in PAGE


def test_check_states_what_the_page_states(begun: str) -> None:
    assert command("check", "exports/campaign.toml") == SHOWN["check"]


@pytest.mark.injection
def test_diagnose_states_what_the_page_states(begun: str) -> None:
    """Half a minute of processor: the fastener that carries nothing."""
    printed = command("diagnose", "exports/campaign.toml", "-o", "diagnosis", "--threads", "1")
    shown = " ".join(SHOWN["diagnose"].split())
    assert " ".join(printed.split()).partition(" seconds ")[0] == shown
    assert "pad at 10.2 m" in shown
