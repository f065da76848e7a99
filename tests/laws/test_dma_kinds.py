"""Kinds of DMA tables that people have: what each means, and what is refused with a way on."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from permway.cli import app
from permway.errors import InputError
from permway.formats.model_file import model_from_dict
from permway.laws import FractionalZener, law_to_dict
from permway.laws.dma import DmaTable, read_dma
from permway.laws.fitting import fit_table
from permway.laws.identify import identify
from permway.laws.lawfile import load_law, save_law

# The same two rows in all tables: 1 and 10 Hz at 20 degC, 2 + 0.3i and 3 + 0.5i MPa.
MODULUS = np.array([2e6 + 3e5j, 3e6 + 5e5j])
SIZE, PHASE = np.abs(MODULUS), np.degrees(np.angle(MODULUS))
POLAR = "".join(f"{f},20,{a:.9g},{p:.9g}\n" for f, a, p in zip((1, 10), SIZE / 1e6, PHASE, strict=True))


def write(folder: Path, text: str, encoding: str = "utf-8") -> Path:
    path = folder / "dma.csv"
    path.write_bytes(text.encode(encoding))
    return path


@pytest.mark.parametrize(
    ("text", "encoding"),
    [
        ("f [Hz];T [°C];E' [MPa];E'' [MPa]\n1;20;2;0,3\n10;20;3;0,5\n", "utf-8"),
        ("f [Hz];T [°C];E' [MPa];E'' [MPa]\n1;20;2;0,3\n10;20;3;0,5\n", "cp1252"),
        ("f [Hz]\tT [°C]\tE' [MPa]\ttan δ\n1\t20\t2\t0,15\n10\t20\t3\t0,166666667\n", "utf-16"),
        ('f,T,E\' MPa,tan d\n"1,0","20,0","2,0","0,15"\n"10,0","20,0","3,0","0,166666667"\n', "utf-8"),
        ("f,T,E',E''\nHz,°C,MPa,MPa\n1,20,2,0.3\n10,20,3,0.5\n", "utf-8"),
        ("f,T,E',E''\n[kHz],[K],[GPa],[GPa]\n0.001,293.15,0.002,0.0003\n0.01,293.15,0.003,0.0005\n", "utf-8"),
        ("freq (rad/s),T_C,E_storage_MPa,eta_pct\n6.283185307,20,2,15\n62.83185307,20,3,16.6666667\n", "utf-8"),
        ("f_Hz,T_F,E' [MPa],Tan(delta)\n1,68,2,0.15\n10,68,3,0.166666667\n", "utf-8"),
        ("f_Hz,T_C,|E*| [MPa],phase [deg]\n" + POLAR, "utf-8"),
        ("f_Hz,T_C,Complex modulus / MPa,Phase angle / °\n" + POLAR, "utf-8"),
        ("Machine: X\nSample: EPDM\n\n[step]\nf,T,E',E''\nHz,°C,MPa,MPa\n1,20,2,0.3\n\n[step]\nf,T,E',E''\n"
         "Hz,°C,MPa,MPa\n10,20,3,0.5\n", "utf-8"),
        ("sep=;\nf_Hz;T_C;E' (N/mm²);E'' (N/mm²)\n1;20;2;0.3\n10;20;3;0.5\n", "cp1252"),
        ("# f_Hz T_C E_storage_MPa E_loss_MPa\n1 20 2 0.3\n10 20 3 0.5\n", "utf-8"),
        ('"Frequency\n[Hz]","Temperature\n[°C]","E\' [MPa]","E"" [MPa]"\n1,20,2,0.3\n10,20,3,0.5\n', "utf-8"),
        # A slow channel that nobody asks for is not looked at.
        ("t [s],f [Hz],T [°C],E' [MPa],E'' [MPa],remark\n0,1,20,2,0.3,\n,10,20,3,0.5,n/a\n", "utf-8"),
    ],
)  # fmt: skip
def test_the_same_table(tmp_path: Path, text: str, encoding: str) -> None:
    table = read_dma(write(tmp_path, text, encoding))
    np.testing.assert_allclose(table.frequency_Hz, [1.0, 10.0], rtol=1e-8)
    assert table.temperature_C is not None
    np.testing.assert_allclose(table.temperature_C, [20.0, 20.0], rtol=1e-8)
    np.testing.assert_allclose(table.modulus, MODULUS, rtol=1e-7)
    assert table.quantity == "modulus"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("F,T [°C],E' [MPa],E'' [MPa]\n3,20,2,0.3\n", ["frequency", "'F' may be a force", "--frequency"]),
        ("F [N],T [°C],E' [MPa],E'' [MPa]\n3,20,2,0.3\n3,20,3,0.5\n", ["frequency", "unit 'N'"]),
        ("f [Hz],t,E' [MPa],E'' [MPa]\n1,20,2,0.3\n2,20,3,0.5\n", ["'t' may be a time"]),
        ("f [Hz],T [°C],E' [MPa],tan ä\n1,20,2,0.3\n", ["loss_factor", "not understood: 'tan ä'"]),
        ("f [Hz],T [°C],E' [mPa],E'' [mPa]\n1,20,2,0.3\n", ["unit 'mPa' is not known for storage"]),
        ("f [Hz],T [°C],E' [MPa],phase\n1,20,2,8\n", ["an angle without a unit"]),
        ("f [Hz],T [°C],E' [MPa],phase [deg]\n1,20,2,95\n", ["line 2", "90 degrees"]),
        ("f [Hz],T [°C],E' [MPa],loss factor\n1,20,2,15\n", ["line 2", "per cent", "tan_delta_pct"]),
        ("f [Hz],T,E' [MPa],E'' [MPa]\n1,160,2,0.3\n", ["kelvin", "temperature_K"]),
        ("f [Hz],T [°C],E' [MPa],E'' [MPa]\n1,-300,2,0.3\n", ["absolute zero"]),
        ("f [Hz],T [K],E' [MPa],E'' [MPa]\n1,-20,2,0.3\n", ["degrees Celsius given as kelvin"]),
        ("f [Hz],T [K],E' [MPa],E'' [MPa]\n1,20,2,0.3\n", ["degrees Celsius given as kelvin"]),
        ("f;T;E' [MPa];E'' [MPa]\n1,000;20,000;2,000;1,300\n", ["thousands", "--decimal"]),
        ("f;T;E' [MPa];E'' [MPa]\n1;20;2,5;0.3\n", ["line 2", "decimal point in '0.3'"]),
        ("f [Hz],E' [MPa],E'' [MPa]\n1,2,0.3\n10,3,0.5\n1,1,0.1\n", ["line 4", "come again", "--temperature"]),
        ("f [Hz],T [°C],E' [MPa],E'' [MPa],|E*| [MPa]\n1,20,2,0.3,4\n", ["'|E*| [MPa]'", "contradicts"]),
        ("f [Hz],T [°C],E' [MPa],E'' [N/mm]\n1,20,2,0.3\n", ["mixed units"]),
        ("f [Hz],T [°C],E' [MPa],E'' [MPa]\nrad/s,°C,MPa,MPa\n1,20,2,0.3\n", ["row of units", "'rad/s'"]),
        ("f [Hz],T [°C],E' [MPa],E'' [MPa]\n1,20,2,0.3\nmean,of,all,rows\n", ["line 3", "neither units nor"]),
        ("f [Hz],T [°C],E' [MPa],E'' [MPa]\n1_0,20,2,0.3\n", ["line 2", "not a number"]),
        ("f [-],T [°C],E' [MPa],E'' [MPa]\n1,20,2,0.3\n", ["'f [-]' states that it has no unit"]),
        ("f [Hz],T [?],E' [MPa],E'' [MPa]\n1,20,2,0.3\n", ["temperature", "'T [?]'"]),
        ("T [°C],f [Hz],E' [MPa],E'' [MPa]\n20,1,2,0.3\n#REF!,2,2,0.3\n", ["line 3", "#REF!"]),
        ("PK\x03\x04 zipped", ["Excel"]),
    ],
)  # fmt: skip
def test_refused_with_a_way_on(tmp_path: Path, text: str, message: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        read_dma(write(tmp_path, text))
    for part in message:
        assert part in str(caught.value)


def test_what_the_user_states_settles_what_the_file_leaves_open(tmp_path: Path) -> None:
    path = write(tmp_path, "f;T;E' [MPa];E'' [MPa]\n1,000;20,000;2,000;1,300\n")
    assert read_dma(path, decimal=",").storage_Pa[0] == 2e6
    with pytest.raises(InputError, match="not a number"):
        read_dma(path, decimal=".")
    swept = write(tmp_path, "T [°C],E' [MPa],tan δ\n-40,90,0.5\n20,3,0.1\n")
    with pytest.raises(InputError, match="--frequency"):
        read_dma(swept)
    np.testing.assert_array_equal(read_dma(swept, frequency_Hz=2.0).frequency_Hz, [2.0, 2.0])
    with pytest.raises(InputError, match="above zero"):
        read_dma(swept, frequency_Hz=0.0)
    both = read_dma(write(tmp_path, "f [Hz],T [°C],E' [MPa],tan δ\n1,20,3,0.1\n"), frequency_Hz=2.0)
    assert both.frequency_Hz[0] == 1.0
    assert any("column 'f [Hz]', not the one given, 2" in note for note in both.notes)


def test_a_stiffness_is_one_and_becomes_a_modulus_by_the_shape_factor(tmp_path: Path) -> None:
    text = "f [Hz],T [°C],storage stiffness [kN/mm],loss factor\n1,20,5.2,0.15\n10,20,7.8,0.166666667\n"
    part = read_dma(write(tmp_path, text))
    assert part.quantity == "stiffness"
    np.testing.assert_allclose(part.storage_Pa, [5.2e6, 7.8e6])
    # Area 0.0312 m2, thickness 12 mm: k = 2.6 m times E.
    material = read_dma(write(tmp_path, text), shape_factor_m=0.0312 / 0.012)
    assert material.quantity == "modulus"
    np.testing.assert_allclose(material.modulus, MODULUS, rtol=1e-8)
    with pytest.raises(InputError, match="is a modulus"):
        read_dma(write(tmp_path, text.replace("stiffness [kN/mm]", "modulus [MPa]")), shape_factor_m=2.6)


def test_a_law_is_not_put_where_the_other_quantity_belongs(tmp_path: Path) -> None:
    """N/m taken for Pa is wrong by the shape factor, which is some metres: nobody would see it."""
    frequency = np.geomspace(1.0, 100.0, 12)
    value = FractionalZener(relaxed=3e6, unrelaxed=9e7, relaxation_time_s=1e-3, order=0.5).complex(frequency)
    laws = {}
    for quantity in ("modulus", "stiffness"):
        table = DmaTable(
            frequency_Hz=frequency,
            temperature_C=None,
            storage_Pa=value.real,
            loss_Pa=value.imag,
            quantity=quantity,
        )
        laws[quantity] = identify(table, shift="none")
        save_law(tmp_path / f"{quantity}.toml", laws[quantity])

    def model(law: dict[str, object]) -> dict[str, object]:
        return {
            "frequencies": {"values_Hz": [1.0, 10.0]},
            "line": {
                "bodies": {"block": {"type": "mass", "mass_kg": 100.0}},
                "joints": [{"between": ["block", "ground"], "law": "pad", "at": [0.0]}],
                "laws": {"pad": law},
            },
            "forces": [{"body": "block", "x_m": 0.0}],
            "sensors": [{"body": "block", "x_m": 0.0}],
        }

    def pad(name: str) -> dict[str, object]:
        return {"type": "pad", "material": {"file": name}, "area_m2": 0.03, "thickness_m": 0.01}

    kept = model_from_dict(model({"file": "stiffness.toml"}), folder=tmp_path).line.laws["pad"]
    assert law_to_dict(kept) == law_to_dict(laws["stiffness"].law)
    made = model_from_dict(model(pad("modulus.toml")), folder=tmp_path).line.laws["pad"]
    np.testing.assert_allclose(made.complex(10.0), 0.7 * 3.0 * laws["modulus"].law.complex(10.0))
    bare: dict[str, object] = {"file": "modulus.toml"}
    for wrong, message in ((pad("stiffness.toml"), "--shape-factor"), (bare, 'type = "pad"')):
        with pytest.raises(InputError, match=message):
            model_from_dict(model(wrong), folder=tmp_path)


def test_the_answer_states_which_of_the_two_it_is(tmp_path: Path) -> None:
    rows = "".join(f"{f},{1e6 * f**0.2:.6g},0.3249\n" for f in (1, 2, 5, 10, 20, 50))
    path = write(tmp_path, "f [Hz],K' [N/m],tan δ\n" + rows)
    answer = fit_table(path, output=tmp_path / "law.toml", law="springpot", shift="none")
    assert answer["quantity"] == "stiffness of the part, N/m"
    answer = fit_table(path, output=tmp_path / "law.toml", law="springpot", shift="none", shape_factor_m=2.0)
    assert answer["quantity"] == "modulus, Pa"


def test_a_ramp_of_temperature_is_many_temperatures(tmp_path: Path) -> None:
    """Rows half a kelvin apart are no single isotherm, however the machine dwelt."""
    rows = "".join(f"{t},{3.0 * 10.0 ** (-t / 40.0):.6g},{0.3:.6g}\n" for t in np.arange(-40.0, 40.0, 0.5))
    ramp = read_dma(write(tmp_path, "T [°C],E' [MPa],tan δ\n" + rows), frequency_Hz=1.0)
    nodes = ramp.isotherms()
    assert 20 <= len(nodes) <= 40
    assert np.all(np.diff(nodes) > 1.0)
    held = "".join(f"{f},{t + 0.4 * (-1) ** f},3,0.3\n" for t in (0.0, 20.0) for f in (1, 2, 3))
    np.testing.assert_allclose(
        read_dma(write(tmp_path, "f [Hz],T [°C],E' [MPa],tan δ\n" + held)).isotherms(), [0.0, 20.0], atol=0.2
    )


def test_a_damping_factor_is_not_taken_for_a_loss_factor(tmp_path: Path) -> None:
    """The damping factor of a vibration is half the loss factor of its spring: which is meant nobody can tell."""
    with pytest.raises(InputError, match="not understood: 'Damping factor'"):
        read_dma(write(tmp_path, "f [Hz],T [°C],E' [MPa],Damping factor\n1,20,2,0.1\n"))
    assert read_dma(write(tmp_path, "f [Hz],T [°C],E' [MPa],tan ∂\n1,20,2,0.1\n")).loss_factor[0] == pytest.approx(
        0.1
    )


def test_the_command_takes_what_the_file_does_not_state(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A stiffness in a decimal comma that could be thousands, at a frequency that no column gives."""
    rows = "".join(f"{t},000;{k},125;0,325\n" for t, k in ((-40, 650), (-20, 130), (1, 26), (20, 13), (40, 11)))
    path = write(tmp_path, "T [°C];K' [kN/m];tan δ\n" + rows)
    law = tmp_path / "law.toml"
    options = ["--law", "springpot_parallel", "-o", str(law), "--json"]
    with pytest.raises(SystemExit) as end:
        app(["fit-pad", str(path), *options, "--frequency", "2", "--shape-factor", "2.6", "--decimal", ","])
    assert end.value.code == 0
    stated = json.loads(capsys.readouterr().out)
    assert stated["quantity"] == "modulus, Pa"
    assert stated["reference_temperature_C"] == 20.0
    stiffness = load_law(law).storage(2.0, 20.0) * 2.6
    assert stiffness == pytest.approx(13.125e3, rel=0.5)
    warm = write(tmp_path, "f_Hz,T_C,E_storage_MPa,tan_delta\n1,40,3,0.1\n5,40,4,0.2\n1,60,2,0.1\n5,60,3,0.1\n")
    with pytest.raises(SystemExit) as end:
        app(["fit-pad", str(warm), *options])
    assert end.value.code == 0
    # 20 degC lies outside: the nearest isotherm is taken.
    assert json.loads(capsys.readouterr().out)["reference_temperature_C"] == 40.0


@pytest.mark.parametrize("name", ["omega", "ω", "Angular frequency", "Kreisfrequenz", "circular frequency"])
@pytest.mark.parametrize("unit", ["", " [rad/s]", " [1/s]"])
def test_angular_frequency_is_in_rad_per_s(name: str, unit: str, tmp_path: Path) -> None:
    """Its name states what it is; without a unit a note states what was assumed."""
    path = tmp_path / "a.csv"
    path.write_text(f"{name}{unit},T_degC,E' [MPa],tan delta\n{2 * np.pi},20,5,0.1\n{20 * np.pi},20,6,0.2\n")
    table = read_dma(path)
    np.testing.assert_allclose(table.frequency_Hz, [1.0, 10.0], rtol=1e-14)
    assert any("rad/s assumed" in note for note in table.notes) == (unit == "")
