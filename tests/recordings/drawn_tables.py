"""Random tables and timetables of MATLAB by mat-io."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
from drawn import RATES, Meaning, Times, chance, pick, signals


def times(random: np.random.Generator, folder: Path) -> tuple[Path, Meaning]:
    """A table with a column of times, or a timetable by durations or dates; alone or beside a text."""
    with warnings.catch_warnings():
        # Importing it sets an option of pandas that is on its way out.
        warnings.simplefilter("ignore")
        import pandas as pd
        from matio import save_to_mat

    count, samples = int(random.integers(1, 5)), int(random.integers(3, 200))
    x = signals(random, count, samples).astype(pick(random, "f8", "f4"))
    rate = pick(random, *RATES)
    names = [pick(random, "acc", "box", "Kanal") + f"{i}" for i in range(count)]
    frame = pd.DataFrame(dict(zip(names, x, strict=True)))
    if chance(random, 0.2):
        frame["state"] = [pick(random, "on", "off") for _ in range(samples)]
    moments = np.arange(samples) / rate
    kind = pick(random, "table", "duration", "datetime")
    precision = 1e-4
    if kind == "table":
        frame.insert(int(random.integers(0, len(frame.columns) + 1)), pick(random, "Time", "t", "time_s"), moments)
    else:
        whole = np.round(moments * 1e9).astype("timedelta64[ns]")
        frame.index = pd.Index(whole if kind == "duration" else np.datetime64("2026-01-05T10:00:00", "ns") + whole)
        frame.index.name = pick(random, "Time", "Zeitstempel")
        precision = max(1e-4, 2e-9 * rate / (samples - 1))
    held = {"T": frame} if chance(random, 0.7) else {"T": frame, "note": "run 7"}
    path = folder / "t.mat"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        save_to_mat(str(path), mdict=held, version=pick(random, "v7", "v7.3"))
    labels = names if len(held) == 1 else [f"{name}" for name in names]
    channels = dict(zip(labels, x.astype("f8"), strict=True))
    ask = {"channels": labels, "part": "T"} if len(held) > 1 else {"channels": labels}
    return path, Times(channels, dict.fromkeys(labels, None), rate, 1e-12, precision, ask)
