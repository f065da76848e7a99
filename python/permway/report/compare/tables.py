"""The tables of a comparison, as plain data for its template."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from permway.campaign.compare import NEPER_DB
from permway.diagnosis.compare import RAW, RECALIBRATED, Comparison
from permway.diagnosis.residuals import channel_rms, lag_correlation
from permway.diagnosis.verdict_numbers import quantity, span

NOTABLE_DB = 1.0
"""Deviations of this size are marked."""


@dataclass(frozen=True)
class BandTable:
    """Deviations of one record: bands across, channels down; a cell is (raw, recalibrated or "", marked)."""

    record: str
    bands: list[str]
    rows: list[tuple[str, list[tuple[str, str, bool]]]]


def signed(value: float, digits: int = 1) -> str:
    """With its sign, a true minus, and nothing for what is not known."""
    if not np.isfinite(value):
        return ""
    text = f"{value:+.{digits}f}"
    return f"{0.0:.{digits}f}" if float(text) == 0.0 else text.replace("-", "−")


def share(value: float | None) -> str:
    """A share as per cent."""
    return "" if value is None else f"{100.0 * value:.1f} %".replace("100.0", "100")


def decibels(value: float | None) -> str:
    """A root mean square in dB."""
    if value is None:
        return ""
    return f"{value:.2f} dB" if value < 1.0 else f"{value:.1f} dB"


def band_table(bands: xr.Dataset, name: str, channels: Sequence[int]) -> BandTable:
    """Deviations of some channels in one-third octaves; bands where none states anything are left out."""
    values = bands["deviation_dB"].values[:, list(channels)]
    used = np.flatnonzero(np.isfinite(values).any(axis=(0, 1)))
    models = [str(m) for m in bands["model"].values]
    rows = []
    for row, channel in enumerate(channels):
        cells = []
        for band in used:
            raw = float(values[models.index(RAW), row, band])
            best = float(values[-1, row, band])
            text = signed(best) if RECALIBRATED in models else ""
            cells.append((signed(raw), text, bool(abs(best) >= NOTABLE_DB)))
        rows.append((str(bands["channel"].values[channel]), cells))
    return BandTable(name, [f"{bands['band'].values[b]:g}" for b in used], rows)


def parameter_rows(comparison: Comparison) -> list[dict[str, Any]]:
    """Nominal value, tolerance, found value, interval, z and what is to be stated about it."""
    table, rows = comparison.parameters, []
    for i, name in enumerate(table["parameter"].values.astype(str)):
        one = table.isel(parameter=i)
        row: dict[str, Any] = {
            "name": name,
            "unit": str(one["unit"].values),
            "nominal": quantity(float(one["nominal"])),
            "tolerance": f"{quantity(float(one['low_2sigma']))} to {quantity(float(one['high_2sigma']))}",
        }
        if comparison.fit is not None:
            note = "left its tolerance" if bool(one["left"]) else ""
            if bool(one["not_informed"]):
                note = "the records say nothing of it"
            row |= {
                "found": quantity(float(one["value"])),
                "interval": span(float(one["low"]), float(one["high"])),
                "z": signed(float(one["z"]), 2),
                "width": f"{100.0 * float(one['sigma_over_prior']):.0f} %",
                "note": note,
                "left": bool(one["left"]),
            }
        rows.append(row)
    return rows


def calibration_rows(comparison: Comparison) -> list[dict[str, Any]]:
    """Sizes of calibration errors in words; sources of one kind and nearly one size are one row."""
    sizes = comparison.calibration["size_dB"]
    kinds: dict[str, list[tuple[str, float]]] = {}
    for source, size in zip(sizes["source"].values.astype(str), sizes.values, strict=True):
        kind, _, name = source.partition(" ")
        kinds.setdefault(kind, []).append((name or kind, float(size)))
    words = {
        "sensor": "sensors of hammer tests: gain, and phase as large",
        "force": "hammer at its points: gain, and phase as large",
        "channel": "sensors on the train: gain, and phase as large",
        "irregularity": "the irregularity's level",
        "pairs": "each pair of sensor and point",
        "record": "records as a whole",
        "decay": "decay rates of the section at every visit",
    }
    rows = []
    for kind, members in kinds.items():
        values = [size for _, size in members]
        name, largest = max(members, key=lambda member: member[1])
        rows.append(
            {
                "words": words.get(kind, kind),
                "count": len(members),
                "median": f"{np.median(values):.2f}",
                "largest": f"{largest:.2f}",
                "name": name.removeprefix("of "),
                "degrees": ""
                if kind in ("irregularity", "record", "decay")
                else f"{np.degrees(largest / NEPER_DB):.1f}°",
                "all": [(n, f"{v:.3f}") for n, v in members],
            }
        )
    return rows


def sensor_rows(comparison: Comparison) -> list[dict[str, Any]]:
    """By record and sensor: rms of standardised residuals, and correlation of neighbouring lines."""
    rows = []
    for data in comparison.residuals:
        rms = channel_rms(data)
        found = lag_correlation(data["z"].isel(model=-1), lags=1).isel(lag=0)
        for sensor in rms["sensor"].values.astype(str):
            neighbour = found.sel(sensor=sensor)
            worst = neighbour["correlation"].values[np.isfinite(neighbour["correlation"].values)]
            rows.append(
                {
                    "record": str(data.attrs["record"]),
                    "sensor": sensor,
                    "rms": [f"{float(v):.2f}" for v in rms.sel(sensor=sensor).values],
                    "neighbour": signed(float(worst[np.argmax(np.abs(worst))]), 2) if worst.size else "",
                    "chance": f"±{float(np.nanmax(neighbour['chance'].values, initial=0.0)):.2f}",
                }
            )
    return rows
