"""Wrong arguments end in one sentence that states what would be right."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import permway
import pytest
import xarray as xr

ANY: Any = permway
LINE = permway.ballasted_b91_60e1(sleepers=5)
RAIL = permway.Place(body="rail", x_m=1.0)
TRAIN = permway.Train(vehicle=permway.crh380a(), centre_m=1.0, speed_m_per_s=60.0)


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
        (lambda: ANY.solve(LINE), r"not a Line; .*a line alone is solved by permway.receptance"),
        (lambda: ANY.Hysteretic(1e8, 0.2), r"stiffness=100000000.0, loss_factor=0.2 if that is meant"),
        (lambda: ANY.Train(ANY.crh380a(), 3.0, 60.0), r"vehicle=<Vehicle>, centre_m=3.0, speed_m_per_s=60.0"),
        (lambda: ANY.Place(body="rail", x=1.0), r"Place.x_m: missing; 1 further .*Place.x: unknown name"),
        (lambda: ANY.receptance(LINE, [1.0], forces=RAIL, sensors=[RAIL]), "forces: must be a list of Places"),
        (lambda: ANY.receptance(LINE, [1.0], forces=[RAIL], sensors=None), "sensors: must be a list of Places"),
        (lambda: ANY.receptance(LINE, [1.0], forces=[RAIL], sensors="rail"), "sensors: must be a list of Places"),
        (lambda: ANY.receptance(LINE, None, forces=[RAIL], sensors=[RAIL]), "frequency_Hz: must be given"),
        (
            lambda: ANY.receptance(LINE, [1.0], forces=[RAIL], sensors=[RAIL], temperature_C="20"),
            "temperature_C: must be a number",
        ),
        (lambda: ANY.decay_rate(xr.Dataset({"a": ("x", [1.0, 2.0])}), 1.0, 1.0), "near: not numbers"),
        (lambda: ANY.read_model({}), "must be a str or a path, not a dict; a table is read by model_from_dict"),
        (lambda: ANY.read_model(None), "must be a str or a path, not None"),
        (lambda: ANY.model_from_dict("model.toml"), "must be a dict, not a str; a file is read by read_model"),
        (lambda: ANY.law_from_dict("hysteretic"), "law: must be a dict, not a str; as in"),
        (lambda: ANY.law_from_dict({"type": "elastic"}), "no type 'elastic'; use one of 'hysteretic'"),
        (lambda: ANY.law_to_dict({"type": "hysteretic"}), "law: must be a Law, not a dict"),
        (lambda: ANY.train_response(LINE, ANY.crh380a(), None, [1.0]), "must be a Train, not a Vehicle; as in"),
        (lambda: ANY.train_response(LINE, TRAIN, None, [1.0]), "irregularity: must be an Irregularity, not None"),
        (
            lambda: ANY.passby(LINE, ANY.crh380a(), sensors=[RAIL], highest_Hz=50.0),
            "train: must be a Train or Axles, not a Vehicle",
        ),
        (lambda: ANY.both_rails(LINE, "roll", [1.0], forces=[RAIL], sensors=[RAIL]), "must be a Line or a Roll"),
        (lambda: ANY.dispersion("model.toml"), "line: must be a Line"),
        (lambda: ANY.modes(LINE, 1.0, 2.0, places=RAIL), "places: must be a list of Places"),
        (lambda: ANY.insertion_loss("a.nc", "b.nc"), "without: must be a Dataset"),
        (lambda: ANY.write_dataset("answer.nc", xr.Dataset()), "data: must be a Dataset, not a str"),
        (lambda: ANY.write_dataset(xr.Dataset(), None), "path: must be a str or a path, not None"),
        (lambda: ANY.write_csv(xr.Dataset(), 3), "path: must be a str or a path, not an int"),
        (lambda: ANY.read_campaign(3), "must be the path of a campaign file, not a int"),
        (lambda: ANY.compare(None), "must be a campaign or the path of its file"),
    ],
)
def test_it_states_what_would_be_right(call: Callable[[], object], words: str) -> None:
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


def test_a_name_that_is_not_there_is_answered_with_one_that_is() -> None:
    with pytest.raises(AttributeError, match="did you mean 'solve'"):
        _ = ANY.solv


def test_all_laws_and_lines_by_name_are_public() -> None:
    from permway import laws
    from permway.model.presets import LAWS, LINES

    kinds = {one.__name__ for one in laws.AnyLaw.__args__[0].__args__}
    assert kinds | set(LAWS) | set(LINES) <= set(permway.__all__)
    for name in permway.__all__:
        assert getattr(permway, name) is not None
