"""Campaigns of the challenge: files that import, noise that coherence states, nothing shared with the solver."""

from __future__ import annotations

import ast
import hashlib
import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import permway.challenge
import pytest
from permway.campaign.importers.sheet import import_sheet
from permway.challenge import TIERS, draw, make, write, write_truth
from permway.challenge.errors_of_measurement import NEPER_PER_DB, calibration_error, struck
from permway.challenge.irregularity import WITHIN_DB, density, deviation, profile
from permway.challenge.layout import TOLERANCE
from permway.challenge.run import ruled_out
from permway.diagnosis.catalogue import entries
from permway.errors import InputError
from short_deck import TWO_SPANS, small_case

PACKAGE = Path(permway.challenge.__file__).parent
ALLOWED = {"numpy", "scipy", "pyuff", *sys.stdlib_module_names}


BY_THE_TOOL = {
    f"permway.challenge.small.{name}"
    for name in (
        "alone",
        "by_model",
        "fixture",
        "make",
        "outside_model",
        "passages",
        "stated",
        "stretches",
        "write",
    )
}
"""Makes small campaigns by the tool's own model on purpose, reads or diagnoses them."""


def imports_of(file: Path) -> set[str]:
    """Modules that a file imports anywhere; of a package that it imports from, what may be its modules, too."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, file
            names |= {str(node.module)}
            if str(node.module).startswith("permway.challenge"):
                names |= {f"{node.module}.{alias.name}" for alias in node.names}
    return names


def foreign(name: str) -> bool:
    own = name == "permway.errors" or name.split(".")[:2] == ["permway", "challenge"]
    return not own and name.split(".")[0] not in ALLOWED


MODULES = {
    ".".join(["permway.challenge", *file.relative_to(PACKAGE).with_suffix("").parts]): imports_of(file)
    for file in sorted(PACKAGE.rglob("*.py"))
}


def test_package_shares_nothing_with_the_solver() -> None:
    assert len(MODULES) > 10
    shared = {module: set(filter(foreign, names)) for module, names in MODULES.items()}
    assert {module for module, names in shared.items() if names} == BY_THE_TOOL, shared


def test_finite_elements_of_small_campaigns_share_nothing_with_the_solver() -> None:
    reached, left = set[str](), {"permway.challenge.small.by_elements"}
    while left:
        module = left.pop()
        reached.add(module)
        left |= (MODULES[module] & set(MODULES)) - reached
    assert "permway.challenge.small.elements_line" in reached
    assert not reached & BY_THE_TOOL


@pytest.mark.parametrize("text", [True, False], ids=["uff and csv", "mat and npz"])
def test_same_seed_writes_the_same_bytes_and_imports(tmp_path: Path, text: bool) -> None:
    case = replace(small_case(), text=text)
    first, second = (write(case, tmp_path / name) for name in ("one", "two"))
    assert [a.read_bytes() for a in first] == [b.read_bytes() for b in second]
    assert b"Created on" not in first[1].read_bytes()[:128]
    campaign = import_sheet(tmp_path / "one", tmp_path / "imported")
    data = {dataset.record.name: dataset.data for dataset in campaign.load()}
    (frf,) = (values["frf"] for values in data.values() if "frf" in values)
    assert frf.sizes == {"sensor": len(case.tests.sensors), "force": len(case.tests.points), "frequency": 100}
    assert len(data) == 1 + len(case.tests.speeds_kmh)
    assert "interpolated_Hz" not in (tmp_path / "imported" / "campaign.toml").read_text()


def test_two_spans_and_two_temperatures_import(tmp_path: Path) -> None:
    case = small_case(layout=TWO_SPANS)
    case = replace(case, tests=replace(case.tests, temperatures_C=(20.0, -15.0)))
    write(case, tmp_path / "folder")
    campaign = import_sheet(tmp_path / "folder", tmp_path / "imported")
    assert [c.temperature_C for c in campaign.stated.conditions if c.kind == "hammer"] == [20.0, -15.0]


def test_truth_stays_out_of_the_folder_and_is_sealed(tmp_path: Path) -> None:
    case = small_case(3, "single")
    digest = write_truth(case, tmp_path / "truth.json")
    content = (tmp_path / "truth.json").read_bytes()
    assert digest == hashlib.sha256(content).hexdigest()
    assert (tmp_path / "truth.json.sha256").read_text().split()[0] == digest
    reported = json.loads(content)
    assert reported["effects"][0]["id"] == case.effects[0].ID
    sheet = json.dumps(case.sheet)
    assert "effects" not in sheet
    assert str(case.true["pad"]["k"]) not in sheet


@pytest.mark.parametrize("tier", TIERS)
def test_draws_lie_within_tolerances_and_repeat(tier: str) -> None:
    for seed in range(12):
        case = draw(seed, tier)  # type: ignore[arg-type]
        assert case == draw(seed, tier)  # type: ignore[arg-type]
        for group, table in TOLERANCE.items():
            for name, tolerance in table.items():
                assert abs(case.true[group][name] / case.nominal[group][name] - 1.0) <= tolerance
        assert {"null": len(case.effects) == 0, "multiple": len(case.effects) > 1}.get(
            tier, len(case.effects) == 1
        )
        assert all(0.0 <= x < 100.0 for _, x in (*case.tests.sensors, *case.tests.points))
        assert case.layout.spans == 1 or case.layout.bays % case.layout.spans != 0
        assert all(abs(factor - 1.0) <= 0.005 for factor in case.chain.speed)
        case.plan()


def test_faults_of_use_are_reported(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is no tier"):
        draw(1, "easy")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="below zero"):
        draw(-1, "null")
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be made"):
        write(small_case(), tmp_path / "file" / "folder")
    assert make(1, 0, "null", tmp_path) == []


def test_coherence_states_the_noise_put_in() -> None:
    random = np.random.default_rng(11)
    response = np.full((20, 2, 200), 3.0 - 4.0j)
    noise = np.tile([0.5, 2.5], (20, 1))
    _, coherence = struck(random, response, noise, blows=300, cell=0.0)
    force = np.exp(2.0 * 0.25**2)
    for sensor, size in enumerate((0.5, 2.5)):
        expected = 25.0 * force / (25.0 * force + size**2)
        assert coherence[:, sensor].mean() == pytest.approx(expected, abs=0.003)


def test_scatter_of_h1_is_what_its_coherence_states() -> None:
    random = np.random.default_rng(12)
    response = np.full((20, 1, 1000), 1.0 + 0j)
    frf, _ = struck(random, response, np.full((20, 1), 0.3), blows=8, cell=0.0)
    _, settled = struck(random, response, np.full((20, 1), 0.3), blows=300, cell=0.0)
    coherence = settled.mean()
    stated = (1.0 - coherence) / (2.0 * 8.0 * coherence)
    assert np.var(np.log(np.abs(frf))) == pytest.approx(stated, rel=0.1)
    assert np.var(np.angle(frf)) == pytest.approx(stated, rel=0.1)


def test_smooth_errors_have_their_size_and_length() -> None:
    random = np.random.default_rng(13)
    frequency = np.array([50.0, 100.0])
    drawn = np.log([calibration_error(random, frequency, size_dB=1.0) for _ in range(1500)]) / NEPER_PER_DB
    assert drawn.real.std() == pytest.approx(1.0, rel=0.05)
    assert np.corrcoef(drawn.real.T)[0, 1] == pytest.approx(np.exp(-0.5), abs=0.05)


def test_profile_is_of_the_sheets_spectrum_and_not_gaussian() -> None:
    samples, rate, speed = 65536, 1024.0, 60.0
    off, tails = [], []
    for seed in range(6):
        random = np.random.default_rng(seed)
        spectrum = profile(random, deviation(random), samples=samples, sampling_Hz=rate, speed=speed)
        frequency = np.fft.rfftfreq(samples, 1.0 / rate)
        per_hertz = 2.0 * np.abs(spectrum) ** 2 / (samples * rate)
        stated = density(2.0 * np.pi * np.maximum(frequency, 1e-3) / speed) * 2.0 * np.pi / speed
        for centre in (4.0, 10.0, 25.0, 63.0, 160.0, 400.0):
            band = (frequency > 0.8 * centre) & (frequency < 1.2 * centre)
            off.append(10.0 * np.log10((per_hertz[band] / stated[band]).mean()))
            # A level that wanders by 3 dB leaves 1 / 1.6 of the lines independent; three standard errors.
            assert abs(off[-1]) < WITHIN_DB + 3.0 * 4.34 * np.sqrt(1.6 / band.sum())
        whitened = np.fft.irfft(np.where(stated > 0.0, spectrum / np.sqrt(stated), 0.0))
        tails.append(np.mean(whitened**4) / np.mean(whitened**2) ** 2)
    assert np.std(off) > 0.3
    assert min(tails) > 3.5


def test_of_outside_cases_the_catalogue_loses_families() -> None:
    invented, taken = 0, 0
    for seed in range(60):
        case = draw(seed, "outside")
        (part,) = case.truth["effects"]
        assert part["id"] is None
        assert part["words"]
        if case.taken_out is None:
            invented += 1
            assert case.truth["ruled_out"] == []
        else:
            taken += 1
            assert case.effects[0].ID in case.truth["ruled_out"]
            assert set(case.truth["ruled_out"]) <= set(entries())
    assert min(invented, taken) > 15


def test_what_is_ruled_out_is_all_that_the_runner_reads_of_a_truth(tmp_path: Path) -> None:
    (tmp_path / "truth").mkdir()
    (tmp_path / "truth" / "outside-1.json").write_text(
        json.dumps({"ruled_out": ["pad_frequency"], "effects": [7]})
    )
    assert ruled_out(tmp_path, "outside-1") == ["pad_frequency"]
    assert ruled_out(tmp_path, "outside-2") == []
