"""Bad studies: refused before anything is computed or written, with place, value and remedy."""

import re

import pytest
from permway.errors import InputError
from permway.study import read_study, run_study, study_from_dict
from permway.study.run import CHECKED_WHOLE, cases_to_check

LOSS = "line.laws.pad.loss_factor"


def axis(path=LOSS, values=(0.1, 0.2), **more):
    return {"axes": {"a": {"path": path, "values": list(values) if isinstance(values, tuple) else values, **more}}}


FAULTS = {
    "no axis": ({"axes": {}}, "axes: there is no axis"),
    "unknown key": ({**axis(), "colour": 1}, "colour: unknown key"),
    "empty axis": (axis(values=()), "axes.a.values: the axis is empty"),
    "text for a list": (axis(values="0.1"), "axes.a.values: must be a list"),
    "no values": ({"axes": {"a": {"path": LOSS}}}, "axes.a.values: missing"),
    "no path": ({"axes": {"a": {"values": [1]}}}, "axes.a: give path, or paths"),
    "path is text": (axis(path=3), "axes.a.path: is no path in a model (got 3)"),
    "value twice": (axis(values=(0.1, 0.2, 0.1)), "axes.a.values[2]: stands there already, at 0 (got 0.1)"),
    "not finite": (axis(values=(0.1, float("nan"))), "axes.a.values[1]: no value of a model"),
    "axis is no table": ({"axes": {"a": 3}}, "axes.a: must be a table (got 3)"),
    "unknown key of an axis": (axis(unit="N"), "axes.a.unit: unknown key"),
    "name with a dot": ({"axes": {"a.b": {}}}, "axes.a.b: a name has letters"),
    "name taken by the collection": ({"axes": {"case": axis()["axes"]["a"]}}, "an axis cannot be named any of"),
    "labels": (axis(labels=["one"]), "axes.a.labels: must be 2"),
    "backward range": (axis(values={"from": 2, "to": 1, "count": 3}), "axes.a.values.to: must lie above from = 2"),
    "text in a range": (axis(values={"from": "1", "to": 2, "count": 3}), "axes.a.values.from: "),
    "step and count": (axis(values={"from": 1, "to": 2, "count": 3, "step": 1}), "give step or count"),
    "no step": (axis(values={"from": 0.1, "to": 0.2}), "axes.a.values: a range needs step or count"),
    "tiny step": (axis(values={"from": 1, "to": 2, "step": 1e-9}), "makes more than 1000000 values"),
    "logarithm of zero": (
        axis(values={"from": 0, "to": 2, "count": 3, "spacing": "logarithmic"}),
        "equal ratios need from above 0",
    ),
    "sample without its table": (
        {**axis(values={"from": 0.1, "to": 0.2}), "combine": "sample"},
        "combine: a sample",
    ),
    "sample of nothing": ({**axis(), "combine": "sample", "sample": {"count": 3}}, "combine: a sample needs"),
    "sample not asked for": ({**axis(), "sample": {"count": 3}}, "sample: does not go with this combine"),
    "sample of no points": (
        {**axis(values={"from": 0.1, "to": 0.2}), "combine": "sample", "sample": {"count": 0}},
        "sample.count: input should be greater than or equal to 1 (got 0)",
    ),
    "keep nothing": ({**axis(), "keep": []}, "keep: must name variables"),
    "combine": ({**axis(), "combine": "all"}, "combine: "),
    "same place twice": (
        {"axes": {"a": axis()["axes"]["a"], "b": axis()["axes"]["a"]}},
        "axes.b: duplicate axis: line.laws.pad.loss_factor is set by axes.a",
    ),
    "a place and its part": (
        {"axes": {"a": axis()["axes"]["a"], "b": {"path": "line.laws.pad", "values": [{}]}}},
        "axes.b: duplicate axis",
    ),
    "paths and rows": (
        {"axes": {"a": {"paths": [LOSS, "title"], "values": [[0.1, "a"], [0.2]]}}},
        "axes.a.values[1]: must be a list of 2, a value for each path",
    ),
    "unequal zip": (
        {
            "axes": {"a": axis()["axes"]["a"], "b": {"path": "title", "values": ["x", "y", "z"]}},
            "combine": "zip",
        },
        "axes: axes that run together must be equally long (got {'a': 2, 'b': 3})",
    ),
    "too many": (
        {
            "axes": {
                name: {"path": path, "values": {"from": 1.0, "to": 2.0, "count": 1001}}
                for name, path in (("a", LOSS), ("b", "line.laws.pad.stiffness"))
            }
        },
        "axes: too many cases, at most 1000000 (got 1002001); take a sample",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_fault_of_the_study(fault, model):
    changes, message = FAULTS[fault]
    with pytest.raises(InputError, match=re.escape(message)):
        study_from_dict({"model": model, **changes})


CASES = {
    "no number": (axis(values=(0.1, "0.2")), f"case 1 ({LOSS} = '0.2'): {LOSS}: must be a number (got '0.2')"),
    "no passive law": (axis(values=(0.1, -0.2)), f"case 1 ({LOSS} = -0.2): line.laws.pad: the law creates energy"),
    "unknown key": (axis(path="line.laws.pad.lossfactor"), "line.laws.pad.lossfactor: unknown key"),
    "unknown table": (axis(path="trains.speed"), "case 0 (trains.speed = 0.1): trains: unknown key"),
    "through a number": (axis(path="title.a"), "title.a: unknown path: title is no table, so it has no 'a'"),
    "through a table": (axis(path="line[0]"), "line[0]: unknown path: line is no list"),
    "past the end": (axis(path="line.joints[1].scale"), "unknown path: line.joints has no element 1: it has 1"),
    "no such variable": ({**axis(), "keep": ["mobility"]}, "keep[0]: the answer has no such variable"),
    "name of a dimension": ({"axes": {"frequency": axis()["axes"]["a"]}}, "axes.frequency: the answer has a"),
}


@pytest.mark.parametrize("fault", CASES)
def test_fault_of_a_case_is_reported_before_anything_is_written(fault, model, tmp_path):
    changes, message = CASES[fault]
    study = study_from_dict({"model": model, **changes})
    with pytest.raises(InputError, match=re.escape(message)):
        run_study(study, tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


def test_large_studies_are_checked_at_the_ends_and_along_the_axes(table):
    table["axes"]["stiffness"]["values"] = {"from": 2e7, "to": 8e7, "count": 2000}
    table["axes"]["loss"]["values"] = {"from": 0.1, "to": 0.3, "count": 500}
    checked = list(cases_to_check(study_from_dict(table)))
    assert len(checked) < CHECKED_WHOLE
    assert {0, 499, 500 * 1999, 999_999} <= set(checked)


def test_model_file(table, tmp_path):
    folder = tmp_path / "studies"
    folder.mkdir()
    with pytest.raises(InputError, match=r"model: none\.toml: cannot be read: No such file"):
        study_from_dict({**table, "model": "none.toml"}, folder=folder)
    for name in ("../model.toml", str(tmp_path / "model.toml")):
        with pytest.raises(InputError, match="model: lies outside the study's folder"):
            study_from_dict({**table, "model": name}, folder=folder)
    with pytest.raises(InputError, match="a table without a folder cannot name a file"):
        study_from_dict({**table, "model": "model.toml"})
    (tmp_path / "model.toml").write_text("title = 'outside'", encoding="utf-8")
    (folder / "link.toml").symlink_to(tmp_path / "model.toml")
    with pytest.raises(InputError, match="lies outside"):
        study_from_dict({**table, "model": "link.toml"}, folder=folder)
    (folder / "bad.toml").write_text("[a", encoding="utf-8")
    with pytest.raises(InputError, match=r"bad\.toml: is not TOML"):
        study_from_dict({**table, "model": "bad.toml"}, folder=folder)


def test_study_file(tmp_path):
    path = tmp_path / "study.toml"
    with pytest.raises(InputError, match=r"study\.toml: cannot be read"):
        read_study(path)
    path.write_bytes(b"\xff")
    with pytest.raises(InputError, match="is not text in UTF-8"):
        read_study(path)
    path.write_text("combine = 'zip'", encoding="utf-8")
    with pytest.raises(InputError, match=r"study\.toml: (model|axes): missing"):
        read_study(path)
