"""The page of five exports: every step of it is done, and shows what the page shows."""

from __future__ import annotations

import json
import re
from pathlib import Path

import exports
import pytest
from permway.cli import app
from typer.testing import CliRunner

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "five-exports.md").read_text("utf-8")
FILES = {
    file: (int(channels), noise, raw)
    for file, channels, noise, raw in re.findall(
        r"^\| `(\S+)` \| .* \| (\d+) \| ([\d.]+) \| ([\d.]+) \|$", PAGE, re.MULTILINE
    )
}
"""Of each file: channels, and what its comparison states, as printed."""
PLACES = {
    "rail": ("rail", 6.0), "deck": ("deck", 3.0), "106:-Z": ("rail", 6.0), "203:-Z": ("deck", 3.0),
    "hit rail 6.0": ("rail", 6.0), "hit rail 9.3": ("rail", 9.3), "hit deck 4.5": ("deck", 4.5),
    "hit 106:-Z": ("rail", 6.0), "hit 109:-Z": ("rail", 9.3), "hit 204:-Z": ("deck", 4.5),
    "axlebox1": "car1.wheelset1", "axlebox3": "car1.wheelset3",
}  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    found = tmp_path_factory.mktemp("deck")
    exports.write(found)
    return found


def command(*words: str) -> str:
    done = CliRunner().invoke(app, list(words))
    assert done.exit_code == 0, done.output
    return done.output


def completed(part: str, run: bool) -> str:
    """The part of a campaign file with what the page's table states filled in."""
    lines, name = [], ""
    for line in part.splitlines():
        key = line.partition(" ")[0]
        if key == "name":
            name = json.loads(line.partition("=")[2])
        place = PLACES.get(name)
        if key in ("body", "x_m") and isinstance(place, str):
            lines += [f'degree = "{place}"', "chain = { noise_floor = 1.0e-5 }"] if key == "body" else []
        elif key in ("body", "x_m") and place is not None:
            lines.append(f"{key} = {json.dumps(place[0] if key == 'body' else place[1])}")
        elif key == "condition":
            lines += [
                f'condition = "{"slow" if run else "still"}"',
                f"band_Hz = {'[4, 90]' if run else '[8, 200]'}",
            ]
        else:
            lines.append("averages = 16" if key == "averages" else line)
    return "\n".join(lines)


def test_the_first_file_is_shown_as_the_page_shows_it(folder: Path) -> None:
    shown = [line.split() for line in command("look", str(folder / "blows.csv")).splitlines()]
    (block,) = re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL)
    rows = [line.split() for line in block.splitlines()]
    assert len(rows) == 8
    assert [row for row in shown if row in rows] == rows


@pytest.mark.parametrize("file", FILES)
def test_from_the_file_to_a_comparison(file: str, folder: Path) -> None:
    run = file.startswith("run")
    part = json.loads(command("look", str(folder / file), "--json"))["campaign"]
    deck = (folder / "campaign.toml").read_text()
    top = deck[: deck.index("# What was read")]
    conditions = deck[deck.index("[[conditions]]") : deck.index("[[records]]")]
    path = folder / f"campaign of {file}.toml"
    path.write_text("\n".join([top, conditions, completed(part, run)]))
    words = ("compare", str(path), "--raw-only", "--threads", "1", "-o", str(folder / f"page of {file}"), "--json")
    (fit,) = json.loads(command(*words))["fits"]
    channels, *printed = FILES[file]
    assert fit["channels"] == channels
    for value, text in zip((fit["noise_dB_rms"], fit["raw_dB_rms"]), printed, strict=True):
        assert value == pytest.approx(float(text), abs=0.505 * 10.0 ** -len(text.partition(".")[2]))


def test_all_five_are_on_the_page() -> None:
    assert set(FILES) == {*exports.WRITERS, "run_144.tdms"}
