"""Blunders are found in records of finite elements, each with what to write; honest campaigns are not doubted."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from by_elements import campaign_by_elements
from permway.arrays import Complexes, Reals
from permway.checking.blunder import Blunder
from permway.checking.check import check
from permway.checking.unlike import far_off

SEEDS = (1, 2, 3)
LAYOUTS = ("deck", "ballast", "slab", "beam", "rig")
READ = Callable[[Complexes, Reals], Complexes]


def reported(folder: Path, seed: int, **more: Any) -> tuple[Blunder, ...]:
    """All but that no tolerance is stated, which is asked of the few models that are exact."""
    found = check(campaign_by_elements(folder, seed, **more), threads=1).blunders
    return tuple(one for one in found if one.where != "parameters")


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("seed", SEEDS)
def test_honest_campaigns_are_not_doubted(tmp_path: Path, layout: str, seed: int) -> None:
    assert reported(tmp_path, seed, layout=layout) == ()


@pytest.mark.parametrize("concealed", ["fastener_loss", "deck_attachment", "layer_damping"])
def test_missing_physics_is_no_blunder(tmp_path: Path, concealed: str) -> None:
    for seed in SEEDS:
        assert reported(tmp_path / str(seed), seed, concealed=concealed) == ()


@pytest.mark.parametrize("seed", SEEDS)
def test_pads_softer_than_stated_are_no_blunder(tmp_path: Path, seed: int) -> None:
    assert reported(tmp_path, seed, scaled=0.7) == ()


@pytest.mark.parametrize("seed", SEEDS)
def test_levels_that_no_blunder_explains_are_reported_with_their_band(tmp_path: Path, seed: int) -> None:
    def far_off_of(name: str, read: READ) -> str | None:
        checked = check(campaign_by_elements(tmp_path / name, seed, read=read), threads=1)
        assert checked.blunders == ()
        return far_off([(dataset, right) for dataset, _, right in checked.records])

    def resonant(values: Complexes, frequency_Hz: Reals) -> Complexes:
        return values * np.where((frequency_Hz > 32.0) & (frequency_Hz < 50.8), 10.0, 1.0)

    words = far_off_of("with", resonant)
    assert words is not None
    median, most, low, high = map(float, re.findall(r"(?<![\w.])[0-9.]+(?= dB| and| Hz)", words))
    assert median == pytest.approx(20.0, abs=5.0)
    assert median <= most
    assert 32.0 <= low < high <= 50.8
    assert far_off_of("without", lambda v, f: v) is None


def omega(frequency: Reals) -> Complexes:
    return np.asarray(2j * np.pi * frequency)


WHOLE: list[tuple[str, READ, str, str]] = [
    ("g for m/s2", lambda v, f: v / 9.80665, "factor", 'unit = "g", not "m/s2"'),
    ("a thousand", lambda v, f: v * 1e3, "factor", 'unit = "mm/s2", not "m/s2"'),
    ("kN for N", lambda v, f: v * 1e3, "factor", 'all forces: unit = "kN"'),
    ("inches", lambda v, f: v * 25.4, "factor", "chain = { gain = 25.4 }"),
    ("a million", lambda v, f: v * 1e6, "factor", "gain = 1e+06"),
    ("velocity", lambda v, f: v / omega(f), "quantity", 'quantity = "velocity", unit = "m/s"'),
    ("velocity in mm/s", lambda v, f: 1e3 * v / omega(f), "quantity", 'quantity = "velocity", unit = "mm/s"'),
    ("displacement", lambda v, f: v / omega(f) ** 2, "quantity", 'quantity = "displacement", unit = "m"'),
    ("up for down", lambda v, f: -v, "sign", 'direction = "up"'),
    ("exp(-i omega t)", lambda v, f: v.conj(), "conjugate", "conjugate"),
    (
        "decibels",
        lambda v, f: 20.0 * np.log10(np.abs(v) / 1e-9) * np.exp(1j * np.angle(v)),
        "decibels",
        "plain unit",
    ),
    ("radians", lambda v, f: np.abs(v) * np.exp(1j * np.angle(v) * np.pi / 180.0), "angle", 'phase = "rad"'),
]


@pytest.mark.parametrize(("read", "kind", "remedy"), [row[1:] for row in WHOLE], ids=[row[0] for row in WHOLE])
def test_what_was_done_to_a_whole_record_is_reported(tmp_path: Path, read: READ, kind: str, remedy: str) -> None:
    for seed in SEEDS:
        first, *others = reported(tmp_path / str(seed), seed, layout="slab", read=read)
        assert (first.kind, others) == (kind, [])
        assert remedy in first.remedy
        assert first.log_odds is not None
        assert first.log_odds > 10.0


def test_a_unit_that_is_stated_wrongly_is_reported_with_the_right_one(tmp_path: Path) -> None:
    def in_g(table: dict[str, Any]) -> None:
        for sensor in table["sensors"]:
            sensor["unit"] = "g"

    (found,) = reported(tmp_path, 1, stated=in_g)
    assert "+19.8 dB" in found.what
    assert found.remedy.endswith('unit = "m/s2", not "g"')


def one_sensor(of: int, factor: complex) -> READ:
    def read(values: Complexes, _frequency_Hz: Reals) -> Complexes:
        values = values.copy()
        values[of] *= factor
        return values

    return read


@pytest.mark.parametrize(("factor", "kind"), [(-1.0, "sign"), (1.0 / 9.80665, "factor")])
def test_one_sensor_is_distinguished_from_the_others(tmp_path: Path, factor: complex, kind: str) -> None:
    found = reported(tmp_path, 3, layout="slab", read=one_sensor(1, factor))
    assert [(one.kind, one.where) for one in found] == [(kind, "records.blows1: s2")]


def test_exchanged_labels_are_reported(tmp_path: Path) -> None:
    def exchanged(values: Complexes, _frequency_Hz: Reals) -> Complexes:
        return values[[1, 0, *range(2, values.shape[0])]]

    (found,) = reported(tmp_path, 3, layout="slab", read=exchanged)
    assert (found.kind, found.where) == ("labels", "records.blows1: s1, s2")


def test_tolerances_in_percent_are_asked_back(tmp_path: Path) -> None:
    def in_percent(table: dict[str, Any]) -> None:
        table["parameters"][0]["tolerance_2sigma"] = 5
        table["parameters"][1]["tolerance_2sigma"] = 0.9

    first = next(one for one in reported(tmp_path, 1, stated=in_percent) if one.kind == "tolerance")
    assert first.asked
    assert "500 %" in first.what
    assert first.remedy == "for 5 % write tolerance_2sigma = 0.05"


def test_a_record_that_cannot_be_read_does_not_hide_the_others(tmp_path: Path) -> None:
    campaign = campaign_by_elements(tmp_path, 2)
    path = tmp_path / "blows1.npz"
    arrays = dict(np.load(path))
    np.savez(path, **(arrays | {"coh": 100.0 * arrays["coh"]}))
    (found, *_) = check(campaign, threads=1).blunders
    assert (found.kind, found.where) == ("unreadable", "records.blows1")
    assert "in percent?" in found.remedy
