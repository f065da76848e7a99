"""What is wrong with raw samples, told with its place. Nothing is altered."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, ndimage, signal, stats

from permway.arrays import Reals
from permway.recordings.readers.timefile import RATES_AGREE
from permway.recordings.record import TimeRecord

Severity = Literal["error", "warning", "note"]
Flags = NDArray[np.bool_]

FALSE_ALARMS = 1e-5
"""Probability that any line of the mains is told of a record of white noise, a channel."""

SPIKE_SCALES = 8.0
"""A spike lies so many local standard deviations from the median of its neighbours; Gaussian noise never does."""

OFFSET_SCALES = 0.5
"""An offset or a drift is told from so many standard deviations of the channel on."""

_MOST_PLACES = 20
_SHORTEST_CLIP = 3
_SHORTEST_DROPOUT = 5
_SPIKE_BLOCK = 1024
_SPIKE_ORDER = 24
_MAINS_OFF_HZ = 0.15


@dataclass(frozen=True)
class Finding:
    """One thing found.

    Attributes
    ----------
    kind : str
        "not finite", "dead", "clipping", "dropout", "spike", "offset", "drift", "quantisation", "identical",
        "sampling" or "mains".
    severity : "error", "warning" or "note"
        An error spoils whatever is estimated; a warning may; a note is to be known.
    channel : str
        Name, or "" for the record as a whole.
    what : str
        In words, with numbers.
    first, last : int or None
        Samples, both included; None if it holds all along.
    time_s : float or None
        Of the first, if the rate is known.
    value : float or None
        What was met there: the level clipped at, the height of a spike, a frequency in Hz.
    """

    kind: str
    severity: Severity
    channel: str
    what: str
    first: int | None = None
    last: int | None = None
    time_s: float | None = None
    value: float | None = None


@dataclass(frozen=True)
class Screening:
    """All findings of a record; as text, a table."""

    source: str
    findings: tuple[Finding, ...]

    def __iter__(self) -> Iterator[Finding]:
        return iter(self.findings)

    def __len__(self) -> int:
        return len(self.findings)

    def of(self, *severities: Severity) -> tuple[Finding, ...]:
        """Findings of these severities."""
        return tuple(finding for finding in self.findings if finding.severity in severities)

    def __str__(self) -> str:
        if not self.findings:
            return f"{self.source or 'record'}: nothing found"
        rows = [("severity", "channel", "kind", "samples", "time, s", "what")]
        for finding in self.findings:
            span = "all" if finding.first is None else str(finding.first)
            if finding.last is not None and finding.last != finding.first:
                span += f" to {finding.last}"
            time = "" if finding.time_s is None else f"{finding.time_s:.4f}"
            rows.append((finding.severity, finding.channel or "(record)", finding.kind, span, time, finding.what))
        widths = [max(len(row[i]) for row in rows) for i in range(5)]
        return "\n".join("  ".join([*(row[i].ljust(widths[i]) for i in range(5)), row[5]]) for row in rows)


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
        Raw; read it with `keep_nonfinite=True` to have such samples told rather than refused.
    sampling_Hz : float, optional
        What the rate should be.
    mains_Hz : sequence of float
        Fundamentals whose multiples are looked for: 50 Hz, and 16.7 Hz of railways. Needs a sampling rate.

    Returns
    -------
    Screening
        Channels in their order, the record as a whole first. At most twenty places of a kind in a channel; the
        last says how many more.
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
        for a, b in _runs(~finite)
    ]
    sound = values[finite]
    if not sound.size:
        return
    if sound.min() == sound.max():
        what = f"all {sound.size} samples are {sound[0]:.6g}"
        yield [Finding("dead", "error", name, what, value=float(sound[0]))]
        return
    step = _quantum(sound)
    clipped, found = _clipping(name, values, step)
    yield found
    held, found = _dropouts(name, values, finite & ~clipped, step)
    yield found
    # What was told already is no measurement of level, noise and lines.
    usable = finite & ~held
    if usable.sum() < 256:
        return
    yield _spikes(name, values, usable & ~clipped)
    yield _levels(name, values, usable)
    yield _coarse(name, values[usable], step)
    if rate is not None:
        yield _mains(name, np.where(usable, values, np.median(values[usable])), rate, mains)


def _runs(flags: Flags, shortest: int = 1) -> list[tuple[int, int]]:
    """First sample, and the one after the last, of each run of true."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.astype(np.int8), [0]))))
    pairs = edges.reshape(-1, 2)
    return [(int(a), int(b)) for a, b in pairs[pairs[:, 1] - pairs[:, 0] >= shortest]]


def _quantum(sound: Reals) -> float:
    """The step of which all samples are multiples apart, 0 if there is none to see."""
    levels = np.unique(sound)
    if levels.size < 3 or levels.size > sound.size // 2:
        return 0.0
    steps = np.diff(levels)
    least = float(steps.min())
    ratio = steps / least
    return least if np.all(np.abs(ratio - np.round(ratio)) < 1e-3 * np.maximum(ratio, 1.0)) else 0.0


def _clipping(name: str, values: Reals, step: float) -> tuple[Flags, list[Finding]]:
    """Flat tops: runs at the extreme value that are entered or left by more than the quantisation explains."""
    flags = np.zeros(values.size, dtype=np.bool_)
    found = []
    finite = values[np.isfinite(values)]
    for extreme in (finite.max(), finite.min()):
        near = np.isfinite(values) & (np.abs(values - extreme) <= 1e-9 * abs(extreme))
        tops = [(a, b) for a, b in _runs(near, _SHORTEST_CLIP) if _cut(values, a, b, step)]
        # A value held once, for long and in one place only, is a dropout at an extreme.
        if len(tops) == 1 and tops[0][1] - tops[0][0] > 50:
            continue
        for a, b in tops:
            flags[a:b] = True
            what = f"{b - a} samples flat at {extreme:.6g}"
            found.append(Finding("clipping", "error", name, what, a, b - 1, value=float(extreme)))
    return flags, sorted(found, key=lambda finding: finding.first or 0)


