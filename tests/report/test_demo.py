"""The demonstration: what it says of a campaign that comes with the package, how that was made, and its page."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest
import typer
from permway.cli import app
from permway.demo import make, run
from permway.demo.run import CAMPAIGN, campaign_files
from permway.recordings.readers import read_frf


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


def test_what_is_concealed_is_found_and_the_report_opened(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    with pytest.raises((SystemExit, typer.Exit)) as end:
        app(["demo", "-o", str(tmp_path / "demo"), "--threads", "1"], prog_name="permway")
    assert getattr(end.value, "code", 0) == 0
    out = capsys.readouterr().out
    assert "fasteners between 4.8 and 6.72 m keep 0.05 of k" in out
    folder = tmp_path / "demo"
    report = folder / "diagnosis" / "report.html"
    assert opened == [report.as_uri()]
    assert report.stat().st_size > 100_000
    assert {path.name for path in (folder / "campaign").iterdir()} == set(CAMPAIGN)
    verdict = json.loads((folder / "diagnosis" / "verdict.json").read_text())
    assert verdict["status"] == "named"
    (effect,) = verdict["effects"]
    assert effect["name"] == "fastener_loss"
    low, high = effect["place"]["x"]
    # Between the last fastener that holds and the first that is lost nothing can tell.
    assert 4.48 <= low <= 5.12
    assert 6.4 <= high <= 7.04
    assert effect["parameters"]["factor"]["value"] == pytest.approx(0.05, abs=0.02)


def test_a_folder_that_cannot_be_made_is_said_before_the_work(tmp_path: Path) -> None:
    from permway.errors import InputError

    with pytest.raises(InputError, match="there is no such folder"):
        run(tmp_path / "no" / "demo")
