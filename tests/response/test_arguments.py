"""Wrong arguments end in one sentence that states what would be right."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import permway
import pytest
import xarray as xr

ANY: Any = permway


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: ANY.accelerance(xr.Dataset()), r"one variable, not a Dataset; as in accelerance\(data\["),
        (lambda: ANY.mobility(3.0), r"one variable, not a float; as in mobility\(data\["),
        (lambda: ANY.accelerance(xr.DataArray([1.0], dims="x")), "no coordinate 'frequency'"),
        (
            lambda: ANY.solve("model.toml"),
            r"must be a Model, not a str; as in solve\(read_model\('model.toml'\)\)",
        ),
        (lambda: ANY.Place("rail", 16.0), r"Place: takes its values by name; body='rail', x_m=16.0"),
        (lambda: ANY.receptance("rail", [1.0], forces=[], sensors=[]), "line: must be a Line, not a str"),
        (lambda: ANY.read_campaign(3), "must be the path of a campaign file, not a int"),
        (lambda: ANY.compare(None), "must be a campaign or the path of its file"),
    ],
)
def test_it_says_what_would_be_right(call: Callable[[], object], words: str) -> None:
    with pytest.raises(permway.InputError, match=words) as caught:
        call()
    assert "\n" not in str(caught.value)


def test_all_faults_of_a_table_are_named_at_once() -> None:
    with pytest.raises(permway.InputError) as caught:
        ANY.Place(body=3, x_m="a", y=1)
    reported = str(caught.value)
    assert all(f"Place.{key}" in reported for key in ("body", "x_m", "y"))
    table = {"frequencies": {"from_Hz": "1"}, "line": {"bodies": {}, "speed": 3}}
    with pytest.raises(permway.InputError) as caught:
        permway.model_from_dict(table)
    assert {key for key in ("frequencies", "line.speed") if key in str(caught.value)} == {
        "frequencies",
        "line.speed",
    }
