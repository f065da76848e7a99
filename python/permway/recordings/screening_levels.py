"""What a channel carries all along: offset, drift, coarse steps, lines of the mains."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import signal, stats

from permway.arrays import Reals
from permway.recordings.finding import Finding, Severity
from permway.recordings.screening_runs import Flags

FALSE_ALARMS = 1e-5
"""Probability that any line of the mains is reported of a record of white noise, a channel."""


OFFSET_SCALES = 0.5
"""An offset or a drift is determined from so many standard deviations of the channel on."""


_MAINS_OFF_HZ = 0.15


def offset_and_drift(name: str, values: Reals, usable: Flags) -> list[Finding]:
    """Offset and drift, from the means of sixteen parts."""
    index = np.flatnonzero(usable)
    parts = [part for part in np.array_split(index, 16) if part.size]
    centres = np.array([part.mean() for part in parts]) / values.size - 0.5
    means = np.array([values[part].mean() for part in parts])
    spread = float(np.mean([values[part].std() for part in parts]))
    if len(parts) < 4 or spread == 0.0:
        return []
    fit = stats.linregress(centres, means)
    found = []
    mean, error = float(means.mean()), float(means.std(ddof=1)) / np.sqrt(len(parts))
    drift, unsure = float(fit.slope), float(fit.stderr)
    if abs(drift) > OFFSET_SCALES * spread and abs(drift) > 6.0 * unsure:
        what = f"drifts by {drift:.4g} over the record, {abs(drift) / spread:.2g} standard deviations"
        found.append(Finding("drift", "warning", name, what, value=drift))
    if abs(mean) > OFFSET_SCALES * spread and abs(mean) > 6.0 * error:
        what = f"mean of {mean:.4g}, {abs(mean) / spread:.2g} standard deviations"
        found.append(Finding("offset", "note", name, what, value=mean))
    return found


def coarse_steps(name: str, usable: Reals, step: float) -> list[Finding]:
    """A step of quantisation that shows in the noise: it adds step^2/12 to the variance."""
    if step == 0.0:
        return []
    rms = float(usable.std())
    if rms > 100.0 * step:
        return []
    severity: Severity = "warning" if rms < 4.0 * step else "note"
    what = f"steps of {step:.4g}, the standard deviation is {rms / step:.2g} steps"
    return [Finding("quantisation", severity, name, what, value=step)]


def mains_lines(name: str, values: Reals, rate: float, mains: Sequence[float]) -> list[Finding]:
    """Lines at multiples of the mains that stand above their surroundings more than noise does."""
    length = min(values.size, int(2 ** np.ceil(np.log2(8.0 * rate))))
    if length < 64 or rate / length > 1.0:
        return []
    frequency, power = signal.welch(values - values.mean(), fs=rate, window="hann", nperseg=length, detrend=False)
    averages = max(1.0, (values.size / length - 1.0) * 2.0 * 0.95 + 1.0)
    spacing = float(frequency[1])
    reach = max(1, round(_MAINS_OFF_HZ / spacing))
    around = max(24, round(2.0 / spacing))
    lines = [
        (base, n, at)
        for base in mains
        for n in range(1, int(0.49 * rate / base) + 1)
        if (at := round(n * base / spacing)) > reach + 3
        and at + reach + 3 < frequency.size
        # Multiples of 50 Hz are multiples of 16.7 Hz as well, and reported once.
        and not any(other > base and abs(n * base / other - round(n * base / other)) < 1e-3 for other in mains)
    ]
    found = []
    freedom = 2.0 * averages
    for base, n, at in lines:
        # The higher side counts: a spectrum that steps here has no line.
        below, above = power[max(1, at - around) : at - reach - 2], power[at + reach + 3 : at + around + 1]
        floor = float(max(np.median(below), np.median(above)))
        if floor <= 0.0:
            continue
        level = float(power[at - reach : at + reach + 1].max()) / floor
        chance = FALSE_ALARMS / (len(lines) * (2 * reach + 1))
        # The floor is a median, and itself estimated: the half again allows for a spectrum that bends there.
        if level > 1.5 * stats.chi2.isf(chance, freedom) / stats.chi2.ppf(0.5, freedom):
            peak = float(frequency[at - reach + int(np.argmax(power[at - reach : at + reach + 1]))])
            what = f"line at {peak:.2f} Hz, {n} x {base:.4g} Hz, {10.0 * np.log10(level):.0f} dB above its sides"
            found.append(Finding("mains", "note", name, what, value=peak))
    return found
