"""What was read of each record, as a table."""

from __future__ import annotations

from typing import Any

import numpy as np

from permway.campaign.load import Dataset
from permway.checking.check import Checked
from permway.checking.compared import Compared
from permway.checking.deviations import DECIBELS, levels_dB


def record_rows(checked: Checked) -> list[dict[str, Any]]:
    """A row for each record that could be read.

    Returns
    -------
    list of dict
        `record`, `statistic`, `channels`, `points`, `lines`, `from_Hz`, `to_Hz`; `level_dB`, the median of
        measured over predicted, and `scatter_dB`, half of what holds 68 % of the lines, both without what the
        blunders explain; `coherence`, its median; `noise_dB`, the median standard deviation of a line's level by
        noise. Empty where there is none.
    """
    compared = {dataset.record.name: right for dataset, _, right in checked.records}
    return [_row(dataset, compared.get(dataset.record.name)) for dataset in checked.reading.whole]


def _row(dataset: Dataset, right: Compared | None) -> dict[str, Any]:
    data = dataset.data
    frequency = data["band" if "band" in data.dims else "frequency"].values
    channels = "sensor" if "sensor" in data.dims else "channel"
    row: dict[str, Any] = {
        "record": dataset.record.name,
        "statistic": dataset.record.statistic,
        "channels": int(data.sizes.get(channels, 1)),
        "points": int(data.sizes.get("force", 0)) or "",
        "lines": int(frequency.size),
        "from_Hz": float(frequency.min()),
        "to_Hz": float(frequency.max()),
        "level_dB": "",
        "scatter_dB": "",
        "coherence": "",
        "noise_dB": "",
    }
    if right is not None and right.used.any():
        levels = levels_dB(right)
        low, middle, high = np.nanpercentile(levels, [16.0, 50.0, 84.0])
        variance = np.median(right.variance[right.used])
        row |= {"level_dB": round(float(middle), 1), "scatter_dB": round(float(0.5 * (high - low)), 1)}
        row["noise_dB"] = round(float(DECIBELS * np.sqrt(variance)), 2)
    if data.attrs.get("noise") == "scatter":
        row["coherence"] = "none: scatter of lines"
    elif "coherence" in data:
        row["coherence"] = round(float(np.nanmedian(data["coherence"].values)), 3)
    return row


def labels(one: Compared, rows: np.ndarray) -> list[str]:
    """Names of rows, as "rail@6 < hit"; of pairs of channels as "axlebox1, axlebox2"."""
    names = [*one.channels, *one.points]
    between = " < " if one.points else ", "
    pairs = zip(one.first[rows].tolist(), one.second[rows].tolist(), strict=True)
    return [names[a] if b < 0 else f"{names[a]}{between}{names[b]}" for a, b in pairs]


def blunder_rows(checked: Checked) -> list[dict[str, Any]]:
    """Blunders as data, the surest first, and questions after them."""
    return [
        {
            "kind": one.kind,
            "where": one.where,
            "what": one.what,
            "remedy": one.remedy,
            "log_odds": None if one.log_odds is None else round(one.log_odds, 1),
            "asked": one.asked,
        }
        for one in checked.blunders
    ]
