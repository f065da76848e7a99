"""Random MDF files by asammdf."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from drawn import RATES, UNITS, Meaning, Times, chance, pick, signals


def times(random: np.random.Generator, folder: Path) -> tuple[Path, Meaning]:
    """Groups of channels at rates of their own, as floats or as whole numbers with a conversion."""
    from asammdf import MDF, Signal

    version = pick(random, "3.30", "4.10", "4.11", "4.20")
    meant: dict[str, tuple[np.ndarray, str | None, float]] = {}
    path = folder / pick(random, "a.mf4", "a.mdf")
    with MDF(version=version) as file:
        for group in range(int(random.integers(1, 4))):
            samples, rate = int(random.integers(3, 200)), pick(random, *RATES)
            start = pick(random, 0.0, 0.0, 12.5)
            moments = start + np.arange(samples) / rate
            if chance(random, 0.1):
                moments[-1] += 0.5 / rate
                rate = float("nan")
            found = []
            for number, row in enumerate(signals(random, int(random.integers(1, 4)), samples)):
                name = pick(random, f"acc {group}{number}", f"box.{group}.{number}", f"Prüfer {group} {number}")
                unit = pick(random, None, *UNITS)
                kind = pick(random, "f8", "f4", "i2")
                conversion: Any = None
                if kind == "i2":
                    row = random.integers(-30_000, 30_000, samples).astype("i2")
                    factor, offset = 10.0 ** random.integers(-6, 1), float(random.integers(-3, 4))
                    conversion = {"a": factor, "b": offset}
                    value = row * factor + offset
                else:
                    row = row.astype(kind)
                    value = row.astype("f8")
                found.append(Signal(row, moments, unit=unit or "", name=name, conversion=conversion))
                meant[name] = (value * (UNITS[unit] if unit else 1.0), unit, rate)
            file.append(found, acq_name=pick(random, f"raster {group}", "raster"), common_timebase=True)
        saved = file.save(path, overwrite=True, compression=int(random.integers(0, 3)) if version > "4" else 0)
    wanted = pick(random, *meant)
    value, unit, rate = meant[wanted]
    return Path(saved), Times({wanted: value}, {wanted: unit}, rate, 1e-6, ask={"channels": [wanted]})
