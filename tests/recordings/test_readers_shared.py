"""The recordings beside the project: all read, quickly and in little memory."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import pyuff
from permway.recordings.readers import read_frf, read_table, read_time

SHARED = Path(__file__).parents[3] / "shared"
CAMPAIGNS = sorted((SHARED / "campaigns").glob("*/sheet.json"))
needs_shared = pytest.mark.skipif(not CAMPAIGNS, reason="../shared is absent")


@needs_shared
def test_every_campaign_and_recording() -> None:
    """Measured: 43 campaign files and 18 tables in 11 s of processor time, 170 MB; a UFF file of 6 MB in 0.5 s."""
    # In a process of its own, by VmHWM: getrusage's ru_maxrss is at least what the parent had when it forked.
    code = r"""
import json, re, sys
from pathlib import Path
from permway.recordings.readers import read_frf, read_table, read_time
shared, count = Path(sys.argv[1]), 0
for path in sorted(shared.glob("campaigns/*/*")):
    if path.name.startswith("hammer"):
        record = read_frf(path)
        assert record.values.shape == (243, 399), path
        assert record.coherence is not None and record.frequency_Hz[[0, -1]].tolist() == [2.0, 400.0], path
    elif path.name.startswith("run"):
        record = read_time(path, sampling_Hz=1024.0, units="m/s^2")
        assert record.values.shape == (6, 65536), path
    else:
        continue
    count += 1
tables = [path for path in sorted(shared.glob("recordings/*/**/*")) if path.suffix in (".csv", ".tsv")]
for path in tables:
    assert len(read_table(path)) > 5, path
kilobytes = re.search(r"VmHWM:\s*(\d+) kB", Path("/proc/self/status").read_text())[1]
print(count, len(tables), int(kilobytes) // 1024)
"""
    run = subprocess.run([sys.executable, "-c", code, str(SHARED)], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    files, tables, megabytes = map(int, run.stdout.split())
    assert files == sum(len(list(path.parent.glob("[hr]*.*"))) for path in CAMPAIGNS)
    assert len(CAMPAIGNS) == 14
    assert tables >= 15
    assert megabytes < 1000


@needs_shared
def test_a_campaign_against_pyuff() -> None:
    path = SHARED / "campaigns" / "practice-1" / "hammer_+12C.uff"
    record = read_frf(path)
    assert record.unit == "(m/s^2)/N"
    assert record.coherence is not None
    sets = pyuff.UFF(str(path)).read_sets()
    assert len(sets) == 2 * len(record.responses)
    for dataset in sets:
        row = record.index(f"{dataset['rsp_node']}:+Z", f"{dataset['ref_node']}:+Z")
        ours = record.values[row] if dataset["func_type"] == 4 else record.coherence[row]
        np.testing.assert_array_equal(ours, dataset["data"])


@needs_shared
def test_a_campaign_against_numpy() -> None:
    folder = SHARED / "campaigns" / "practice-1"
    record = read_time(folder / "run_200kmh.csv")
    np.testing.assert_array_equal(
        record.values.T, np.loadtxt(folder / "run_200kmh.csv", delimiter=",", skiprows=1)
    )
    assert (record.sampling_Hz, record.units) == (None, (None,) * 6)
    folder = SHARED / "campaigns" / "practice-2"
    record = read_time(folder / "run_200kmh.npz")
    with np.load(folder / "run_200kmh.npz") as file:
        np.testing.assert_array_equal(record.values.T, file["acceleration"])
        assert record.sampling_Hz == float(file["fs"])


@needs_shared
def test_tables() -> None:
    decay = read_table(SHARED / "recordings" / "track-decay" / "tdr_reference_section.csv")
    assert decay.texts("rail")[:2] == ("li", "li")
    assert decay.numbers("100")[0] == 12.0
    rough = read_table(SHARED / "recordings" / "track-decay" / "rail_roughness_reference_section.csv")
    assert np.isnan(rough.numbers("0.1259")).all() or rough.texts("0.1259")
    eva = read_table(SHARED / "recordings" / "pad-materials" / "eva" / "storage_modulus_MPa.tsv")
    assert (eva.numbers("column 1")[0], eva.numbers("column 2")[0]) == (0.0, 47.0)
