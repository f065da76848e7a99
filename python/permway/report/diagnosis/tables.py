"""The tables of a diagnosis, as plain data for its template."""

from __future__ import annotations

import numpy as np

from permway.diagnosis.plain_names import name_of, seen
from permway.diagnosis.verdict import Verdict
from permway.diagnosis.verdict_numbers import quantity
from permway.report.compare.tables import NOTABLE_DB, BandTable, decibels, signed
from permway.report.diagnosis.changes import Change

FEW_CHANNELS = 16
"""Channels of a record that its table shows openly."""


def held_out_rows(verdict: Verdict) -> list[dict[str, str]]:
    """By group: gain in nats, and dB before and after."""
    return [
        {
            "axis": axis,
            "gain": quantity(gain.gain_nats),
            "before": decibels(gain.db_before),
            "after": decibels(gain.db_after),
        }
        for axis, gain in verdict.held_out.items()
    ]


def change_table(change: Change) -> tuple[BandTable, BandTable | None]:
    """Deviations in one-third octaves before and after: the channels that changed most, and the others."""
    used = np.flatnonzero(np.isfinite(change.before_dB.values).any(axis=0))
    bands = [f"{change.before_dB['band'].values[b]:g}" for b in used]
    rows = []
    for channel in change.order():
        cells = []
        for band in used:
            before = float(change.before_dB.values[channel, band])
            after = before if change.after_dB is None else float(change.after_dB.values[channel, band])
            text = "" if change.after_dB is None else signed(after)
            cells.append((signed(before), text, bool(abs(after) >= NOTABLE_DB)))
        rows.append((str(change.before_dB["channel"].values[channel]).replace("<", "from"), cells))
    rest = BandTable(change.name, bands, rows[FEW_CHANNELS:]) if len(rows) > FEW_CHANNELS else None
    return BandTable(change.name, bands, rows[:FEW_CHANNELS]), rest


def detectable_rows(verdict: Verdict) -> list[dict[str, str]]:
    """What would have been seen."""
    return [
        {
            "name": name_of(name).capitalize(),
            "size": seen(one),
        }
        for name, one in verdict.detectable.items()
    ]
