"""Files as measuring teams hand them over: UFF 58 or MAT of hammer tests, CSV or NPZ of runs."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import scipy.io

from permway.challenge.beams import Complexes, Reals
from permway.challenge.measure import HammerTest, Run
from permway.challenge.track import Location

NODE = {"rail": 1, "slab": 2, "base": 3, "girder": 4}
_EPOCH = (2026, 1, 1, 0, 0, 0)
_BLANK = " " * 80


def write_uff(path: Path, test: HammerTest, sensors: tuple[Location, ...], points: tuple[Location, ...]) -> None:
    """Universal file, dataset 58: a frequency response and a coherence for each pair."""
    parts: list[str] = []
    for j, point in enumerate(points):
        for i, sensor in enumerate(sensors):
            parts += _function(sensor, point, test.frequency_Hz, test.frf[:, i, j])
            parts += _function(sensor, point, test.frequency_Hz, test.coherence[:, i, j])
    path.write_text("\n".join(parts) + "\n", encoding="ascii")


def _function(sensor: Location, point: Location, frequency_Hz: Reals, values: Complexes | Reals) -> Iterable[str]:
    kind, ordinate = (4, 6) if np.iscomplexobj(values) else (6, 4)
    yield f"{-1:6d}"
    yield f"{58:6d}".ljust(80)
    yield f"{sensor[0]} {sensor[1]} m / {point[0]} {point[1]} m".ljust(80)
    yield from [_BLANK] * 4
    places = "".join(f"{location[0]:>11s}{node_of(location):10d}{3:4d}" for location in (sensor, point))
    yield f"{kind:5d}{0:10d}{0:5d}{0:10d}{places}"
    step = float(frequency_Hz[1] - frequency_Hz[0])
    yield f"{ordinate:10d}{frequency_Hz.size:10d}{1:10d}{frequency_Hz[0]:13.5e}{step:13.5e}{0.0:13.5e}"
    units = ((18, "Hz"), (12, "m/s^2"), (13, "N"), (0, "NONE"))
    yield from (f"{number:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20s} {unit:<20s}" for number, unit in units)
    numbers = np.stack([values.real, values.imag], axis=1).ravel() if kind == 4 else np.asarray(values.real)
    per_row = 4
    for at in range(0, numbers.size, per_row):
        yield "".join(f"{number:20.11e}" for number in numbers[at : at + per_row])
    yield f"{-1:6d}"


def node_of(location: Location) -> int:
    """A UFF node: 10000 times the body's number and x in cm."""
    return 10000 * NODE[location[0]] + round(100.0 * location[1])


def write_mat(path: Path, test: HammerTest, sensors: tuple[Location, ...], points: tuple[Location, ...]) -> None:
    """MAT file, version 5, single precision."""
    content = {
        "f": test.frequency_Hz,
        "frf": test.frf.astype(np.complex64),
        "coh": test.coherence.astype(np.float32),
        "sensor": np.array([f"{body}@{x}" for body, x in sensors]),
        "hammer": np.array([f"{body}@{x}" for body, x in points]),
    }
    scipy.io.savemat(str(path), content)
    # The head names the time of writing, which would make two files of one seed differ.
    head = b"MATLAB 5.0 MAT-file Platform: posix".ljust(116)
    path.write_bytes(head + path.read_bytes()[116:])


def write_csv(path: Path, run: Run) -> None:
    """Four significant digits, a column for each channel."""
    buffer = io.StringIO()
    np.savetxt(buffer, run.values, fmt="%.4g", delimiter=",", header=",".join(run.channels), comments="")
    path.write_text(buffer.getvalue(), encoding="ascii")


def write_npz(path: Path, run: Run) -> None:
    """Single precision, with sampling rate and channels' names."""
    content = {
        "fs": np.asarray(run.sampling_Hz),
        "acceleration": run.values.astype(np.float32),
        "channels": np.array(run.channels),
    }
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, values in content.items():
            buffer = io.BytesIO()
            np.lib.format.write_array(buffer, values)
            # numpy's own writer puts in the time of day.
            archive.writestr(
                zipfile.ZipInfo(f"{name}.npy", date_time=_EPOCH), buffer.getvalue(), zipfile.ZIP_DEFLATED
            )
