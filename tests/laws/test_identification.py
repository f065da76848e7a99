"""Identification on synthetic tables whose law is known; files and pictures of what was identified."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from permway.errors import InputError
from permway.laws import (
    FVMP,
    TFDV,
    WLF,
    Arrhenius,
    FractionalZener,
    Hysteretic,
    Law,
    Prony,
    Zener,
    law_to_dict,
)
from permway.laws.compare import compare_laws
from permway.laws.dma import DmaTable
from permway.laws.fitting import fit_table
from permway.laws.identify import Identification, identify
from permway.laws.lawfile import load_law, save_law
from permway.laws.pictures import master_curve, residuals, shift_factors, surfaces
from permway.laws.toml import to_toml

TRUE = TFDV(
    law=FractionalZener(relaxed=3e6, unrelaxed=9e8, relaxation_time_s=2e-6, order=0.45),
    shift=WLF(c1=11.0, c2_K=170.0, reference_temperature_C=20.0),
    reference_temperature_C=20.0,
    vertical="none",
)


def measured(
    law: Law, noise: float, seed: int, temperatures: tuple[float, ...] = (-20.0, -5.0, 10.0, 25.0, 40.0)
) -> DmaTable:
    """Isotherms from 0.5 to 100 Hz with relative errors of modulus and phase."""
    frequency, temperature = np.meshgrid(np.geomspace(0.5, 100.0, 12), temperatures)
    errors = np.random.default_rng(seed).normal(0.0, noise, (2, frequency.size))
    value = law.complex(frequency.ravel(), temperature.ravel()) * np.exp(errors[0] + 1j * errors[1])
    return DmaTable(
        frequency_Hz=frequency.ravel(),
        temperature_C=temperature.ravel(),
        storage_Pa=value.real,
        loss_Pa=value.imag,
        source="synthetic",
    )


@pytest.fixture(scope="module")
def found() -> Identification:
    return identify(measured(TRUE, 0.01, 1), shift="wlf", reference_temperature_C=20.0)


def test_known_parameters_come_back_within_their_intervals() -> None:
    truth = {
        "relaxed": 3e6,
        "unrelaxed": 9e8,
        "relaxation_time_s": 2e-6,
        "order": 0.45,
        "shift.c1": 11.0,
        "shift.c2_K": 170.0,
    }
    inside = []
    for seed in range(12):
        result = identify(measured(TRUE, 0.01, seed), shift="wlf", reference_temperature_C=20.0, seed=seed)
        assert {p.name for p in result.parameters} == set(truth)
        # The noise put in, and nothing more, is left over.
        assert result.rms_log10_modulus == pytest.approx(0.01 / np.log(10.0), rel=0.35)
        for p in result.parameters:
            inside.append(p.low <= truth[p.name] <= p.high)
            assert p.value == pytest.approx(truth[p.name], rel=0.5)
    # 72 intervals of 90 %, six to a run and correlated there: 12 independent runs put the mean at 0.90 +- 0.05.
    assert 0.78 <= np.mean(inside) <= 1.0


@pytest.mark.parametrize(
    ("law", "family", "shift"),
    [
        (Zener(relaxed=3e6, unrelaxed=9e7, relaxation_time_s=2e-3), "zener", "wlf"),
        (
            Prony(relaxed=3e6, strengths=(2e6, 3e7), relaxation_times_s=(0.1, 1e-3)),
            "prony:2",
            "wlf",
        ),
        (FVMP(mu1=1e6, eta1=8e4, mu2=1.2e6, eta2=2e7, alpha=0.5, beta=0.7, gamma=0.6), "fvmp", "wlf"),
        (
            FractionalZener(relaxed=3e6, unrelaxed=9e8, relaxation_time_s=2e-6, order=0.45),
            "fractional_zener",
            "free",
        ),
        (
            FractionalZener(relaxed=3e6, unrelaxed=9e8, relaxation_time_s=2e-6, order=0.45),
            "havriliak_negami",
            "wlf",
        ),
    ],
)
def test_exact_tables_are_matched_exactly(law: Law, family: str, shift: str) -> None:
    true = TFDV.model_validate({**law_to_dict(TRUE), "law": law})
    result = identify(measured(true, 0.0, 0), law=family, shift=shift, reference_temperature_C=20.0)
    # A tenth of a per cent: far below any DMA's error, far above the optimiser's.
    assert result.rms_log10_modulus < 1e-3 / np.log(10.0)
    assert result.rms_loss_factor < 1e-3
    check = result.law.check((1.0, 1000.0), 20.0)
    assert check.passive
    assert check.causal


def test_arrhenius_and_the_vertical_factor_come_back() -> None:
    true = TFDV(
        law=TRUE.law,
        shift=Arrhenius(activation_energy_J_per_mol=9e4, reference_temperature_C=20.0),
        reference_temperature_C=20.0,
        vertical="paper",
    )
    result = identify(measured(true, 0.0, 0), shift="arrhenius", vertical="paper", reference_temperature_C=20.0)
    energy = next(p for p in result.parameters if p.name == "shift.activation_energy_J_per_mol")
    assert energy.value == pytest.approx(9e4, rel=1e-4)
    assert isinstance(result.law, TFDV)
    assert result.law.vertical == "paper"


def test_a_temperature_sweep_at_one_frequency_is_enough_for_law_and_shift() -> None:
    # As the paper measured: 2 Hz, -60 to 40 degC.
    temperature = np.linspace(-60.0, 40.0, 60)
    value = TRUE.complex(np.full(60, 2.0), temperature)
    table = DmaTable(
        frequency_Hz=np.full(60, 2.0), temperature_C=temperature, storage_Pa=value.real, loss_Pa=value.imag
    )
    result = identify(table, shift="wlf", reference_temperature_C=20.0)
    assert result.rms_log10_modulus < 1e-3
    # Time and slope of the shift cannot be distinguished from the frequency axis alone; the order can.
    order = next(p for p in result.parameters if p.name == "order")
    assert order.value == pytest.approx(0.45, abs=0.01)


def test_what_the_data_do_not_constrain_is_reported() -> None:
    # All far below the relaxation: the unrelaxed modulus is out of sight.
    hidden = TFDV.model_validate(
        {
            **law_to_dict(TRUE),
            "law": FractionalZener(relaxed=3e6, unrelaxed=9e9, relaxation_time_s=1e-14, order=0.3),
        }
    )
    result = identify(measured(hidden, 0.01, 3), shift="wlf", reference_temperature_C=20.0)
    notes = {p.name: p.note for p in result.parameters}
    assert "not identifiable" in notes["relaxation_time_s"]
    assert notes["relaxed"] == ""
    assert next(p for p in result.parameters if p.name == "relaxation_time_s").note


def test_a_seed_repeats_and_progress_is_reported(found: Identification) -> None:
    reported: list[tuple[int, int]] = []
    again = identify(
        found.table,
        shift="wlf",
        reference_temperature_C=20.0,
        progress=lambda *step: reported.append(step),
    )
    assert again.law == found.law
    assert reported == sorted(reported)
    assert len(reported) > 60
    assert reported[-1] == (100, 100)


def test_candidates_are_sorted_and_the_true_family_wins(found: Identification) -> None:
    laws = ("zener", "prony:2", "fractional_zener")
    result = compare_laws(found.table, laws=laws, reference_temperature_C=20.0)
    assert [entry.bic for entry in result.rows] == sorted(entry.bic for entry in result.rows)
    assert result.best.family == "fractional_zener"
    table = result.table()
    assert table[0]["bic_above_best"] == 0.0
    assert {row["law"] for row in table} == set(laws)
    assert result.row("zener").n_parameters == 5
    with pytest.raises(KeyError):
        result.row("fvmp")


def test_an_identified_law_is_saved_whole(found: Identification, tmp_path: Path) -> None:
    path = tmp_path / "LAW.toml"
    path.write_text("an older one")
    save_law(path, found)
    assert load_law(path) == found.law
    assert [entry.name for entry in tmp_path.iterdir()] == ["LAW.toml"]
    content = tomllib.loads(path.read_text())
    assert content["identification"]["bic"] == found.bic
    assert {p["name"] for p in content["identification"]["parameters"]} >= {"order", "shift.c1"}
    save_law(path, Hysteretic(stiffness=6e7, loss_factor=0.1))
    assert load_law(path) == Hysteretic(stiffness=6e7, loss_factor=0.1)


def test_toml_reads_back() -> None:
    table = {
        "a": 1,
        "b": 1e-30,
        "c": True,
        "d e": 'q"\\\n\t\x7f°',
        "list": [1.5, 2.0],
        "none": None,
        "t": {"x": -0.0, "u": {"y": "z"}},
        "rows": [{"n": 1, "m": {"k": 2}}, {"n": 2}],
        "empty": [],
    }
    expected = {key: value for key, value in table.items() if value is not None}
    assert tomllib.loads(to_toml(table)) == expected
    with pytest.raises(TypeError, match="complex"):
        to_toml({"z": 1j})


@pytest.mark.parametrize("draw", [master_curve, shift_factors, surfaces, residuals])
def test_pictures_are_drawn(found: Identification, tmp_path: Path, draw: object) -> None:
    figure = draw(found)  # type: ignore[operator]
    assert isinstance(figure, Figure)
    figure.savefig(tmp_path / "figure.png", dpi=50)
    assert (tmp_path / "figure.png").stat().st_size > 3000


def test_pictures_without_a_shift(tmp_path: Path) -> None:
    frequency = np.geomspace(1.0, 100.0, 20)
    value = TRUE.law.complex(frequency)
    table = DmaTable(frequency_Hz=frequency, temperature_C=None, storage_Pa=value.real, loss_Pa=value.imag)
    plain = identify(table, law="springpot_parallel", shift="none")
    for draw in (master_curve, residuals):
        draw(plain).savefig(tmp_path / "figure.png", dpi=50)
    for refuse in (shift_factors, surfaces):
        with pytest.raises(InputError, match="no shift was identified"):
            refuse(plain)


def test_from_a_table_on_disk_to_a_law_on_disk(tmp_path: Path) -> None:
    table = measured(TRUE, 0.01, 5, temperatures=(-10.0, 10.0, 30.0))
    rows = zip(table.frequency_Hz, table.temperature_C, table.storage_Pa, table.loss_Pa, strict=True)  # type: ignore[arg-type]
    source = tmp_path / "dma.csv"
    header = "freq_hz,temperature_C,E_storage_Pa,E_loss_Pa\n"
    source.write_text(header + "".join(f"{f},{t},{s},{v}\n" for f, t, s, v in rows))
    answer = fit_table(source, output=tmp_path / "LAW.toml", pictures=tmp_path / "pictures")
    assert answer["law"] == "fractional_zener"
    assert answer["check"]["causal"] is True
    assert len(answer["comparison"]) == 8
    assert [Path(name).name for name in answer["pictures"]] == [
        "master_curve.png",
        "residuals.png",
        "shift.png",
        "surfaces.png",
    ]
    assert json.loads(json.dumps(answer)) == answer
    law = load_law(tmp_path / "LAW.toml")
    assert law.storage(20.0, 15.0) == pytest.approx(TRUE.storage(20.0, 15.0), rel=0.02)


def test_one_temperature_leaves_the_shift_out_and_states_so(tmp_path: Path) -> None:
    frequency = np.geomspace(1.0, 100.0, 20)
    value = TRUE.law.complex(frequency)
    source = tmp_path / "dma.csv"
    rows = "".join(f"{f},{v.real},{v.imag}\n" for f, v in zip(frequency, value, strict=True))
    source.write_text("freq_hz,E_storage_Pa,E_loss_Pa\n" + rows)
    answer = fit_table(source, output=tmp_path / "LAW.toml", law="springpot_parallel")
    assert answer["shift"] == "none"
    assert "one temperature" in answer["notes"][0]
    assert "pictures" not in answer
    assert not load_law(tmp_path / "LAW.toml").needs_temperature
