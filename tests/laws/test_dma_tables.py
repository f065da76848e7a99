"""Reading DMA tables: the names and units that are understood, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.errors import InputError
from permway.laws.dma import read_dma, read_modulus_pair

GOOD = "freq_hz,temperature_C,G_storage_pa,G_loss_pa\n1,20,2e6,3e5\n10,20,3e6,5e5\n"


def write(folder: Path, text: str, name: str = "dma.csv") -> Path:
    path = folder / name
    path.write_bytes(text.encode())
    return path


@pytest.mark.parametrize(
    "text",
    [
        GOOD,
        GOOD.replace(",", "\t"),
        GOOD.replace(",", ";"),
        "# a remark\n\n" + GOOD.replace("\n", "\r\n"),
        "\ufeff" + GOOD,
        "f_Hz,T_C,G_storage_MPa,G_loss_MPa\n1,20,2,0.3\n10,20,3,0.5\n",
        "Frequency [Hz],Temperature (°C),G' (MPa),G'' (MPa)\n1,20,2,0.3\n10,20,3,0.5\n",
        "run,tan_delta,E_storage_kPa,freq,temp\nx,0.15,2000,1,20\ny,0.16666666666666666,3000,10,20\n",
        "omega_rad_s,temperature_K,storage_modulus_GPa,loss_factor\n"
        "6.283185307179586,293.15,0.002,0.15\n62.83185307179586,293.15,0.003,0.16666666666666666\n",
        "freq_hz,temperature_C,G_storage_pa,G_loss_pa,tan_delta,strain_pct\n"
        "1,20,2e6,3e5,0.15,0.1\n10,20,3e6,5e5,0.1667,0.1\n",
    ],
)
def test_the_same_table_in_many_spellings(tmp_path: Path, text: str) -> None:
    table = read_dma(write(tmp_path, text))
    np.testing.assert_allclose(table.frequency_Hz, [1.0, 10.0], rtol=1e-12)
    np.testing.assert_allclose(table.temperature_C, [20.0, 20.0], rtol=1e-12)  # type: ignore[arg-type]
    np.testing.assert_allclose(table.storage_Pa, [2e6, 3e6], rtol=1e-12)
    np.testing.assert_allclose(table.loss_Pa, [3e5, 5e5], rtol=1e-12)
    if table.strain is not None:
        np.testing.assert_allclose(table.strain, 1e-3)
    with pytest.raises(ValueError, match="read-only"):
        table.storage_Pa[0] = 0.0


def test_sweeps_without_a_frequency_or_a_temperature_column(tmp_path: Path) -> None:
    cold = read_dma(write(tmp_path, "temp_C,E_storage_MPa,tan_delta\n-60,900,0.1\n40,5,0.1\n"), frequency_Hz=2.0)
    np.testing.assert_array_equal(cold.frequency_Hz, [2.0, 2.0])
    text = "freq,E_storage_MPa,tan_delta\n1,4,0.1\n2,5,0.1\n"
    assert read_dma(write(tmp_path, text)).temperature_C is None
    known = read_dma(write(tmp_path, text), temperature_C=21.0)
    np.testing.assert_array_equal(known.temperature_C, [21.0, 21.0])  # type: ignore[arg-type]


def test_isotherms_group_near_temperatures(tmp_path: Path) -> None:
    rows = "".join(f"{f},{t},1e6,1e5\n" for t in (-10.02, -9.97, 20.1, 20.0) for f in (1, 2))
    table = read_dma(write(tmp_path, "freq_hz,temperature_C,G_storage_pa,G_loss_pa\n" + rows))
    np.testing.assert_allclose(table.isotherms(), [-9.995, 20.05])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", ["file is empty"]),
        ("# only remarks\n\n", ["file is empty"]),
        ("freq_hz,temperature_C,G_storage_pa,G_loss_pa\n", ["no rows"]),
        ("1,20,2e6,3e5\n", ["no column for frequency, storage, loss or loss_factor"]),
        (GOOD.replace("G_loss_pa", "phase"), ["no column for loss or loss_factor", "tan_delta"]),
        (GOOD.replace("freq_hz", "run"), ["no column for frequency"]),
        (GOOD.replace("G_storage_pa", "x"), ["no column for storage"]),
        (GOOD.replace("3e6", "nan"), ["line 3", "'G_storage_pa'", "not a finite number", "nan"]),
        (GOOD.replace("3e6", ""), ["line 3", "'G_storage_pa'", "the cell is empty"]),
        (GOOD.replace("3e6", "n/a"), ["line 3", "'G_storage_pa'", "not a number", "n/a"]),
        (GOOD.replace("3e6", "3 MPa"), ["line 3", "units in the header"]),
        (GOOD.replace(",", ";").replace("2e6", "2,5e6").replace("3e5", "3.1e5"), ["line 2", "decimal point"]),
        (GOOD.replace("3e6", "-3e6"), ["line 3", "'G_storage_pa'", "above zero", "-3e6"]),
        (GOOD.replace("5e5", "-5e5"), ["line 3", "'G_loss_pa'", "above zero"]),
        (GOOD.replace("\n1,", "\n0,"), ["line 2", "'freq_hz'", "above zero", "quasi-static"]),
        (GOOD.replace("10,20,3e6,5e5", "10,20,3e"), ["line 3", "3 cells where the header has 4", "cut short"]),
        (GOOD.replace("temperature_C", "freq"), ["two columns for frequency", "'freq_hz' and 'freq'"]),
        (GOOD.replace("G_loss_pa", "G_loss_MPa"), ["mixed units", "'G_storage_pa' and 'G_loss_MPa'"]),
        (GOOD.replace("G_loss_pa", "E_loss_pa"), ["storage of one modulus, loss of another"]),
        (GOOD.replace("G_storage_pa", "G_storage"), ["'G_storage'", "without a unit"]),
        (GOOD.replace("G_storage_pa", "G_storage_psi"), ["unit 'psi' is not known for storage", "mpa"]),
        (GOOD.replace(",20,", ",293.15,"), ["line 2", "'temperature_C'", "kelvin", "subtract 273.15"]),
        (
            "freq,G_storage_pa,G_loss_pa,tan_delta\n1,2e6,3e5,0.15\n2,2e6,3e5,15\n",
            ["line 3", "'tan_delta'", "contradicts", "got 15.0"],
        ),
    ],
)  # fmt: skip
def test_tables_that_cannot_be_used(tmp_path: Path, text: str, message: list[str]) -> None:
    path = write(tmp_path, text)
    with pytest.raises(InputError) as caught:
        read_dma(path)
    for part in [path.name, *message]:
        assert part in str(caught.value)


def test_files_that_are_no_tables(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        read_dma(tmp_path / "none.csv")
    binary = tmp_path / "dma.xls"
    binary.write_bytes(bytes(range(128, 256)))
    with pytest.raises(InputError, match="not a text file"):
        read_dma(binary)


def test_modulus_pair_keeps_the_quasi_static_line_apart(tmp_path: Path) -> None:
    storage = write(tmp_path, "0\t5\n1\t10\n10\t20\n100\t30\n1000\t40\n", "storage_modulus_MPa.tsv")
    loss = write(tmp_path, "1\t0.1\n100\t0.3\n", "loss_factor.tsv")
    table = read_modulus_pair(storage, loss)
    assert table.static_Pa == 5e6
    np.testing.assert_allclose(table.frequency_Hz, [1.0, 10.0, 100.0])
    # Halfway in the logarithm of frequency.
    np.testing.assert_allclose(table.loss_factor, [0.1, 0.2, 0.3])
    assert "1 rows of the storage modulus lie outside" in table.notes[0]
    assert "at 1 of 3 rows" in table.notes[0]


@pytest.mark.parametrize(
    ("storage", "loss", "name", "message"),
    [
        ("1\t10\n2\t20\n", "1\t0.1\n2\t0.1\n", "storage.tsv", "unit of the modulus"),
        ("1\t10\n1\t20\n", "1\t0.1\n2\t0.1\n", "storage_MPa.tsv", "line 2, column 'frequency'"),
        ("1\t10\n0\t20\n", "1\t0.1\n2\t0.1\n", "storage_MPa.tsv", "rise strictly"),
        ("1\t10\n2\t-20\n", "1\t0.1\n2\t0.1\n", "storage_MPa.tsv", "above zero"),
        ("1\t10\n2\t20\n", "1\t0.1\t3\n2\t0.1\n", "storage_MPa.tsv", "3 cells"),
        ("1\t10\n2\t20\n", "5\t0.1\n9\t0.1\n", "storage_MPa.tsv", "no frequency in common"),
        ("0\t10\n", "5\t0.1\n9\t0.1\n", "storage_MPa.tsv", "no rows above 0 Hz"),
    ],
)
def test_modulus_pairs_that_cannot_be_used(
    tmp_path: Path, storage: str, loss: str, name: str, message: str
) -> None:
    with pytest.raises(InputError) as caught:
        read_modulus_pair(write(tmp_path, storage, name), write(tmp_path, loss, "loss.tsv"))
    assert message in str(caught.value)
