"""Universal files: by pyuff, by hand after the specification, and both readers held against each other.

Source of the layout: University of Cincinnati, SDRL, "Universal File Formats for Modal Analysis Testing", datasets
55 and 58: fields of fixed width, 6E13.5 in single and 4E20.12 in double precision.
"""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
import pyuff
import written
from permway.errors import InputError
from permway.recordings.readers import read_frf, read_table, read_time


def header(
    kind: int, function: int, count: int, *, even: bool, start: float = 2.0, step: float = 0.5, node: int = 101,
    way: int = 3, axis: int = 18, first: str = "    58",
) -> str:  # fmt: skip
    lines = [
        "    -1",
        first,
        "hammer",
        "NONE",
        "NONE",
        "NONE",
        "NONE",
        f"{function:5d}{0:10d}{0:5d}{0:10d} {'rail':<10s}{node:10d}{way:4d} {'rail':<10s}{7:10d}{-3:4d}",
        f"{kind:10d}{count:10d}{int(even):10d}{start:13.5E}{step:13.5E}{0.0:13.5E}",
        f"{axis:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20s} {'s' if axis == 17 else 'Hz':<20s}",
        f"{12:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20s} {'m/s^2':<20s}",
        f"{13:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20s} {'N':<20s}",
        f"{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20s} {'NONE':<20s}",
    ]
    return "\n".join(lines) + "\n"


def body(numbers: np.ndarray, formats: tuple[str, ...]) -> str:
    cells = [f"{value:{formats[i % len(formats)]}}" for i, value in enumerate(numbers)]
    lines = ["".join(cells[i : i + len(formats)]) for i in range(0, len(cells), len(formats))]
    return "\n".join(lines) + "\n"


SINGLE, DOUBLE = "13.5E", "20.11E"
LAYOUTS = {
    (2, True): (SINGLE,) * 6,
    (4, True): (DOUBLE,) * 4,
    (5, True): (SINGLE,) * 6,
    (6, True): (DOUBLE,) * 4,
    (2, False): (SINGLE,) * 6,
    (4, False): (SINGLE, DOUBLE) * 2,
    (5, False): (SINGLE,) * 6,
    (6, False): (SINGLE, DOUBLE, DOUBLE),
}


@pytest.mark.parametrize(("kind", "even"), LAYOUTS)
def test_by_hand_in_every_layout(kind: int, even: bool, tmp_path: Path) -> None:
    rng = np.random.default_rng(kind)
    is_complex = kind in (5, 6)
    x = 2.0 + 0.5 * np.arange(17)
    # Negative numbers with three-digit exponents fill their field, and touch their neighbours.
    values = -np.abs(rng.standard_normal((17, 2 if is_complex else 1)))
    columns = values if even else np.column_stack([x, values])
    text = header(kind, 4 if is_complex else 1, 17, even=even, axis=18 if is_complex else 17)
    path = tmp_path / "a.uff"
    path.write_text(text + body(columns.ravel(), LAYOUTS[kind, even]) + "    -1\n")
    bound = 5e-6 if kind in (2, 5) else 1e-11
    if is_complex:
        record = read_frf(path)
        assert (record.responses, record.references, record.unit) == (("101:+Z",), ("7:-Z",), "(m/s^2)/N")
        np.testing.assert_allclose(record.frequency_Hz, x, rtol=1e-12)
        np.testing.assert_allclose(record.values[0], values[:, 0] + 1j * values[:, 1], rtol=bound)
    else:
        time = read_time(path)
        assert (time.channels, time.start_s, time.sampling_Hz) == (("101:+Z",), 2.0, 2.0)
        np.testing.assert_allclose(time.values[0], values[:, 0], rtol=bound)


