"""Which cases a study makes: product, zip, sample; where values go."""

import numpy as np
import pytest
from permway.errors import InputError
from permway.study import study_from_dict
from permway.study.places import parse_place, replaced, written


def test_product_is_in_the_order_of_the_axes(table):
    plan = study_from_dict(table).plan
    assert plan.shape == (3, 2)
    stated = [tuple(plan.stated(i).values()) for i in range(plan.cases)]
    assert stated == [(2e7, 0.1), (2e7, 0.3), (5e7, 0.1), (5e7, 0.3), (8e7, 0.1), (8e7, 0.3)]


def test_values_reach_the_model(table):
    pads = [study_from_dict(table).model(i).line.laws["pad"] for i in range(6)]
    assert [(p.stiffness, p.eta) for p in pads[:3]] == [(2e7, 0.1), (2e7, 0.3), (5e7, 0.1)]
    assert table["model"]["line"]["laws"]["pad"]["stiffness"] == 6.0e7


def test_zip_runs_axes_together(table):
    table["combine"] = "zip"
    table["axes"]["loss"]["values"] = [0.1, 0.2, 0.3]
    plan = study_from_dict(table).plan
    assert [(d.name, d.size) for d in plan.dimensions] == [("case", 3)]
    assert [tuple(plan.stated(i).values()) for i in range(3)] == [(2e7, 0.1), (5e7, 0.2), (8e7, 0.3)]


def test_one_axis_sets_several_places(table):
    table["axes"] = {
        "season": {
            "paths": ["line.laws.pad.stiffness", "line.laws.pad.loss_factor"],
            "values": [[3e7, 0.1], [9e7, 0.3]],
            "labels": ["summer", "winter"],
        }
    }
    study = study_from_dict(table)
    assert study.plan.dimensions[0].axes[0].coordinate() == ["summer", "winter"]
    assert study.model(1).line.laws["pad"].stiffness == 9e7
    assert study.model(1).line.laws["pad"].eta == 0.3


def test_a_value_may_be_a_whole_law(table):
    laws = [{"type": "kelvin_voigt", "stiffness": 5e7, "damping": 3e4}, {"type": "hysteretic", "stiffness": 5e7}]
    table["axes"] = {"pad": {"path": "line.laws.pad", "values": laws}}
    study = study_from_dict(table)
    assert [study.model(i).line.laws["pad"].type for i in range(2)] == ["kelvin_voigt", "hysteretic"]


@pytest.mark.parametrize("method", ["sobol", "latin_hypercube"])
def test_sample_follows_from_its_seed(table, method):
    table["combine"] = "sample"
    table["sample"] = {"count": 5, "seed": 3, "method": method}
    table["axes"]["stiffness"]["values"] = {"from": 2e7, "to": 8e7, "spacing": "logarithmic"}
    table["axes"]["loss"]["values"] = {"from": 0.1, "to": 0.3}
    first, again = (study_from_dict(table).plan for _ in range(2))
    assert (first.shape, first.hash()) == ((5,), again.hash())
    drawn = np.array([list(first.stated(i).values()) for i in range(5)])
    assert np.all((drawn >= [2e7, 0.1]) & (drawn <= [8e7, 0.3]))
    if method == "latin_hypercube":
        strata = np.floor(5 * np.log(drawn[:, 0] / 2e7) / np.log(4.0))
        assert sorted(strata) == [0, 1, 2, 3, 4]
    table["sample"]["seed"] = 4
    assert study_from_dict(table).plan.hash() != first.hash()


def test_sample_beside_a_listed_axis(table):
    table["combine"] = "sample"
    table["sample"] = {"count": 4}
    table["axes"]["stiffness"]["values"] = {"from": 2e7, "to": 8e7}
    plan = study_from_dict(table).plan
    assert [(d.name, d.size) for d in plan.dimensions] == [("sample", 4), ("loss", 2)]


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"from": 0.1, "to": 0.3, "step": 0.1}, [0.1, 0.2, 0.3]),
        ({"from": 0.1, "to": 0.35, "step": 0.1}, [0.1, 0.2, 0.3]),
        ({"from": 0.1, "to": 0.4, "count": 4}, [0.1, 0.2, 0.3, 0.4]),
        ({"from": 0.1, "to": 0.4, "count": 3, "spacing": "logarithmic"}, [0.1, 0.2, 0.4]),
    ],
)
def test_ranges(table, values, expected):
    table["axes"] = {"loss": {"path": "line.laws.pad.loss_factor", "values": values}}
    assert study_from_dict(table).plan.dimensions[0].axes[0].coordinate() == pytest.approx(expected, rel=1e-14)


def test_the_hash_is_of_the_model_and_of_what_is_kept(table):
    first = study_from_dict(table).plan
    assert first.file_name(2).startswith("case-000002-")
    assert len({first.file_name(i)[12:] for i in range(6)}) == 6
    assert study_from_dict({**table, "title": "another"}).plan.hash() == first.hash()
    assert study_from_dict({**table, "keep": ["receptance"]}).plan.file_name(2) != first.file_name(2)
    table["model"]["sensors"][0]["x_m"] = 1.0
    assert study_from_dict(table).plan.file_name(2) != first.file_name(2)


def test_the_hash_is_of_the_content_of_a_law_file(table, tmp_path):
    table["model"]["line"]["laws"]["pad"] = {"file": "pad.toml"}
    table["axes"] = {"end": {"path": "frequencies.to_Hz", "values": [500.0, 600.0]}}
    law = tmp_path / "pad.toml"
    law.write_text('format = 1\n[law]\ntype = "hysteretic"\nstiffness = 5e7\n', encoding="utf-8")
    first = study_from_dict(table, folder=tmp_path).plan
    assert study_from_dict(table, folder=tmp_path).plan.file_name(0) == first.file_name(0)
    law.write_text(law.read_text(encoding="utf-8").replace("5e7", "6e7"), encoding="utf-8")
    assert study_from_dict(table, folder=tmp_path).plan.file_name(0) != first.file_name(0)


def test_places():
    steps = parse_place("line.joints[2].at[0]", "here")
    assert steps == ("line", "joints", 2, "at", 0)
    assert written(steps) == "line.joints[2].at[0]"
    table = {"a": [{"b": 1}, {"b": 2}], "c": {}}
    assert replaced(table, ("a", 1, "b"), 5) == {"a": [{"b": 1}, {"b": 5}], "c": {}}
    assert replaced(table, ("c", "d", "e"), 5)["c"] == {"d": {"e": 5}}
    assert table == {"a": [{"b": 1}, {"b": 2}], "c": {}}


@pytest.mark.parametrize("path", ["", ".", "a.", "a..b", "a[", "a[x]", "a[-1]", "[0]", "a b", 3, None, ["a"]])
def test_no_path(path):
    with pytest.raises(InputError, match="here: is no path in a model"):
        parse_place(path, "here")
