"""What is wrong with raw samples, reported with its place. Nothing is altered."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from permway.arrays import Reals
from permway.recordings.finding import Finding, Screening
from permway.recordings.readers.timefile import RATES_AGREE
from permway.recordings.record import TimeRecord
from permway.recordings.screening_levels import coarse_steps, mains_lines, offset_and_drift
from permway.recordings.screening_runs import clipping, dropouts, runs, spikes

_MOST_PLACES = 20


def screen(
    record: TimeRecord,
    *,
    sampling_Hz: float | None = None,
    mains_Hz: Sequence[float] = (50.0, 50.0 / 3.0),
) -> Screening:
    """Look for what spoils a record.

    Parameters
    ----------
    record : TimeRecord
        Raw; read it with `keep_nonfinite=True` to have such samples reported rather than refused.
    sampling_Hz : float, optional
        What the rate should be.
    mains_Hz : sequence of float
        Fundamentals whose multiples are looked for: 50 Hz, and 16.7 Hz of railways. Needs a sampling rate.

    Returns
    -------
    Screening
        Channels in their order, the record as a whole first. At most twenty places of a kind in a channel; the
        last states how many more.
    """
    findings = list(_sampling(record, sampling_Hz))
    for name, values in zip(record.channels, record.values, strict=True):
        for group in _channel(name, values, record.sampling_Hz, mains_Hz):
            findings.extend(_placed(finding, record) for finding in _shortened(group))
    findings.extend(_identical(record))
    return Screening(record.source, tuple(findings))


def _channel(name: str, values: Reals, rate: float | None, mains: Sequence[float]) -> Iterator[list[Finding]]:
    finite = np.isfinite(values)
    yield [
        Finding("not finite", "error", name, f"{b - a} sample(s) not finite", a, b - 1, value=float(values[a]))
        for a, b in runs(~finite)
    ]
    finite_values = values[finite]
    if not finite_values.size:
        return
    if finite_values.min() == finite_values.max():
        what = f"all {finite_values.size} samples are {finite_values[0]:.6g}"
        yield [Finding("dead", "error", name, what, value=float(finite_values[0]))]
        return
    step = _quantum(finite_values)
    clipped, found = clipping(name, values, step)
    yield found
    held, found = dropouts(name, values, finite & ~clipped, step)
    yield found
    # What was reported already is no measurement of level, noise and lines.
    usable = finite & ~held
    if usable.sum() < 256:
        return
    yield spikes(name, values, usable & ~clipped)
    yield offset_and_drift(name, values, usable)
    yield coarse_steps(name, values[usable], step)
    if rate is not None:
        yield mains_lines(name, np.where(usable, values, np.median(values[usable])), rate, mains)


def _quantum(finite_values: Reals) -> float:
    """The step of which all samples are multiples apart, 0 if there is none to see."""
    levels = np.unique(finite_values)
    if levels.size < 3 or levels.size > finite_values.size // 2:
        return 0.0
    steps = np.diff(levels)
    least = float(steps.min())
    ratio = steps / least
    return least if np.all(np.abs(ratio - np.round(ratio)) < 1e-3 * np.maximum(ratio, 1.0)) else 0.0


def _identical(record: TimeRecord) -> list[Finding]:
    """Channels that are copies of one another, as they stand or scaled."""
    found = []
    finite = np.isfinite(record.values)
    alive = [
        i for i in range(len(record.channels)) if finite[i].any() and np.ptp(record.values[i][finite[i]]) > 0.0
    ]
    for k, i in enumerate(alive):
        for j in alive[k + 1 :]:
            both = finite[i] & finite[j]
            x, y = record.values[i][both], record.values[j][both]
            if x.size < 16:
                continue
            first = record.channels[i]
            if np.array_equal(x, y):
                found.append(Finding("identical", "error", record.channels[j], f"the same samples as '{first}'"))
                continue
            x, y = x - x.mean(), y - y.mean()
            size = float(np.sqrt((x @ x) * (y @ y)))
            if size > 0.0 and abs(float(x @ y)) / size > 1.0 - 1e-9:
                factor = float(x @ y) / float(x @ x)
                what = f"'{first}' times {factor:.6g}"
                found.append(Finding("identical", "warning", record.channels[j], what, value=factor))
    return found


def _sampling(record: TimeRecord, wanted: float | None) -> list[Finding]:
    rate = record.sampling_Hz
    if rate is None:
        return [Finding("sampling", "warning", "", "no sampling rate: lines of the mains were not looked for")]
    if wanted is not None and abs(rate / wanted - 1.0) > RATES_AGREE:
        return [Finding("sampling", "error", "", f"sampled at {rate:.9g} Hz, not {wanted:.9g} Hz", value=rate)]
    return []


def _shortened(group: list[Finding]) -> list[Finding]:
    if len(group) <= _MOST_PLACES:
        return group
    kept = group[:_MOST_PLACES]
    more = len(group) - _MOST_PLACES
    return [*kept[:-1], replace(kept[-1], what=f"{kept[-1].what}; and {more} more place(s)")]


def _placed(finding: Finding, record: TimeRecord) -> Finding:
    if finding.first is None or record.sampling_Hz is None:
        return finding
    return replace(finding, time_s=(record.start_s or 0.0) + finding.first / record.sampling_Hz)
