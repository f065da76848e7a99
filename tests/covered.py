"""Whether intervals hold what they are of."""

import numpy as np


def phase_covered(interval, truth_rad):
    """Whether a phase lies within an interval, turns apart from it or not."""
    middle, half = 0.5 * (interval.low + interval.high), 0.5 * (interval.high - interval.low)
    return np.abs(np.angle(np.exp(1j * (np.asarray(truth_rad) - middle)))) <= half
