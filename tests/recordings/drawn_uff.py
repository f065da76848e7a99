"""Random universal files by pyuff, and by hand where pyuff does not write what others do."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyuff
import written
from drawn import RATES, UNITS, Meaning, Responses, Times, by_pair, chance, pick, responses, signals

_TYPES = {"m": 8, "mm": 8, "um": 8, "m/s": 11, "mm/s": 11, "N": 13, "kN": 13, "V": 0, "mV": 0}
_SYSTEMS = {"m": 1.0, "mm": 1e3, "cm": 1e2}


def _unit(random: np.random.Generator) -> str | None:
    return pick(random, None, *(u for u in UNITS))


def times(random: np.random.Generator, folder: Path) -> tuple[Path, Meaning]:
    """Records in time."""
    count, samples = int(random.integers(1, 4)), int(random.integers(3, 60))
    x = signals(random, count, samples)
    rate = pick(random, *RATES)
    path = folder / "a.uff"
    path.unlink(missing_ok=True)
    binary, even, double = int(chance(random, 0.5)), int(chance(random, 0.6)), chance(random, 0.7)
    scale, axis_unit = pick(random, (1.0, "s"), (1e3, "ms"), (1e6, "us"), (1.0, "NONE"))
    node0 = chance(random, 0.2)
    system = pick(random, None, None, "m", "mm")
    if system is not None:
        length = _SYSTEMS[system]
        written.append_uff(
            path,
            pyuff.prepare_164(
                units_code=1, units_description="own", temp_mode=1, length=length, force=1.0, temp=1.0,
                temp_offset=273.15,
            ),
        )  # fmt: skip
    units: dict[str, str | None] = {}
    meant: dict[str, np.ndarray] = {}
    for i, row in enumerate(x):
        unit = _unit(random)
        kind = _TYPES.get(unit or "", 12)
        name = f"Prüfer {i}" if chance(random, 0.3) else f"S{i}"
        label = name if node0 else f"{i + 1}:+Z"
        dataset = pyuff.prepare_58(
            binary=binary, func_type=1, rsp_node=0 if node0 else i + 1, rsp_dir=0 if node0 else 3, ref_node=0,
            ref_dir=0, rsp_ent_name=name, data=row,
            x=np.arange(samples) / rate * scale, id1=f"run {i}", abscissa_spacing=even, abscissa_spec_data_type=17,
            abscissa_axis_units_lab=axis_unit, ordinate_spec_data_type=kind,
            ordinate_axis_units_lab=unit or "NONE", orddenom_spec_data_type=0, ord_data_type=4 if double else 2,
        )  # fmt: skip
        written.append_uff(path, dataset)
        by_system = system is not None and unit is None and kind == 12
        units[label] = unit or (f"{system}/s2" if by_system else None)
        factor = UNITS[unit] if unit else (1.0 / _SYSTEMS[system] if by_system and system else 1.0)
        meant[label] = row * factor
    return path, Times(channels=meant, units=units, rate_Hz=rate, precision=2e-5, rate_precision=2e-4)


def frf(random: np.random.Generator, folder: Path) -> tuple[Path, Meaning]:
    """Frequency responses with their coherence."""
    f, values, coherence = responses(random)
    count = values.shape[1:]
    path = folder / "frf.uff"
    path.unlink(missing_ok=True)
    over, under, factor = pick(
        random, ("m/s2", "N", 1.0), ("mm", "kN", 1e-6), ("g", "N", 9.80665), ("NONE", "NONE", 1.0),
        ("(m/s2)/N", "N", 1.0),
    )  # fmt: skip
    scale, axis_unit = pick(random, (1.0, "Hz"), (1e-3, "kHz"), (2.0 * np.pi, "rad/s"), (1.0, "NONE"))
    axis = pick(random, 18, 18, 18, 19)
    binary, even = int(chance(random, 0.5)), int(chance(random, 0.5))
    real = chance(random, 0.1)
    for kind, table in ((4, np.abs(values) if real else values), (6, coherence)):
        for i in range(count[0]):
            for j in range(count[1]):
                dataset = pyuff.prepare_58(
                    binary=binary, func_type=kind, rsp_node=10 + i, rsp_dir=-1, ref_node=20 + j, ref_dir=2,
                    data=table[:, i, j], x=f * scale, abscissa_spacing=even, abscissa_spec_data_type=axis,
                    abscissa_axis_units_lab=axis_unit, ordinate_spec_data_type=8 if over == "mm" else 12,
                    orddenom_spec_data_type=13, ordinate_axis_units_lab=over if kind == 4 else "NONE",
                    orddenom_axis_units_lab=under if kind == 4 else "NONE",
                )  # fmt: skip
                written.append_uff(path, dataset)
    sensors, points = [f"{10 + i}:-X" for i in range(count[0])], [f"{20 + j}:+Y" for j in range(count[1])]
    lines = f if axis == 18 else f * np.nan
    stated = None if over == "NONE" else factor
    return path, Responses(
        lines,
        by_pair(values, sensors, points, factor),
        by_pair(coherence, sensors, points),
        stated,
        precision=1e-6,
    )