def test_numbers_that_touch(tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    row = "-1.23456E-100-2.34567E-101-3.45678E+100\n"
    path.write_text(header(2, 1, 3, even=True, axis=17) + row + "    -1\n")
    np.testing.assert_array_equal(read_time(path).values[0], [-1.23456e-100, -2.34567e-101, -3.45678e100])


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("kind", [2, 4, 5, 6])
def test_binary_by_hand(kind: int, order: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(kind)
    is_complex = kind in (5, 6)
    values = rng.standard_normal((9, 2 if is_complex else 1)).astype("f4" if kind in (2, 5) else "f8")
    # A payload with the closing line's own bytes in it must not end the dataset.
    if kind == 4:
        values[3] = struct.unpack(order + "d", b"\n    -1\n")[0]
    payload = values.astype(values.dtype.newbyteorder(order)).tobytes()
    first = f"    58b{1 if order == '<' else 2:6d}{2:6d}{11:12d}{len(payload):12d}{0:6d}{0:6d}{0:12d}{0:12d}"
    text = header(kind, 4 if is_complex else 1, 9, even=True, axis=18 if is_complex else 17, first=first)
    path = tmp_path / "a.uff"
    # Both ways in which the closing line is written: at once, and on a line of its own.
    for closing in (b"    -1\n", b"\n    -1\n"):
        path.write_bytes(text.encode() + payload + closing)
        if is_complex:
            np.testing.assert_array_equal(read_frf(path).values[0], values[:, 0] + 1j * values[:, 1])
        else:
            np.testing.assert_array_equal(read_time(path).values[0], values[:, 0])


@pytest.mark.parametrize("binary", [0, 1])
@pytest.mark.parametrize("even", [0, 1])
def test_frequency_responses_by_pyuff(binary: int, even: int, tmp_path: Path) -> None:
    frequency, values, coherence = written.frf()
    path = tmp_path / "a.uff"
    for kind, table in ((4, values), (6, coherence)):
        for i in range(2):
            for j in range(3):
                dataset = pyuff.prepare_58(
                    binary=binary,
                    func_type=kind,
                    rsp_node=10 + i,
                    rsp_dir=-1,
                    ref_node=20 + j,
                    ref_dir=2,
                    data=table[:, i, j],
                    x=frequency,
                    abscissa_spacing=even,
                    abscissa_spec_data_type=18,
                    ordinate_spec_data_type=12,
                    orddenom_spec_data_type=13,
                )
                written.append_uff(path, dataset)
    record = read_frf(path)
    assert record.unit is None
    np.testing.assert_allclose(record.frequency_Hz, frequency, rtol=1e-12)
    for i in range(2):
        for j in range(3):
            row = record.index(f"{10 + i}:-X", f"{20 + j}:+Y")
            np.testing.assert_allclose(record.values[row], values[:, i, j], rtol=1e-10)
            assert record.coherence is not None
            np.testing.assert_allclose(record.coherence[row], coherence[:, i, j], rtol=1e-10)


def test_mode_shapes_and_responses_at_nodes_by_pyuff(tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    path = tmp_path / "a.uff"
    shape = rng.standard_normal((2, 3, 4))
    for n in range(2):
        dataset = pyuff.prepare_55(
            model_type=1, analysis_type=2, data_ch=2, spec_data_type=8, data_type=2, n_data_per_node=3,
            r1=shape[n, 0], r2=shape[n, 1], r3=shape[n, 2], node_nums=[1, 2, 3, 4], load_case=1, mode_n=n + 1,
            modal_m=1.0, freq=10.0 + n, modal_damp_vis=0.02, modal_damp_his=0.0,
        )  # fmt: skip
        written.append_uff(path, dataset)
    table = read_table(path)
    np.testing.assert_array_equal(table.numbers("node"), [1, 2, 3, 4] * 2)
    np.testing.assert_array_equal(table.numbers("frequency"), [10.0] * 4 + [11.0] * 4)
    np.testing.assert_array_equal(table.numbers("damping"), [0.02] * 8)
    np.testing.assert_allclose(table.numbers("Z"), shape[:, 2].ravel(), rtol=5e-6)


def test_responses_at_nodes_are_frequency_responses(tmp_path: Path) -> None:
    rng = np.random.default_rng(4)
    path = tmp_path / "a.uff"
    values = rng.standard_normal((5, 3, 2)) + 1j * rng.standard_normal((5, 3, 2))
    for n in range(5):
        dataset = pyuff.prepare_55(
            model_type=1, analysis_type=5, data_ch=2, spec_data_type=12, data_type=5, n_data_per_node=3,
            r1=values[n, 0], r2=values[n, 1], r3=values[n, 2], node_nums=[11, 12], load_case=1, freq_step_n=n + 1,
            freq=20.0 + n,
        )  # fmt: skip
        written.append_uff(path, dataset)
    record = read_frf(path)
    np.testing.assert_array_equal(record.frequency_Hz, 20.0 + np.arange(5))
    np.testing.assert_allclose(record.pair("12:+Y", "0"), values[:, 1, 1], rtol=5e-6)


def test_other_datasets_are_left_and_windows_lines_read(tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    other = "    -1\n   151\nmodel\nanything -1\n    -1\n"
    text = (
        other + header(4, 1, 3, even=True, axis=17) + body(np.array([1.0, 2.0, 3.0]), (DOUBLE,) * 4) + "    -1\n"
    )
    path.write_bytes((text + other).replace("\n", "\r\n").encode())
    np.testing.assert_array_equal(read_time(path).values, [[1.0, 2.0, 3.0]])


def test_a_function_cut_short_is_refused_where_pyuff_gives_less(tmp_path: Path) -> None:
    """Why the reader is written by hand: four points announced and two there are a record of two for pyuff."""
    path = tmp_path / "a.uff"
    path.write_text(header(6, 4, 4, even=True) + body(np.arange(4.0), (DOUBLE,) * 4) + "    -1\n")
    assert pyuff.UFF(str(path)).read_sets()["data"].size == 2
    with pytest.raises(InputError, match="line 9: 4 points announced, which take 2 lines, but 1 are there"):
        read_frf(path)
