"""Pairs that were not measured are announced, and pairs without a coherence are refused."""

from __future__ import annotations

import json
import re
import shutil
import tomllib
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import permway
import pytest
from permway.campaign.kinds import kind_of
from permway.cli import app
from permway.diagnosis.gather import predictable
from permway.errors import InputError
from permway.laws.toml import to_toml
from permway.recordings.readers import read_frf
from permway.recordings.skeleton import write_skeleton
from tabled import Rows, tabled, without
from typer.testing import CliRunner


def load(path: Path) -> Any:
    (dataset,) = permway.read_campaign(path).load()
    return dataset


def test_a_pair_without_a_coherence_is_refused(tmp_path: Path) -> None:
    path = tabled(tmp_path, rows=without("coherence", sensor="d", point="b"))
    with pytest.raises(InputError) as caught:
        load(path)
    assert "has no coherence" in caught.value.what
    assert caught.value.where == "records.blows: frf.csv: d / b"
    for remedy in ("coherence column", "leave it out", 'noise = "scatter"'):
        assert remedy in caught.value.remedy


@pytest.mark.parametrize("key", ["scatter", "left out"])
def test_its_remedies_work(tmp_path: Path, key: str) -> None:
    def stated(table: dict[str, Any]) -> None:
        record = table["records"][0]
        if key == "scatter":
            record["noise"] = "scatter"
            del record["averages"]
        else:
            del record["responses"]["d"]

    path = tabled(tmp_path, rows=without("coherence", sensor="d", point="b"), stated=stated)
    assert np.isfinite(load(path).data["log_variance"].values).all()


def test_a_coherence_of_all_pairs_is_still_no_scatter(tmp_path: Path) -> None:
    def stated(table: dict[str, Any]) -> None:
        table["records"][0]["noise"] = "scatter"
        del table["records"][0]["averages"]

    with pytest.raises(InputError, match="has a coherence, which states more"):
        load(tabled(tmp_path, stated=stated))


def test_pairs_that_were_not_measured_are_named(tmp_path: Path) -> None:
    path = tabled(tmp_path, rows=without(sensor="d", point="b"))
    dataset = load(path)
    assert kind_of(dataset.record).unmeasured(dataset) == ["deck@3 < hit far"]
    done = CliRunner().invoke(app, ["check", str(path), "--no-picture", "--json"])
    assert done.exit_code == 0
    assert json.loads(done.stdout)["not_measured"] == ["blows: 5 of 6 pairs; not deck@3 < hit far"]
    left_out = predictable(permway.read_campaign(path)).left_out
    assert left_out == {"blows: deck@3 < hit far": "was not measured: the file has no such pair"}


def test_they_warn_of_nothing_where_curves_are_compared(tmp_path: Path) -> None:
    path = tabled(tmp_path, rows=without(sensor="d", point="b"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert permway.compare(path) is not None


def test_a_campaign_is_begun_with_the_pairs_that_are_there(tmp_path: Path) -> None:
    path = tabled(tmp_path / "made", rows=without(sensor="d", point="b"))
    (tmp_path / "exports").mkdir()
    shutil.copy(path.parent / "frf.csv", tmp_path / "exports")
    stated = write_skeleton(tmp_path / "exports")
    assert stated["files"][0]["holds"] == "2 x 3 responses, 5 of 6 pairs"
    text = (tmp_path / "exports" / "campaign.toml").read_text("utf-8")
    assert "# 5 of 6 pairs are there; not: d < b" in text


def test_an_empty_cell_inside_a_band_is_a_row_to_delete(tmp_path: Path) -> None:
    def emptied(rows: Rows) -> Rows:
        for row in rows:
            if row["f"] == 100.0 and row["sensor"] == "d":
                row["real"] = ""
        return rows

    with pytest.raises(InputError) as caught:
        load(tabled(tmp_path, rows=emptied))
    assert caught.value.where.endswith("frf.csv: d / a, 100 Hz")
    assert "delete all rows of 100 Hz in a copy" in caught.value.remedy
    assert "band_Hz" not in caught.value.remedy
    # It works.
    path = tabled(tmp_path, rows=lambda rows: [row for row in emptied(rows) if row["f"] != 100.0])
    assert 100.0 not in load(path).frequency_Hz


@pytest.mark.parametrize("cell", ["inf", "-Inf", "1.#INF", "inf+2j", "1+infj"])
def test_an_endless_number_does_not_claim_that_columns_are_missing(tmp_path: Path, cell: str) -> None:
    path = tmp_path / "wide.csv"
    path.write_text(f"Frequency [Hz],r<a [(m/s2)/N]\n10,1+1j\n20,{cell}\n30,1+1j\n")
    with pytest.raises(InputError) as caught:
        read_frf(path)
    assert caught.value.what == "not a finite number"
    assert caught.value.where.endswith("line 3, column 'r<a'")
    assert "delete its row" in caught.value.remedy
    assert "column" not in caught.value.remedy


def test_at_an_end_of_the_band_the_band_leaves_it_out(tmp_path: Path) -> None:
    def emptied(rows: Rows) -> Rows:
        for row in rows:
            if row["f"] == 200.0:
                row["coherence"] = ""
        return rows

    with pytest.raises(InputError) as caught:
        load(tabled(tmp_path, rows=emptied))
    below = re.search(r"below ([\d.]+) Hz by the record's band_Hz", caught.value.remedy)
    assert below is not None
    path = tabled(tmp_path, rows=emptied, stated=lambda table: table["records"][0].update(band_Hz=[8.0, 199.0]))
    assert float(below[1]) == 200.0
    assert load(path).frequency_Hz[-1] == 198.0


def test_a_typo_in_pairs_is_the_one_that_is_named(tmp_path: Path) -> None:
    path = tabled(tmp_path)
    (tmp_path / "wide.csv").write_text("Frequency [Hz],A [(m/s2)/N],B [(m/s2)/N]\n10,1+1j,1+2j\n20,1+1j,1+3j\n")
    table = tomllib.loads(path.read_text("utf-8"))
    record = table["records"][0]
    record |= {"file": "wide.csv", "noise": "scatter", "pairs": {"A": ["r", "a"], "B": ["dd", "a"]}}
    record["references"] = {"a": "hit"}
    del record["averages"]
    path.write_text(to_toml(table))
    with pytest.raises(InputError) as caught:
        load(path)
    assert (caught.value.where, caught.value.value) == ("records.blows: pairs", "dd")
    assert "did you mean 'd'?" in caught.value.remedy
