"""A model written as a table and read again is the same model."""

from __future__ import annotations

from pathlib import Path

import pytest
from permway.errors import InputError
from permway.formats.model_file import model_from_dict, read_model
from permway.formats.model_writing import model_table
from permway.laws import Given
from permway.laws.toml import to_toml
from permway.problem.model import Model

EXAMPLES = Path(__file__).parents[2] / "examples"
MODELS = sorted(p for p in EXAMPLES.glob("*.toml") if not p.name.startswith("study"))


@pytest.mark.parametrize("path", MODELS, ids=[p.stem for p in MODELS])
def test_examples_come_back_as_they_were(path: Path, tmp_path: Path) -> None:
    model = read_model(path)
    (tmp_path / "again.toml").write_text(to_toml(model_table(model)))
    assert read_model(tmp_path / "again.toml") == model


def test_what_differs_is_written(tmp_path: Path) -> None:
    table = model_table(read_model(MODELS[0]))
    changed = model_from_dict({**table, "temperature_C": -17.5})
    assert changed != model_from_dict(table)
    assert model_table(changed)["temperature_C"] == -17.5


def test_a_law_given_as_a_function_is_refused() -> None:
    model = read_model(EXAMPLES / "viaduct.toml")
    line = model.line
    given = Given(function=lambda f, t: 1e7 + 0j * f)
    pads = {name: given if name == next(iter(line.laws)) else law for name, law in line.laws.items()}
    changed: Model = model.model_copy(update={"line": line.model_copy(update={"laws": pads})})
    with pytest.raises(InputError, match="cannot be written into a model file"):
        model_table(changed)
