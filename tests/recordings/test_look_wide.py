"""`permway look` reads a table as `permway new` does, and says what helps where it cannot."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from permway.cli import app
from permway.recordings.lab_folder import read_folder
from permway.recordings.look import look
from permway.recordings.skeleton import write_skeleton
from typer.testing import CliRunner

HEAD = (
    "Frequency [Hz],beam@2.5 Real [(m/s2)/N],beam@2.5 Imag [(m/s2)/N],beam@2.5 Coherence,"
    "Acc x=7.3m Real [(m/s2)/N],Acc x=7.3m Imag [(m/s2)/N]"
)


@pytest.fixture
def wide(tmp_path: Path) -> Path:
    (folder := tmp_path / "exports").mkdir()
    rows = [f"{f},1,2,0.99,3,{f}" for f in range(10, 60, 2)]
    (folder / "beam@4.csv").write_text("\n".join([HEAD, *rows]) + "\n")
    return folder / "beam@4.csv"


def test_a_wide_table_is_looked_at_as_it_is_begun_with(wide: Path) -> None:
    done = CliRunner().invoke(app, ["look", str(wide), "--json"])
    assert done.exit_code == 0
    seen = json.loads(done.stdout)
    assert seen["responses"]["read"] == ["beam@2.5", "Acc x=7.3m"]
    assert seen["responses"]["struck"] == ["beam@4"]
    assert seen["notes"] == ["what was struck stands in no column, and is taken from the file's name: 'beam@4'"]
    assert '"beam@2.5" = ["beam@2.5", "beam@4"]' in seen["campaign"]
    (export,) = read_folder(wide.parent)
    assert export.shows["holds"] == "2 x 1 responses"


def test_a_table_over_frequency_states_what_it_lacks_of_responses(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("Frequency [Hz],a Real [g/N],b Imag [g/N]\n10,1,2\n20,1,2\n")
    (problem,) = look(path)["problems"]
    assert "has no column of its" in problem or "what was read and what was struck" in problem


@pytest.mark.parametrize(
    ("label", "body", "x"),
    [
        ("beam@2.5", "beam", "2.5"),
        ("hit beam@2.5", "beam", "2.5"),
        ("Acc left_rail @ 7,3 m", "left_rail", "7.3"),
        ("beam@x=2.5m", "beam", "2.5"),
        ("rail@-3", "rail", "-3"),
        ("beam@02.50", "beam", "2.5"),
        ("hit deck 4.5 m", "deck", "4.5"),
        ("Acc x=2.5m", "rail", "2.5"),
        ("x = 2.5 m, left", "rail", "2.5"),
        ("max=3", "rail", "0.0"),
        ("x=25mm", "rail", "0.0"),
        ("beam@100Hz", "rail", "0.0"),
        ("P3", "rail", "0.0"),
    ],
)
def test_labels_propose_their_places(tmp_path: Path, label: str, body: str, x: str) -> None:
    (folder := tmp_path / "exports").mkdir()
    quoted = [f'{f},"{label}",p,1,2,0.9' for f in range(10, 60, 2)]
    (folder / "a.csv").write_text(
        "\n".join(["frequency [Hz],sensor,point,real [(m/s2)/N],imag [(m/s2)/N],coherence", *quoted]) + "\n"
    )
    write_skeleton(folder)
    lines = (folder / "campaign.toml").read_text("utf-8").splitlines()
    at = lines.index(f'name = "{label}"')
    proposed, place = lines[at + 1], lines[at + 2]
    assert proposed.startswith(f'# body = "{body}"')
    assert place.split("#")[1].strip() == f"x_m = {x}"
    assert "?." not in proposed
