"""`permway import` as a user runs it, and the campaign file of the reference."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from permway.campaign.campaign import CampaignFile
from permway.campaign.parameters import Parameter
from permway.campaign.parts import Condition, HeldOut, IrregularityKnown, Record
from permway.recordings.channel import Chain, Point, Sensor
from sheets import make_folder

REFERENCE = (Path(__file__).resolve().parents[2] / "docs" / "campaign-file.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```toml\n(.*?)^```", REFERENCE, flags=re.MULTILINE | re.DOTALL)


def permway(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "permway", *arguments], cwd=cwd, capture_output=True, text=True)


def test_import_sheet(tmp_path: Path) -> None:
    make_folder(tmp_path / "team")
    done = permway("import", "sheet", "team", "-o", "out", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    stated = json.loads(done.stdout)
    assert stated["records"] == 3
    assert (tmp_path / stated["campaign"]).is_file()


def test_a_folder_without_a_sheet_ends_in_one_line(tmp_path: Path) -> None:
    failed = permway("import", "sheet", ".", "-o", "out", cwd=tmp_path)
    assert failed.returncode == 2
    assert failed.stdout == ""
    assert failed.stderr.startswith("permway: ")
    assert failed.stderr.count("\n") == 1


@pytest.mark.parametrize("block", BLOCKS, ids=range(len(BLOCKS)))
def test_the_references_file_is_one(block: str) -> None:
    assert CampaignFile.model_validate(tomllib.loads(block)).records


@pytest.mark.parametrize(
    "record", [CampaignFile, Parameter, Sensor, Point, Chain, Condition, IrregularityKnown, Record, HeldOut]
)
def test_the_reference_names_every_key(record: type[CampaignFile]) -> None:
    missing = [
        name for name in record.model_fields if f"`{name}`" not in REFERENCE and f"[{name}]" not in REFERENCE
    ]
    assert missing == []
