"""Samples that are lost one by one or in runs: flat tops, dropouts, spikes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, ndimage, signal

from permway.arrays import Reals
from permway.recordings.finding import Finding

Flags = NDArray[np.bool_]


SPIKE_SCALES = 8.0
"""A spike lies so many local standard deviations from the median of its neighbours; Gaussian noise never does."""


BY_CHANCE = 1e-6
"""Records in which samples stand still by chance for as long as a dropout: a suite of campaigns has thousands, and
where numbers are written with so many digits larger ones stand still more often than all do."""


_SHORTEST_CLIP = 3


_SHORTEST_DROPOUT = 5


_SPIKE_BLOCK = 1024


_SPIKE_ORDER = 24


def runs(flags: Flags, shortest: int = 1) -> list[tuple[int, int]]:
    """First sample, and the one after the last, of each run of true."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.astype(np.int8), [0]))))
    pairs = edges.reshape(-1, 2)
    return [(int(a), int(b)) for a, b in pairs[pairs[:, 1] - pairs[:, 0] >= shortest]]


def clipping(name: str, values: Reals, step: float) -> tuple[Flags, list[Finding]]:
    """Flat tops: runs at the extreme value that are entered or left by more than the quantisation explains."""
    flags = np.zeros(values.size, dtype=np.bool_)
    found = []
    finite = values[np.isfinite(values)]
    for extreme in (finite.max(), finite.min()):
        near = np.isfinite(values) & (np.abs(values - extreme) <= 1e-9 * abs(extreme))
        tops = [(a, b) for a, b in runs(near, _SHORTEST_CLIP) if _cut(values, a, b, step)]
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


def dropouts(name: str, values: Reals, usable: Flags, step: float) -> tuple[Flags, list[Finding]]:
    """Runs of one and the same value, longer than the quantisation would give by chance."""
    same = np.zeros(values.size, dtype=np.bool_)
    same[1:] = (values[1:] == values[:-1]) & usable[1:]
    by_chance = _by_chance(same)
    # What stands still for much longer is no chance, and hides short dropouts as if it were.
    moving = same.copy()
    for a, b in runs(same, 4 * by_chance):
        moving[a:b] = False
    by_chance = _by_chance(moving)
    flags = np.zeros(values.size, dtype=np.bool_)
    found = []
    for a, b in runs(same, max(_SHORTEST_DROPOUT, by_chance) - 1):
        if not _cut(values, a - 1, b, step):
            continue
        flags[a - 1 : b] = True
        what = f"{b - a + 1} samples held at {values[a]:.6g}"
        found.append(Finding("dropout", "error", name, what, a - 1, b - 1, value=float(values[a])))
    return flags, found


def _by_chance(same: Flags) -> int:
    """How many equal samples there may be: a run of n comes about share^(n - 1) often."""
    share = min(max(float(same.mean()), 1e-12), 0.999)
    return 1 + int(np.ceil(np.log(BY_CHANCE / same.size) / np.log(share)))


def spikes(name: str, values: Reals, usable: Flags) -> list[Finding]:
    """One or two samples far from what their neighbours on both sides predict, by the local scale of that."""
    centre = float(np.median(values[usable]))
    filled = np.where(usable, values, centre) - centre
    # What was lost has no neighbours to be predicted from, nor to predict.
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
            what = f"{values[top]:.6g}, {size[top] / scale[top]:.0f} local deviations from what is predicted"
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
    # A floor 40 dB down keeps smooth records from predicting their own rounding.
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
