"""DMA tables as the usual programs write them: read back as the same numbers in SI, or refused."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd  # type: ignore[import-untyped]
import pytest
from numpy.random import Generator
from permway.errors import InputError
from permway.laws.dma import DmaTable, read_dma

FILES = 600
"""Each seed is one file; a run of 10,000 takes about two minutes."""

FREQUENCY = {"Hz": 1.0, "hz": 1.0, "kHz": 1e3, "mHz": 1e-3, "rad/s": 0.5 / np.pi, "rad s⁻¹": 0.5 / np.pi}
TEMPERATURE = {"°C": 0.0, "degC": 0.0, "C": 0.0, "deg C": 0.0, "K": -273.15, "°F": None, "℃": 0.0}
MODULUS = {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "N/mm²": 1e6, "N/mm^2": 1e6, "MN/m2": 1e6, "Mpa": 1e6}
STIFFNESS = {"N/m": 1.0, "N/mm": 1e3, "kN/mm": 1e6, "MN/m": 1e6, "N/µm": 1e6, "kN/m": 1e3}
RATIO = {"": 1.0, "-": 1.0, "%": 0.01, "1": 1.0}
NAMES = {
    "frequency": ("Frequency", "freq", "f", "FREQ.", "Frequenz", "Test frequency", "Fréquence"),
    "omega": ("Angular frequency", "omega", "ω", "Angular Frequency ω"),
    "temperature": ("Temperature", "T", "temp", "Temp.", "Sample temperature", "Temperatur", "Température"),
    "storage": ("E'", "Storage modulus", "Storage Modulus E'", "E′", "E_stor", "E_storage", "storage_E", "E’"),
    "loss": ("E''", "Loss modulus", "Loss Modulus E''", "E″", "E_loss", 'E"', "E′′"),
    "stiff": ("Storage stiffness", "K'", "k_storage", "k'"),
    "magnitude": ("|E*|", "E*", "Complex modulus", "Dynamic modulus", "Complex modulus |E*|"),
    "loss_factor": ("tan δ", "tan delta", "Tan(delta)", "tanδ", "loss factor", "tan_d", "Loss factor tan δ"),
    "phase": ("Phase angle", "δ", "delta", "Phase", "Loss angle δ"),
}  # fmt: skip
OTHERS = ("Time [s]", "Static force [N]", "run", "Amplitude [µm]", "Point", "Temperature set point", "F")
JOINS = ("{} [{}]", "{} ({})", "{}, {}", "{} / {}", "{}/{}", "{}_{}", "{} in {}", "{}[{}]", "{} {}")


def truth(random: Generator) -> dict[str, np.ndarray]:
    """Frequencies, temperatures and a modulus over them."""
    f, t = np.meshgrid(
        np.geomspace(0.5, 50.0, random.integers(2, 6)), random.choice([-40.0, -10.0, 5.0, 25.0, 60.0], 3)
    )
    storage = 4e6 * (1.0 + f.ravel() ** 0.3) * 10.0 ** (-t.ravel() / 60.0)
    factor = 0.1 + 0.3 / (1.0 + f.ravel())
    return {"f": f.ravel(), "t": t.ravel(), "storage": storage, "factor": factor}


def pick(random: Generator, options: Any) -> Any:
    return list(options)[random.integers(len(options))]


def columns(random: Generator, true: dict[str, np.ndarray]) -> list[tuple[str, str, np.ndarray]]:
    """Name, unit and values of each column, in an order of its own."""
    omega = random.random() < 0.2
    unit = pick(random, ("rad/s", "rad s⁻¹", "1/s") if omega else FREQUENCY)
    made = [
        (
            pick(random, NAMES["omega" if omega else "frequency"]),
            unit,
            true["f"] / (0.5 / np.pi if omega else FREQUENCY[unit]),
        )
    ]
    unit = pick(random, TEMPERATURE)
    warm = true["t"] * 1.8 + 32.0 if unit == "°F" else true["t"] - TEMPERATURE[unit]
    made.append((pick(random, NAMES["temperature"]), unit, warm))
    way = pick(random, ("loss", "factor", "phase", "absolute", "stiffness"))
    unit = pick(random, STIFFNESS if way == "stiffness" else MODULUS)
    scale = {**STIFFNESS, **MODULUS}[unit]
    first = "stiff" if way == "stiffness" else ("magnitude" if way == "absolute" else "storage")
    value = true["storage"] * (np.hypot(1.0, true["factor"]) if first == "magnitude" else 1.0)
    made.append((pick(random, NAMES[first]), unit, value / scale))
    if way == "loss":
        made.append((pick(random, NAMES["loss"]), unit, true["storage"] * true["factor"] / scale))
    elif way in ("phase", "absolute"):
        angle = pick(random, ("°", "deg", "rad"))
        phase = np.arctan(true["factor"])
        made.append((pick(random, NAMES["phase"]), angle, phase if angle == "rad" else np.degrees(phase)))
    else:
        part = pick(random, RATIO)
        made.append((pick(random, NAMES["loss_factor"]), part, true["factor"] / RATIO[part]))
    for name in random.choice(OTHERS, random.integers(0, 3), replace=False):
        made.append((str(name), "", random.normal(size=len(true["f"]))))
    return [made[i] for i in random.permutation(len(made))]


def written(random: Generator, made: list[tuple[str, str, np.ndarray]]) -> bytes:
    """The file: separator, decimal sign, digits, head, row of units, quotes, character set, as it falls."""
    units_row = random.random() < 0.3
    join = pick(random, JOINS)
    heads = [name if units_row or not unit else join.format(name, unit) for name, unit, _ in made]
    frame = pd.DataFrame({i: values for i, (_, _, values) in enumerate(made)})
    separator, decimal = pick(random, [(",", "."), (";", "."), (";", ","), ("\t", "."), ("\t", ","), (",", ",")])
    digits = pick(random, (None, "%.6g", "%.8e", "%.9f"))
    out = io.StringIO()
    if random.random() < 0.2:
        out.write(f"sep={separator}\n")
    for line in range(random.integers(0, 4) if random.random() < 0.4 else 0):
        out.write(
            pick(random, ("Sample;EPDM 70", "Operator: N. N.", "# made by the machine", "[step]", "Date,1.2.2024"))
        )
        out.write(f" {line}\n")
    body = io.StringIO()
    quoting = pick(random, (csv.QUOTE_MINIMAL, csv.QUOTE_ALL))
    heading = csv.writer(body, delimiter=separator, quoting=quoting, lineterminator="\n")
    heading.writerow(heads)
    if units_row:
        heading.writerow(
            [pick(random, ("{}", "[{}]", "({})")).format(unit) if unit else "" for _, unit, _ in made]
        )
    frame.to_csv(
        body, sep=separator, decimal=decimal, float_format=digits, header=False, index=False, quoting=quoting
    )
    text = out.getvalue() + body.getvalue()
    if random.random() < 0.2:
        text = text.replace("\n", pick(random, ("\r\n", "\r", separator + "\n")))
    encoding = pick(random, ("utf-8", "utf-8-sig", "utf-16", "cp1252"))
    try:
        return text.encode(encoding)
    except UnicodeEncodeError:
        return text.encode("utf-8")


def check(table: DmaTable, true: dict[str, np.ndarray]) -> None:
    rtol = 2e-5
    np.testing.assert_allclose(table.frequency_Hz, true["f"], rtol=rtol)
    assert table.temperature_C is not None
    np.testing.assert_allclose(table.temperature_C, true["t"], atol=2e-3)
    np.testing.assert_allclose(table.storage_Pa, true["storage"], rtol=rtol)
    np.testing.assert_allclose(table.loss_factor, true["factor"], rtol=rtol)


def one(seed: int, folder: Path) -> str:
    """Write and read a file; "read", or the refusal."""
    random = np.random.default_rng(seed)
    true = truth(random)
    made = columns(random, true)
    path = folder / "dma.csv"
    path.write_bytes(written(random, made))
    try:
        table = read_dma(path)
    except InputError as error:
        return str(error)
    # Nine decimals of a gigapascal are few; what is printed coarsely may be read only as printed.
    check(table, true)
    return "read"


def test_what_programs_write_is_read_or_refused(tmp_path: Path) -> None:
    stated = [one(seed, tmp_path) for seed in range(FILES)]
    # Refusals are for what can be read two ways; most files have to be read.
    assert stated.count("read") > 0.98 * FILES


@pytest.mark.parametrize("seed", range(40))
def test_a_unit_in_other_letters_is_refused_or_the_same(tmp_path: Path, seed: int) -> None:
    """mPa is no MPa, N m no N/m: what is not a unit of its quantity does not become one by spelling."""
    random = np.random.default_rng(seed)
    unit = pick(
        random, ("mPa", "mN/m", "N m", "N.m", "N·m", "1/MPa", "MPa s", "mN/m²", "bananas", "MPa/Hz", "%", "s")
    )
    path = tmp_path / "dma.csv"
    for quantity in ("storage", "loss", "magnitude"):
        header = pick(random, JOINS).format(pick(random, NAMES[quantity]), unit)
        path.write_text(f"f_Hz;T_C;{header};tan_delta\n1;20;3;0.1\n2;20;4;0.1\n", encoding="utf-8")
        with pytest.raises(InputError, match="storage"):
            read_dma(path)


BAD_CELLS = (
    "",
    "n/a",
    "nan",
    "inf",
    "---",
    "1e400",
    "1.2.3",
    "12 MPa",
    "1,2,3",
    "0x10",
    "1_0",
    "-5",
    "0",
    "\u0663",
    "1e",
    "#REF!",
)


def damaged(random: Generator, lines: list[str], asked: list[int], separator: str) -> tuple[str, bool]:
    """A file with one fault, and whether it has to be refused."""
    way = pick(random, ("cell", "spare", "short", "long", "header", "unit", "comma", "text", "again", "cut"))
    rows = list(lines)
    at = int(random.integers(1, len(rows)))
    cells = rows[at].split(separator)
    if way in ("cell", "spare"):
        column = pick(random, asked) if way == "cell" else len(cells) - 1
        cells[column] = pick(random, BAD_CELLS)
        rows[at] = separator.join(cells)
        return "\n".join(rows) + "\n", way == "cell"
    if way in ("short", "long"):
        rows[at] = separator.join(cells[:-1] if way == "short" else [*cells, "1"])
    elif way == "header":
        heads = rows[0].split(separator)
        heads[pick(random, asked)] = pick(random, ("", "column", "E'/E0", "log f", "E' norm", "aT f", "rate"))
        rows[0] = separator.join(heads)
    elif way == "unit":
        heads = rows[0].split(separator)
        column = pick(random, asked)
        heads[column] = heads[column].split("[")[0] + pick(random, ("[mPa]", "[s]", "[?]", "[1/MPa]", "[%/K]"))
        rows[0] = separator.join(heads)
    elif way == "comma":
        cells[pick(random, asked)] = "1,5"
        rows[at] = separator.join(cells)
    elif way == "text":
        rows.insert(at, separator.join("x" * (k + 1) for k in range(len(cells))))
    elif way == "again":
        rows.insert(at, rows[0])
        return "\n".join(rows) + "\n", False
    else:
        whole = "\n".join(rows)
        end = whole.rindex(separator)
        return whole[: random.integers(whole.index("\n") + 2, end)], False
    return "\n".join(rows) + "\n", True


@pytest.mark.parametrize("seed", range(400))
def test_a_damaged_table_is_refused_or_what_is_left_of_it_is_right(tmp_path: Path, seed: int) -> None:
    random = np.random.default_rng(seed)
    true = truth(random)
    separator = pick(random, (";", "\t"))
    names = ["f [Hz]", "T [°C]", "E' [MPa]", "tan δ [%]", "remark"]
    columns = [true["f"], true["t"], true["storage"] / 1e6, 100.0 * true["factor"]]
    order = [*random.permutation(4).tolist(), 4]
    lines = [separator.join(names[i] for i in order)]
    for row in range(len(true["f"])):
        cells = [*(f"{column[row]:.9f}" for column in columns), "0"]
        lines.append(separator.join(cells[i] for i in order))
    text, refused = damaged(random, lines, [0, 1, 2, 3], separator)
    # A temperature of -5 or 0 is one like any other.
    path = tmp_path / "dma.csv"
    path.write_text(text, encoding="utf-8")
    try:
        table = read_dma(path)
    except InputError:
        return
    left = slice(0, len(table))
    same = np.isclose(table.frequency_Hz, true["f"][left]) & np.isclose(table.storage_Pa, true["storage"][left])
    same &= np.isclose(table.loss_factor, true["factor"][left])
    assert same[:-1].all()
    assert table.temperature_C is not None
    warm = np.isclose(table.temperature_C, true["t"][left])
    if refused:
        wrong = np.flatnonzero(~warm)
        assert len(wrong) == 1
        assert table.temperature_C[wrong[0]] in (-5.0, 0.0)
    else:
        assert warm.all()
