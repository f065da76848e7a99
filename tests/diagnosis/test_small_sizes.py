"""Every size of everything is a campaign, down to one of it, and to no parameter at all.

Every check diagnoses each size once. The other commands of each size, and effects put into it, are run with the
injections: each costs a whole diagnosis.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Iterable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from permway.campaign.campaign import Campaign
from permway.campaign.parameters import Known
from permway.cli import app
from permway.diagnosis.bounded import bounded_step
from permway.diagnosis.catalogue._change import with_chain, with_factors
from permway.diagnosis.compare import RAW, RECALIBRATED
from permway.diagnosis.separability import separability
from permway.diagnosis.verdict import UNPROVED, Verdict
from permway.posterior.compare import compare
from permway.posterior.diagnose import diagnose
from permway.report.compare import write_comparison
from permway.report.diagnosis import write_diagnosis
from simulated import CAMPAIGN, FREQUENCY, MODEL, simulate
from small_sizes import SIZES, TABLES, alone
from typer.testing import CliRunner

COARSE_DPI = 40
"""Of pictures that nobody looks at."""


def softened(campaign: Campaign) -> Campaign:
    """The pad at 6 m keeps a fifth."""
    return with_factors(campaign, "pad", lambda x: np.where(np.abs(x - 6.0) < 0.1, 0.2, 1.0))


def loud(campaign: Campaign) -> Campaign:
    """The first sensor reads half as much again."""
    chain = campaign.sensor("rail@6").chain
    return with_chain(campaign, "rail@6", chain.model_copy(update={"gain": 1.5 * chain.gain}))


def finishes(campaign: Campaign, folder: Path) -> Verdict:
    """All three commands, with what they write, and the verdict as its file has it."""
    comparison = compare(campaign, threads=1)
    write_comparison(comparison, folder / "comparison", dpi=COARSE_DPI)
    names = [p.name for p in campaign.stated.parameters]
    assert comparison.parameters["parameter"].values.tolist() == names
    assert all(np.isfinite(values).all() for values in comparison.parameters.data_vars.values())
    found = separability(campaign, threads=1)
    assert found.names
    assert np.isfinite(found.apart).all()
    diagnosis = diagnose(campaign, threads=1)
    write_diagnosis(diagnosis, folder / "diagnosis")
    verdict = Verdict.read(folder / "diagnosis" / "verdict.json")
    assert verdict == diagnosis.verdict
    assert list(verdict.recalibrated.before) == names
    return verdict


def _known(campaign: Campaign) -> Iterable[tuple[str, Known]]:
    return campaign.parameters.known.items()


@pytest.mark.injection
@pytest.mark.parametrize("size", SIZES)
def test_every_command_finishes_for_one_of_everything(size: str, tmp_path: Path) -> None:
    finishes(SIZES[size].made(tmp_path / "c").campaign, tmp_path)


@pytest.mark.parametrize("size", SIZES)
def test_nothing_is_called_missing_of_one_of_everything(size: str, tmp_path: Path) -> None:
    case = SIZES[size].made(tmp_path / "c")
    verdict = diagnose(case.campaign, threads=1).verdict
    assert list(verdict.recalibrated.before) == [p.name for p in case.campaign.stated.parameters]
    # The pads' true stiffness is 2.04 standard deviations from the stated one.
    beyond = [z for z in (known.z(case.truth[name]) for name, known in _known(case.campaign)) if abs(z) > 2.0]
    assert verdict.status in (UNPROVED if beyond else ("recalibrated", "insufficient"))


@pytest.mark.parametrize(
    ("size", "amend"),
    [
        pytest.param("one pad", softened, marks=pytest.mark.injection),
        pytest.param("one sensor", softened, marks=pytest.mark.injection),
        pytest.param("one line, no parameters", softened, marks=pytest.mark.injection),
        pytest.param("a mass on a spring", softened, marks=pytest.mark.injection),
        pytest.param("a mass on a spring, no parameters", loud, marks=pytest.mark.injection),
        ("one of everything", softened),
    ],
)
def test_effects_are_tried_about_any_size(
    size: str, amend: Callable[[Campaign], Campaign], tmp_path: Path
) -> None:
    """Search, proof and advice meet these sizes, too; what is named is not asked of so few numbers."""
    case = SIZES[size].made(tmp_path / "c", amend=amend)
    verdict = diagnose(case.campaign, threads=1).verdict
    assert Verdict.from_json(verdict.to_json()) == verdict


@pytest.mark.parametrize("record", TABLES)
def test_one_record_of_one_line_is_a_campaign(record: str, tmp_path: Path) -> None:
    assert compare(alone(tmp_path / "one", TABLES[record], parameters=1), threads=1).records


@pytest.mark.injection
@pytest.mark.parametrize("record", TABLES)
def test_every_command_finishes_for_one_record_of_one_line(record: str, tmp_path: Path) -> None:
    finishes(alone(tmp_path, TABLES[record], parameters=0), tmp_path)


def test_without_parameters_the_base_is_the_nominal_model(tmp_path: Path) -> None:
    comparison = compare(SIZES["no parameters"].made(tmp_path / "c").campaign, threads=1)
    (record,) = comparison.records
    raw, recalibrated = (record["predicted"].sel(model=m).values for m in (RAW, RECALIBRATED))
    np.testing.assert_array_equal(recalibrated, raw)
    # Nothing is uncertain of what is stated exactly.
    assert not record["predicted_dB"].values.any()


def test_without_parameters_effects_are_named(tmp_path: Path) -> None:
    small = SIZES["no parameters"]
    verdict = diagnose(small.made(tmp_path / "soft", amend=softened).campaign, threads=1).verdict
    (effect,) = verdict.effects
    assert (verdict.status, effect.name, effect.place.joint) == ("named", "fastener_loss", "pad")
    assert effect.place.x == pytest.approx((6.0, 6.0), abs=0.31)
    assert effect.parameters["factor"].value == pytest.approx(0.2, abs=0.1)
    verdict = diagnose(small.made(tmp_path / "loud", amend=loud).campaign, threads=1).verdict
    (effect,) = verdict.effects
    assert (verdict.status, effect.name, effect.place.channels) == ("measurement", "sensor_gain", ("rail@6",))
    assert effect.parameters["gain"].value == pytest.approx(1.5, rel=0.03)


@pytest.mark.injection
@settings(max_examples=8)
@given(
    parameters=st.integers(0, 2),
    sensors=st.sampled_from((["r"], ["d"], ["r", "d"])),
    points=st.sampled_from((["a"], ["c"], ["a", "b"], ["a", "b", "c"])),
    pads=st.lists(st.sampled_from((0.6, 3.0, 6.0, 9.0, 11.4)), min_size=1, max_size=3, unique=True),
    lines=st.lists(st.sampled_from(FREQUENCY.tolist()), min_size=1, max_size=4, unique=True),
    soft=st.booleans(),
)
def test_any_few_of_everything_are_a_campaign(
    parameters: int,
    sensors: list[str],
    points: list[str],
    pads: list[float],
    lines: list[float],
    soft: bool,
) -> None:
    campaign, model = copy.deepcopy(CAMPAIGN), copy.deepcopy(MODEL)
    del campaign["parameters"][parameters:]
    record = campaign["records"][0]
    record["responses"] = {label: record["responses"][label] for label in sensors}
    record["references"] = {label: record["references"][label] for label in points}
    model["line"]["joints"][0]["at"] = sorted(pads)
    with TemporaryDirectory() as folder:
        case = simulate(
            Path(folder) / "c",
            3,
            model=model,
            campaign=campaign,
            frequency_Hz=np.sort(lines),
            amend=softened if soft else lambda campaign: campaign,
        )
        assert compare(case.campaign, threads=1).records
        assert separability(case.campaign, threads=1).names
        assert diagnose(case.campaign, threads=1).verdict.status


@pytest.mark.parametrize("fixed", [[0], [2], [0, 1, 2]])
def test_a_step_leaves_what_has_no_room(fixed: list[int]) -> None:
    """The others go where they do best with it there: where the slope along each of them is none."""
    normal, slope = np.array([[4.0, 1.0, 0.5], [1.0, 3.0, -0.2], [0.5, -0.2, 2.0]]), np.array([3.0, -1.0, 0.5])
    low, high, z = np.full(3, -8.0), np.full(3, 8.0), np.zeros(3)
    low[fixed] = high[fixed] = z[fixed] = -1.0
    shift = bounded_step(normal, slope, z, low, high, 0.0)
    np.testing.assert_array_equal(shift[fixed], 0.0)
    free = np.setdiff1d(np.arange(3), fixed)
    np.testing.assert_allclose((normal @ shift + slope)[free], 0.0, atol=1e-12)


@pytest.mark.parametrize("parameters", [0, pytest.param(1, marks=pytest.mark.injection)])
@pytest.mark.parametrize("command", ["compare", "diagnose", "separability"])
def test_the_commands_take_a_campaign_of_few_parameters(command: str, parameters: int, tmp_path: Path) -> None:
    case = SIZES["one parameter" if parameters else "no parameters"].made(tmp_path / "c", amend=softened)
    options = [] if command == "separability" else ["-o", str(tmp_path / "out")]
    ended = CliRunner().invoke(app, [command, str(case.path), *options, "--json"])
    assert ended.exit_code == 0, ended.output
    printed = json.loads(ended.stdout)
    if command == "compare":
        assert printed["parameters"] == parameters
    elif command == "diagnose":
        assert Verdict.read(tmp_path / "out" / "verdict.json").status == printed["status"]
    else:
        assert {"fastener_loss", "sensor_gain"} <= {one["effect"] for one in printed["effects"]}
