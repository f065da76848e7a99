"""Real rubber: what the laws leave over on four materials, and a shaker predicted from DMA alone.

Bars are the rms errors found, rounded up in the second digit, so that a worse fit shows; they are not adjustable
tolerances. Sources: see the README beside the recordings.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from permway.laws import TFDV, Tabulated
from permway.laws.compare import Comparison, compare_laws
from permway.laws.dma import DmaTable, read_dma, read_modulus_pair
from permway.laws.identify import Identification, identify
from permway.laws.transmissibility import (
    ShakerRecord,
    ShearRig,
    common_factor,
    compare_record,
    read_shaker,
    rms_dB,
    transmissibility,
)

# 14.8 g of end discs move with the mass; the masses are those of the file names to the tenth of a gram.
RIG = ShearRig(
    outer_diameter_m=33.5e-3, inner_diameter_m=11.8e-3, thickness_m=6e-3, rings=2, moving_mass_kg=14.8e-3
)
MASSES_KG = {"118g": 0.1178, "253g": 0.2533, "573g": 0.573, "1196g": 1.196}
ROOM_C = 21.0

EQUAL_NUMBERS = (
    (3, "springpot_parallel", "zener"),
    (4, "fractional_zener", "maxwell:2"),
    (5, "havriliak_negami", "prony:2"),
    (7, "fvmp", "prony:3"),
)
"""Parameters of the law (a shift adds the same to both), fractional law, law of springs and dashpots."""

BARS = {
    # material: {law: (rms log10 storage modulus, rms loss factor)}
    "material_a": {"fractional_zener": (0.043, 0.13), "fvmp": (0.017, 0.047), "zener": (0.18, 0.53)},
    "epdm_70": {"fractional_zener": (0.014, 0.045), "fvmp": (0.0083, 0.013), "zener": (0.068, 0.13)},
    "eva": {"fractional_zener": (0.0054, 0.0068), "fvmp": (0.0050, 0.0062), "zener": (0.020, 0.084)},
    "pu_soft": {"fractional_zener": (0.0032, 0.010), "fvmp": (0.0031, 0.0093), "zener": (0.030, 0.058)},
}


def table_of(recordings: Path, material: str) -> DmaTable:
    if material in ("eva", "pu_soft"):
        folder = recordings / "pad-materials" / material
        return read_modulus_pair(folder / "storage_modulus_MPa.tsv", folder / "loss_factor.tsv")
    return read_dma(recordings / "rubber-rig" / material / "dma" / "tf_015p.csv")


@cache
def fvmp_of(recordings: Path, material: str, shift: str, vertical: str = "none") -> Identification:
    return identify(
        table_of(recordings, material), law="fvmp", shift=shift, vertical=vertical, reference_temperature_C=ROOM_C
    )


@pytest.fixture(scope="module")
def comparisons(recordings: Path) -> dict[str, Comparison]:
    found = {}
    for material in BARS:
        table = table_of(recordings, material)
        shift = "none" if table.temperature_C is None else "wlf"
        found[material] = compare_laws(
            table, shifts=(shift,), reference_temperature_C=None if shift == "none" else ROOM_C
        )
    return found


@pytest.mark.parametrize("material", list(BARS))
def test_what_each_law_leaves_over(comparisons: dict[str, Comparison], material: str) -> None:
    for law, (modulus, loss_factor) in BARS[material].items():
        row = comparisons[material].row(law)
        assert row.rms_log10_modulus <= modulus, law
        assert row.rms_loss_factor <= loss_factor, law


@pytest.mark.parametrize(("count", "fractional", "plain"), EQUAL_NUMBERS)
@pytest.mark.parametrize("material", list(BARS))
def test_fractional_laws_win_at_equal_numbers_of_parameters(
    comparisons: dict[str, Comparison], material: str, count: int, fractional: str, plain: str
) -> None:
    ours, theirs = comparisons[material].row(fractional), comparisons[material].row(plain)
    assert ours.n_parameters == theirs.n_parameters
    assert ours.n_parameters == count + (2 if ours.shift == "wlf" else 0)
    assert ours.rms_log10_modulus < theirs.rms_log10_modulus
    assert ours.rms_loss_factor < theirs.rms_loss_factor
    # Decisive, even if only one residual in ten were independent.
    assert theirs.bic - ours.bic > 40.0


def test_best_laws(comparisons: dict[str, Comparison]) -> None:
    assert {name: found.best.family for name, found in comparisons.items()} == {
        "material_a": "fvmp",
        "epdm_70": "fvmp",
        "eva": "springpot_parallel",
        "pu_soft": "springpot_parallel",
    }


def test_identified_laws_are_materials(comparisons: dict[str, Comparison]) -> None:
    for found in comparisons.values():
        for row in found.rows:
            check = row.law.check((0.1, 1000.0), None if row.shift == "none" else ROOM_C)
            assert check.passive, row.family
            assert check.causal, row.family


def test_shifts_and_the_vertical_factor_on_rubber(recordings: Path, comparisons: dict[str, Comparison]) -> None:
    def other(material: str, shift: str, vertical: str = "none") -> float:
        return fvmp_of(recordings, material, shift, vertical).bic

    # material_a follows WLF; epdm_70 wants a free shift, for its isotherms at 18 and 25 degC hardly differ.
    wlf = {material: comparisons[material].row("fvmp").bic for material in ("material_a", "epdm_70")}
    assert wlf["material_a"] < other("material_a", shift="free") < other("material_a", shift="arrhenius")
    assert other("epdm_70", shift="free") < wlf["epdm_70"] < other("epdm_70", shift="arrhenius")
    # The paper's factor rho T / (rho_s T_s) makes material_a clearly worse; epdm_70 hardly states.
    assert other("material_a", shift="wlf", vertical="paper") > wlf["material_a"] + 50.0
    assert other("epdm_70", shift="wlf", vertical="paper") > wlf["epdm_70"]


def test_quasi_static_modulus_stays_apart(recordings: Path) -> None:
    assert table_of(recordings, "eva").static_Pa == 47e6
    assert table_of(recordings, "pu_soft").static_Pa == 6.5e6
    assert len(table_of(recordings, "eva")) == 44
    assert len(table_of(recordings, "pu_soft")) == 84


@pytest.mark.parametrize("material", ["eva", "pu_soft"])
def test_published_modulus_tables_are_causal_within_their_scatter(recordings: Path, material: str) -> None:
    table = table_of(recordings, material)
    # Smoothed over a third of a decade: shifted isotherms overlap and scatter by several per cent.
    edges = np.geomspace(table.frequency_Hz[0], table.frequency_Hz[-1] * 1.0001, 9)
    place = np.digitize(table.frequency_Hz, edges)
    groups = [place == index for index in np.unique(place)]
    law = Tabulated(
        frequency_Hz=[float(np.exp(np.log(table.frequency_Hz[g]).mean())) for g in groups],  # type: ignore[arg-type]
        storage=[float(table.storage_Pa[g].mean()) for g in groups],
        loss_factor=[float(table.loss_factor[g].mean()) for g in groups],
    )
    found = law.check((law.frequency_Hz[0], law.frequency_Hz[-1]))
    assert found.causal, found.reasons


def shaker(recordings: Path, material: str, name: str) -> tuple[float, ShakerRecord]:
    record = read_shaker(recordings / "rubber-rig" / material / "shaker" / f"{name}.csv")
    return MASSES_KG[name.split("_")[1]], record


def stiffness(found: Identification, record: ShakerRecord) -> np.ndarray:
    return RIG.shape_factor_m * found.law.complex(record.frequency_Hz, ROOM_C)


@pytest.fixture(scope="module")
def pair_a(recordings: Path) -> list[tuple[float, ShakerRecord]]:
    return [shaker(recordings, "material_a", name) for name in ("1g_253g", "1g_573g")]


def test_material_a_transmissibility_from_dma_alone(
    comparisons: dict[str, Comparison], pair_a: list[tuple[float, ShakerRecord]]
) -> None:
    # (rms dB from DMA alone, rms dB with a constant modulus read at 10 Hz), for 253 g and for 573 g.
    bars = {
        "fractional_zener": ((1.48, 9.4), (1.37, 7.8)),
        "fvmp": ((0.85, 9.0), (0.76, 7.4)),
    }
    for law, both in bars.items():
        found = comparisons["material_a"].row(law)
        for (mass, record), (alone, constant) in zip(pair_a, both, strict=True):
            result = compare_record(found.law, RIG, mass, record, temperature_C=ROOM_C)
            assert result.rms_dB <= alone <= 1.6
            assert result.rms_constant_dB == pytest.approx(constant, abs=0.1)


def test_material_a_with_one_common_stiffness_factor(
    recordings: Path, comparisons: dict[str, Comparison], pair_a: list[tuple[float, ShakerRecord]]
) -> None:
    free = fvmp_of(recordings, "material_a", "free")
    for found, expected, bar in (
        (comparisons["material_a"].row("fractional_zener"), 0.774, 0.32),
        (free, 0.902, 0.31),
        # Just above the 0.35 dB asked for, and stated so: 0.356 dB at 253 g, 0.220 dB at 573 g.
        (comparisons["material_a"].row("fvmp"), 0.878, 0.36),
    ):
        cases = [(stiffness(found, record), mass + RIG.moving_mass_kg, record) for mass, record in pair_a]
        factor = common_factor(cases)
        assert factor == pytest.approx(expected, abs=0.01)
        for k, mass, record in cases:
            predicted = transmissibility(factor * k, mass, record.frequency_Hz)
            assert rms_dB(predicted, record.transmissibility) <= bar
        # The factor of one mass serves the other: it belongs to the rig.
        other = common_factor(cases[:1])
        k, mass, record = cases[1]
        assert rms_dB(transmissibility(other * k, mass, record.frequency_Hz), record.transmissibility) < 0.5


def test_discs_move_with_the_mass(
    comparisons: dict[str, Comparison], pair_a: list[tuple[float, ShakerRecord]]
) -> None:
    # Mass and stiffness enter by their ratio only, so leaving the discs out is as good with a free factor; but one
    # factor for both masses states: with the discs the two agree better.
    found = comparisons["material_a"].row("fractional_zener")
    apart = []
    for extra in (0.0, RIG.moving_mass_kg):
        one, two = (common_factor([(stiffness(found, record), mass + extra, record)]) for mass, record in pair_a)
        apart.append(abs(one / two - 1.0))
    assert apart[1] < apart[0]


def test_shaker_strain_lies_below_that_of_the_dma(
    recordings: Path, pair_a: list[tuple[float, ShakerRecord]]
) -> None:
    # DMA at 0.15 % strain. At less strain filled rubber is stiffer, so strain does not explain a factor below one.
    dma = table_of(recordings, "material_a").strain
    assert dma is not None
    for _, record in pair_a:
        assert record.shear_strain(RIG).max() < 0.5 * np.median(dma)


def test_epdm_70_constant_modulus_is_no_success(recordings: Path, comparisons: dict[str, Comparison]) -> None:
    """The DMA law misses by 3.4 to 3.9 dB; a constant looks better because two errors cancel.

    A factor on the rig (0.82, as for material_a) brings the law to 0.57, 0.35, 0.19 and 0.22 dB. That factor,
    which belongs to the rig and so to the constant as well, makes the constant worse than the law.
    """
    found = comparisons["epdm_70"].row("fvmp")
    assert isinstance(found.law, TFDV)
    records = [shaker(recordings, "epdm_70", f"01g_{name}") for name in MASSES_KG]
    cases = [(stiffness(found, record), mass + RIG.moving_mass_kg, record) for mass, record in records]
    factor = common_factor(cases)
    assert factor == pytest.approx(0.818, abs=0.01)
    for k, mass, record in cases:
        alone = rms_dB(transmissibility(k, mass, record.frequency_Hz), record.transmissibility)
        assert 3.3 < alone < 4.0
        scaled = rms_dB(transmissibility(factor * k, mass, record.frequency_Hz), record.transmissibility)
        constant = factor * RIG.shape_factor_m * found.law.complex(10.0, ROOM_C)
        constant_scaled = rms_dB(transmissibility(constant, mass, record.frequency_Hz), record.transmissibility)
        assert scaled < 0.58
        assert constant_scaled > 3.0 * scaled
