"""The deck's hammer test and one run as five programs export them, after their public descriptions."""

from __future__ import annotations

import csv
import struct
import sys
import warnings
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pyuff
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter
from scipy import io

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"
Arrays = dict[str, np.ndarray]
NODES = {"rail": 106, "deck": 203, "rail 6.0": 106, "rail 9.3": 109, "deck 4.5": 204}
UNIT = "(m/s2)/N"


def measure(folder: Path) -> Arrays:
    """The deck's records and model in a folder; its frequency responses."""
    sys.path.insert(0, str(EXAMPLES))
    try:
        import_module("make_deck").write(folder)
        found: Arrays = import_module("blows_to_frf").responses(folder)
    finally:
        sys.path.remove(str(EXAMPLES))
    return found


def spreadsheet(path: Path, data: Arrays) -> None:
    """Two header lines with joined cells, a line of units, semicolons and decimal commas."""
    over, parts, units = ["Frequency"], [""], ["Hz"]
    columns = [data["f"]]
    for i, sensor in enumerate(data["sensor"]):
        for j, point in enumerate(data["hammer"]):
            over += [f"{sensor} / {point}", "", ""]
            parts += ["Real", "Imag", "Coherence"]
            units += [UNIT, UNIT, ""]
            columns += [data["frf"][:, i, j].real, data["frf"][:, i, j].imag, data["coh"][:, i, j]]
    rows = [[repr(float(v)).replace(".", ",") for v in row] for row in np.column_stack(columns)]
    with path.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, delimiter=";").writerows([over, parts, units, *rows])


def modal_set(path: Path, data: Arrays) -> None:
    """Universal datasets 58b: six responses and six coherences by node and direction."""
    path.unlink(missing_ok=True)
    for kind, table in ((4, data["frf"]), (6, data["coh"])):
        for i, sensor in enumerate(data["sensor"]):
            for j, point in enumerate(data["hammer"]):
                dataset = pyuff.prepare_58(
                    binary=1, func_type=kind, rsp_node=NODES[str(sensor)], rsp_dir=-3, ref_node=NODES[str(point)],
                    ref_dir=-3, data=table[:, i, j], x=data["f"], abscissa_spacing=1, abscissa_spec_data_type=18,
                    abscissa_axis_units_lab="Hz", ordinate_spec_data_type=12, orddenom_spec_data_type=13,
                    ordinate_axis_units_lab="m/s^2" if kind == 4 else "NONE",
                    orddenom_axis_units_lab="N" if kind == 4 else "NONE", ord_data_type=6 if kind == 4 else 4,
                )  # fmt: skip
                with warnings.catch_warnings():
                    # The writer leaves its file open.
                    warnings.simplefilter("ignore", ResourceWarning)
                    pyuff.UFF(str(path)).write_sets(dataset, mode="add")


def struct_of_arrays(path: Path, data: Arrays) -> None:
    """A struct, as save -v7 writes it."""
    names = {key: np.array(data[key], dtype=object) for key in ("sensor", "hammer")}
    inner = {"f": data["f"], "frf": data["frf"], "coh": data["coh"], "unit": UNIT, **names}
    io.savemat(path, {"blows": inner}, do_compression=True)


def hdf5_of_matlab(path: Path, data: Arrays) -> None:
    """As save -v7.3 writes it: axes turned, complex numbers as pairs, texts as numbers."""
    with h5py.File(path, "w", userblock_size=512) as file:

        def put(name: str, value: np.ndarray, kind: str) -> None:
            file.create_dataset(name, data=value).attrs["MATLAB_class"] = np.bytes_(kind)

        def text(name: str, value: str) -> None:
            put(name, np.array([[ord(c)] for c in value], dtype=np.uint16), "char")

        turned = np.ascontiguousarray(data["frf"].transpose())
        pairs = np.empty(turned.shape, dtype=[("real", "f8"), ("imag", "f8")])
        pairs["real"], pairs["imag"] = turned.real, turned.imag
        put("f", data["f"][None, :], "double")
        put("frf", pairs, "double")
        put("coh", np.ascontiguousarray(data["coh"].transpose()), "double")
        text("unit", UNIT)
        for key in ("sensor", "hammer"):
            cells = []
            for i, name in enumerate(data[key]):
                text(f"#refs#/{key}{i}", str(name))
                cells.append([file[f"#refs#/{key}{i}"].ref])
            names = file.create_dataset(key, data=np.array(cells, dtype=h5py.ref_dtype), dtype=h5py.ref_dtype)
            names.attrs["MATLAB_class"] = np.bytes_("cell")
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + struct.pack("<H", 0x0200) + b"IM"
    with path.open("r+b") as raw:
        raw.write(head)


def labview(path: Path, folder: Path) -> None:
    """The slower run as TDMS, with the increment and the unit of each channel."""
    values = np.loadtxt(folder / "run_144.csv", delimiter=",", skiprows=2)
    about: dict[str, Any] = {"wf_increment": 1.0 / 512.0, "wf_start_offset": 0.0, "unit_string": "m/s^2"}
    with TdmsWriter(str(path)) as file:
        channels = [
            ChannelObject("run", name, np.ascontiguousarray(column), properties=about)
            for name, column in zip(("axlebox1", "axlebox3"), values.T, strict=True)
        ]
        file.write_segment([RootObject(), GroupObject("run"), *channels])


WRITERS: dict[str, Callable[[Path, Arrays], None]] = {
    "blows.csv": spreadsheet,
    "blows.uff": modal_set,
    "blows_v7.mat": struct_of_arrays,
    "blows_v73.mat": hdf5_of_matlab,
}


def write(folder: Path) -> None:
    """All five, beside the deck's own files."""
    data = measure(folder)
    for name, writer in WRITERS.items():
        writer(folder / name, data)
    labview(folder / "run_144.tdms", folder)
