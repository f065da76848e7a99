"""That intervals cover what they say: 400 simulated records of known spectrum and response function.

Covered means: the truth at the line itself, not smeared by the window. So what the window does at a peak counts
against the interval, and the resolution is chosen as a user would choose it, by `segment_for_peak`.

The seed, 4, was not chosen among others; docs/estimates.md lists what others give.
Lines that detrending touches are left out, as the dataset states (`usable`).
"""

import numpy as np
import pytest
from covered import phase_covered
from permway.recordings.estimates.coherence import coherence_interval
from permway.recordings.estimates.frf import frequency_response
from permway.recordings.estimates.intervals import frf_interval, power_interval
from permway.recordings.estimates.third_octaves import band_levels
from permway.recordings.estimates.welch import cross_spectra
from permway.recordings.estimates.windows import segment_for_peak, segments
from permway.recordings.estimates.wishart import wishart_deviance

SAMPLING_HZ = 512.0
SEED = 4
RECORDS = 400
LEVEL = 0.95
PEAKS = ((97.0, 0.06), (170.0, 0.055))
"""Natural frequency Hz and damping: 11.6 and 18.7 Hz wide at half power."""

NARROWEST_HZ = 2.0 * 97.0 * 0.06


PEAK_COHERENCE = 0.85
"""At the first peak, rounded up."""


def resonance(frequency, natural_Hz, damping):
    """Response of one degree of freedom, 1 at 0 Hz."""
    ratio = frequency / natural_Hz
    return 1.0 / (1.0 - ratio**2 + 2j * damping * ratio)


def gaussian(rng, matrix_root, samples, records):
    """Stationary Gaussian records (channel, sample), one after the other, each a piece of a longer period.

    `matrix_root(frequency)` gives G (line, channel, source): the one-sided cross-spectral density is G G^H. The
    period is twice the record, so that no record meets its own end.
    """
    period = 2 * samples
    frequency = np.fft.rfftfreq(period, 1.0 / SAMPLING_HZ)
    root = matrix_root(frequency)
    lines, _, sources = root.shape
    scale = np.sqrt(SAMPLING_HZ * period / 4.0)
    for _ in range(records):
        draw = rng.standard_normal((2, lines, sources))
        white = scale * (draw[0] + 1j * draw[1])
        white[[0, -1]] = 0.0
        signal = np.fft.irfft((root @ white[:, :, None])[:, :, 0].T, period, axis=1)
        yield signal[:, :samples]


def samples_for(count, segment_s):
    """Samples of a record that holds so many half-overlapped segments."""
    length = round(segment_s * SAMPLING_HZ)
    samples = length + (count - 1) * length // 2
    assert segments(samples, sampling_Hz=SAMPLING_HZ, segment_s=segment_s).count == count
    return samples


def response(frequency, *, second=1.0):
    """A response with two resonances and, with a positive second, an antiresonance between them."""
    return resonance(frequency, *PEAKS[0]) + second * resonance(frequency, *PEAKS[1]) + 0.3


def excitation(frequency):
    """Root of the density of a coloured input: falls by 20 dB over the band, with a hump."""
    return np.sqrt(
        1e-4 + 1.0 / (1.0 + (frequency / 60.0) ** 2) + 0.5 * np.exp(-(((frequency - 210.0) / 40.0) ** 2))
    )


def root(frequency):
    """Input, output with another source in it that meets the same resonances, and a second output with both."""
    inside, system = excitation(frequency), response(frequency)
    out = np.zeros((frequency.size, 3, 3), dtype=complex)
    out[:, 0, 0] = inside
    out[:, 1, 0] = system * inside
    out[:, 1, 1] = 0.45 * response(frequency, second=-0.8) * inside + 0.05
    out[:, 2, 0] = 0.7 * np.exp(-2j * np.pi * frequency * 0.002) * inside
    out[:, 2, 1] = 0.1
    out[:, 2, 2] = 0.4
    return out


def truth(frequency):
    """Cross-spectral matrix (line, channel, channel)."""
    matrix = root(frequency)
    return matrix @ matrix.conj().transpose(0, 2, 1)


def coverages(count, seed=SEED, records=RECORDS):
    """Share of intervals that cover, by quantity, over records and lines."""
    rng = np.random.default_rng([seed, count])
    segment = 2.0 ** np.ceil(np.log2(segment_for_peak(NARROWEST_HZ, count, coherence=PEAK_COHERENCE)))
    spectra = [
        cross_spectra(record, sampling_Hz=SAMPLING_HZ, segment_s=segment)
        for record in gaussian(rng, root, samples_for(count, segment), records)
    ]
    first = spectra[0]
    use = first["usable"].values & (first["frequency"].values < 240.0)
    frequency = first["frequency"].values[use]
    known = truth(frequency)
    averages = first.attrs["averages"]
    csd = np.stack([data["csd"].values for data in spectra])[..., use]
    found = {}
    powers = np.einsum("raaf->raf", csd).real
    freedom = first["degrees_of_freedom"].values[use]
    found["psd"] = power_interval(powers, freedom, level=LEVEL).covers(np.einsum("faa->af", known).real)
    responses = [frequency_response(data, references=["0"], responses=["1"]) for data in spectra]
    measured = np.stack([data["frf"].values[0, 0, use] for data in responses])
    variance = np.stack([data["variance"].values[0, 0, use] for data in responses])
    interval = frf_interval(measured, variance, responses[0]["degrees_of_freedom"].values[use], level=LEVEL)
    system = response(frequency)
    found["magnitude"] = interval.magnitude.covers(np.abs(system))
    found["phase"] = phase_covered(interval.phase_rad, np.angle(system))
    found["circle"] = np.abs(measured - system) <= interval.radius
    coherence = np.stack([data["coherence"].values[0, use] for data in responses])
    exact = np.abs(known[:, 1, 0]) ** 2 / (known[:, 0, 0] * known[:, 1, 1]).real
    found["coherence"] = coherence_interval(coherence, averages, level=LEVEL).covers(exact)
    if averages >= 3.0:
        deviance = wishart_deviance(csd.transpose(0, 3, 1, 2), known, averages)
        found["wishart"] = deviance.probability >= 1.0 - LEVEL
    bands = [band_levels(data, reference=1.0, level=LEVEL) for data in spectra]
    fine = np.linspace(0.0, 256.0, 256 * 256 + 1)
    density = np.einsum("faa->af", truth(fine)).real
    power = np.stack(
        [
            density[:, (fine >= low) & (fine < high)].sum(axis=1) * fine[1]
            for low, high in zip(bands[0]["low_Hz"].values, bands[0]["high_Hz"].values, strict=True)
        ],
        axis=1,
    )
    low, high = (np.stack([data[name].values for data in bands]) for name in ("low_dB", "high_dB"))
    level = 10.0 * np.log10(power)
    found["third octaves"] = (low <= level) & (level <= high)
    return {name: float(np.mean(covered)) for name, covered in found.items()}


@pytest.mark.parametrize("count", [8, 16, 40])
def test_intervals_cover_what_they_state(count):
    """Between 93 and 97 %: with 400 records of some 50 independent lines chance alone moves a share by 0.2 %."""
    found = coverages(count)
    assert len(found) == 7
    for name, share in found.items():
        assert 0.93 <= share <= 0.97, (name, share)


if __name__ == "__main__":
    import sys

    for seed in map(int, sys.argv[1:]):
        for count in (4, 8, 16, 40, 100):
            shares = coverages(count, seed)
            print(seed, count, "  ".join(f"{name} {share:.4f}" for name, share in shares.items()))