def _cut(values: Reals, a: int, b: int, step: float) -> bool:
    """Whether a run is entered or left by a jump: at a turning point a slow signal stands still as well."""
    beside = [values[i] for i in (a - 1, b) if 0 <= i < values.size and np.isfinite(values[i])]
    return any(abs(values[a] - value) > 2.5 * step for value in beside)


def _dropouts(name: str, values: Reals, usable: Flags, step: float) -> tuple[Flags, list[Finding]]:
    """Runs of one and the same value, longer than the quantisation would give by chance."""
    same = np.zeros(values.size, dtype=np.bool_)
    same[1:] = (values[1:] == values[:-1]) & usable[1:]
    share = min(max(float(same.mean()), 1e-12), 0.999)
    # A run of n equal samples comes about share^(n - 1) often by chance; less than once in a thousand records.
    by_chance = 1 + int(np.ceil(np.log(1e-3 / values.size) / np.log(share)))
    flags = np.zeros(values.size, dtype=np.bool_)
    found = []
    for a, b in _runs(same, max(_SHORTEST_DROPOUT, by_chance) - 1):
        if not _cut(values, a - 1, b, step):
            continue
        flags[a - 1 : b] = True
        what = f"{b - a + 1} samples held at {values[a]:.6g}"
        found.append(Finding("dropout", "error", name, what, a - 1, b - 1, value=float(values[a])))
    return flags, found


def _spikes(name: str, values: Reals, usable: Flags) -> list[Finding]:
    """One or two samples far from what their neighbours on both sides foretell, by the local scale of that."""
    centre = float(np.median(values[usable]))
    filled = np.where(usable, values, centre) - centre
    # What was lost has no neighbours to be foretold from, nor to foretell.
    sure = ~ndimage.binary_dilation(~usable, iterations=_SPIKE_ORDER)
    if sure.sum() < 256:
        return []
    error = np.where(sure, _interpolation_error(filled), 0.0)
    size = np.abs(error)
    overall = 1.4826 * float(np.median(size[sure]))
    blocks = [1.4826 * float(np.median(size[a : a + _SPIKE_BLOCK])) for a in range(0, size.size, _SPIKE_BLOCK)]
    # The greatest of a block and its neighbours, for what is loud may begin anywhere in a block.
    local = np.repeat(ndimage.maximum_filter1d(np.array(blocks), 3, mode="nearest"), _SPIKE_BLOCK)[: size.size]
    scale = np.maximum(local, overall)
    if not overall > 0.0:
        return []
    far = np.flatnonzero(size > SPIKE_SCALES * scale)
    groups = np.split(far, np.flatnonzero(np.diff(far) > _SPIKE_ORDER) + 1) if far.size else []
    found = []
    for group in groups:
        top = int(group[np.argmax(size[group])])
        a, b = top, top + 1
        while a > 0 and size[a - 1] > 0.6 * size[top] and error[a - 1] * error[top] > 0.0:
            a -= 1
        while b < size.size and size[b] > 0.6 * size[top] and error[b] * error[top] > 0.0:
            b += 1
        if b - a <= 2:
            what = f"{values[top]:.6g}, {size[top] / scale[top]:.0f} local deviations from what is foretold"
            found.append(Finding("spike", "warning", name, what, a, b - 1, value=float(values[top])))
    return found


def _interpolation_error(values: Reals) -> Reals:
    """Each sample less its best linear interpolation from both sides, of a Gaussian process Gaussian again.

    The interpolator of an autoregression a is the autocorrelation of a (S. V. Vaseghi, Advanced Digital Signal
    Processing and Noise Reduction, 4th ed. 2008, section 13.4).
    """
    bound = 5.0 * 1.4826 * float(np.median(np.abs(values)))
    tame = np.clip(values, -bound, bound) if bound > 0.0 else values
    length = int(2 ** np.ceil(np.log2(2 * values.size)))
    power = np.abs(np.fft.rfft(tame - tame.mean(), length)) ** 2
    covariance = np.fft.irfft(power)[: _SPIKE_ORDER + 1]
    # A floor 40 dB down keeps smooth records from foretelling their own rounding.
    covariance[0] *= 1.0 + 1e-4
    if not covariance[0] > 0.0:
        return np.zeros(values.size)
    weights = linalg.solve_toeplitz(covariance[:-1], covariance[1:])
    predictor = np.concatenate(([1.0], -weights))
    both = np.correlate(predictor, predictor, mode="full") / float(predictor @ predictor)
    error = np.asarray(signal.oaconvolve(values, both, mode="same"))
    # At the ends one side is missing.
    error[:_SPIKE_ORDER] = 0.0
    error[-_SPIKE_ORDER:] = 0.0
    return error


def _levels(name: str, values: Reals, usable: Flags) -> list[Finding]:
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


def _coarse(name: str, sound: Reals, step: float) -> list[Finding]:
    """A step of quantisation that shows in the noise: it adds step^2/12 to the variance."""
    if step == 0.0:
        return []
    rms = float(sound.std())
    if rms > 100.0 * step:
        return []
    severity: Severity = "warning" if rms < 4.0 * step else "note"
    what = f"steps of {step:.4g}, the standard deviation is {rms / step:.2g} steps"
    return [Finding("quantisation", severity, name, what, value=step)]


def _mains(name: str, values: Reals, rate: float, mains: Sequence[float]) -> list[Finding]:
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
        # Multiples of 50 Hz are multiples of 16.7 Hz as well, and told once.
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
