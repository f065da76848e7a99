"""Response functions from segments and from blows: bias, coverage, several references, windows."""

import numpy as np
import pytest
from covered import phase_covered
from permway.errors import InputError
from permway.recordings.estimates.blows import blow_spectra
from permway.recordings.estimates.frf import frequency_response
from permway.recordings.estimates.intervals import frf_interval
from permway.recordings.estimates.welch import cross_spectra
from scipy import signal

RATE = 1000.0


def noise(rng, *shape):
    return rng.standard_normal(shape)


def spectra(rows, **options):
    return cross_spectra(np.stack(rows), sampling_Hz=RATE, segment_s=0.128, **options)


def frf(data, **options):
    found = frequency_response(data, references=["0"], **options)
    return found["frf"].values[0, 0, 4:-4], found


@pytest.mark.parametrize(
    ("input_noise", "output_noise", "right"), [(0.0, 1.0, "H1"), (1.0, 0.0, "H2"), (0.7, 1.4, "Hv")]
)
def test_each_estimator_is_unbiased_under_its_own_noise(input_noise, output_noise, right):
    """y = 2 x; noise n adds n^2 / (1 + n^2) of bias to the others. Over 120 lines of K = 1480: 0.1 % of chance."""
    rng = np.random.default_rng(1)
    x = noise(rng, 100_000)
    data = spectra([x + input_noise * noise(rng, x.size), 2.0 * x + output_noise * noise(rng, x.size)])
    found = {name: frf(data, estimator=name, noise_ratio=4.0)[0].mean() for name in ("H1", "H2", "Hv")}
    assert found[right] == pytest.approx(2.0, abs=0.02)
    for name, value in found.items():
        if name != right and name != "Hv":
            assert abs(value - 2.0) > 0.2
    assert abs(found["H1"]) < abs(found["Hv"]) < abs(found["H2"])


@pytest.mark.parametrize("estimator", ["H1", "H2", "Hv"])
def test_variance_is_that_met(estimator):
    """Over 200 records of K = 14: the mean stated variance of ln|H| and phase is the variance met."""
    rng = np.random.default_rng(2)
    level = {"H1": (0.0, 0.8), "H2": (0.4, 0.0), "Hv": (0.3, 0.6)}[estimator]
    values, stated = [], []
    for _ in range(200):
        x = noise(rng, 1024)
        data = spectra([x + level[0] * noise(rng, x.size), 2.0 * x + level[1] * noise(rng, x.size)])
        value, found = frf(data, estimator=estimator, noise_ratio=4.0)
        values.append(value)
        stated.append(found["variance"].values[0, 0, 4:-4])
    met = 0.5 * (np.log(np.abs(values)).var(axis=0).mean() + np.angle(values).var(axis=0).mean())
    assert met == pytest.approx(np.mean(stated), rel=0.05)


def test_two_references_cover():
    """Two correlated inputs, two outputs: 95 % intervals of all four functions, 200 records of K = 14."""
    rng = np.random.default_rng(3)
    truth = np.array([[1.0, -0.5], [0.3, 2.0]])
    covered = {"magnitude": [], "phase": [], "circle": []}
    for _ in range(200):
        x = noise(rng, 2, 1024)
        x[1] += 0.6 * x[0]
        y = truth @ x + np.array([[0.5], [0.8]]) * noise(rng, 2, 1024)
        found = frequency_response(spectra([*x, *y]), references=["0", "1"])
        h = found["frf"].values[..., 4:-4]
        interval = frf_interval(h, found["variance"].values[..., 4:-4], found["degrees_of_freedom"].values[4:-4])
        exact = truth[:, :, None]
        covered["magnitude"].append(interval.magnitude.covers(np.abs(exact)))
        covered["phase"].append(phase_covered(interval.phase_rad, np.angle(exact)))
        covered["circle"].append(np.abs(h - exact) <= interval.radius)
    shares = {name: np.mean(part) for name, part in covered.items()}
    assert all(0.93 <= share <= 0.97 for share in shares.values()), shares


def ringing(samples, decay_per_s):
    """Impulse response of one mode at 120 Hz, per sample, and its response function in discrete time."""
    pole = np.exp((-decay_per_s + 2j * np.pi * 120.0) / RATE)
    response = np.imag(pole ** np.arange(samples))

    def function(frequency, added=0.0):
        z = np.exp((added + 2j * np.pi * frequency) / RATE)
        return 0.5j * (1.0 / (1.0 - pole.conjugate() / z) - 1.0 / (1.0 - pole / z))

    return response, function


def blows(rng, count, samples=2048, decay_per_s=60.0, force_noise=0.0, output_noise=0.0, start=40):
    impulse, _ = ringing(samples, decay_per_s)
    record = np.zeros((count, 2, samples))
    for blow in record:
        blow[0, start : start + 7] = (1.0 + 0.2 * rng.standard_normal()) * signal.windows.hann(9)[1:-1]
        blow[1] = np.convolve(blow[0], impulse)[:samples] + output_noise * noise(rng, samples)
        blow[0] += force_noise * noise(rng, samples)
    return record


def test_blows_without_noise_are_exact():
    record = blows(np.random.default_rng(4), 3)
    data = blow_spectra(record, sampling_Hz=RATE, units=["N", "m/s^2"])
    found = frequency_response(data, references=["0"])
    use = slice(1, 350)
    exact = ringing(8, 60.0)[1](found["frequency"].values[use])
    assert found["frf"].values[0, 0, use] == pytest.approx(exact, rel=1e-6)
    assert found["coherence"].values[0, use] == pytest.approx(np.ones(349), abs=1e-9)
    assert found["degrees_of_freedom"].values[10] == pytest.approx(2.0 * (3 - 1))
    assert list(found["reference_unit"].values) == ["N"]


def test_exponential_window_is_a_complex_frequency():
    """A mode that rings past the record's end: with the window it is exact at omega - i / tau."""
    record = blows(np.random.default_rng(4), 2, samples=1024, decay_per_s=4.0)
    plain, windowed = (
        frequency_response(
            blow_spectra(record, sampling_Hz=RATE, exponential_s=tau, blow_at_s=0.04), references=["0"]
        )
        for tau in (None, 0.06)
    )
    use = slice(60, 200)
    frequency = plain["frequency"].values[use]
    _, function = ringing(8, 4.0)
    assert windowed.attrs["added_decay_per_s"] == pytest.approx(1.0 / 0.06)
    exact = function(frequency, added=1.0 / 0.06)
    assert windowed["frf"].values[0, 0, use] == pytest.approx(exact, rel=2e-4, abs=1e-6 * np.abs(exact).max())
    off = np.abs(plain["frf"].values[0, 0, use] / function(frequency) - 1.0)
    assert off.max() > 0.01


def test_force_window_takes_noise_off_the_force():
    record = blows(np.random.default_rng(5), 4, force_noise=0.02)
    use = slice(100, 300)
    bias = []
    for keep in (None, 0.02):
        data = blow_spectra(record, sampling_Hz=RATE, force_window_s=keep, blow_at_s=0.04)
        found = frequency_response(data, references=["0"])
        exact = ringing(8, 60.0)[1](found["frequency"].values[use])
        bias.append(np.abs(np.abs(found["frf"].values[0, 0, use] / exact) - 1.0).mean())
    assert bias[1] < 0.3 * bias[0]


@pytest.mark.parametrize("count", [3, 5, 10])
def test_few_blows_cover(count):
    """Noise on the response, 150 sets of few blows: Student's t with 2 (n - 1) degrees of freedom."""
    rng = np.random.default_rng([7, count])
    covered = []
    for _ in range(150):
        data = blow_spectra(blows(rng, count, samples=512, decay_per_s=120.0, output_noise=0.05), sampling_Hz=RATE)
        found = frequency_response(data, references=["0"])
        use = slice(5, 120)
        interval = frf_interval(
            found["frf"].values[0, 0, use],
            found["variance"].values[0, 0, use],
            found["degrees_of_freedom"].values[use],
        )
        exact = ringing(8, 120.0)[1](found["frequency"].values[use])
        covered.append(
            [interval.magnitude.covers(np.abs(exact)), phase_covered(interval.phase_rad, np.angle(exact))]
        )
    magnitude, phase = np.mean(covered, axis=(0, 2))
    assert 0.93 <= magnitude <= 0.97
    assert 0.93 <= phase <= 0.97


def test_a_line_without_force_is_marked():
    found = frequency_response(
        blow_spectra(blows(np.random.default_rng(1), 3), sampling_Hz=RATE), references=["0"]
    )
    dead = ~found["usable"].values
    # The blow is a Hann pulse of 8 ms, whose transform vanishes at k / 8 ms from k = 2 on.
    assert list(found["frequency"].values[dead]) == [250.0, 375.0, 500.0]
    assert np.isnan(found["frf"].values[..., dead]).all()
    assert np.isinf(found["variance"].values[..., dead]).all()
    assert np.isfinite(found["frf"].values[..., ~dead]).all()


def three(seed=0):
    return noise(np.random.default_rng(seed), 3, 2000)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: frequency_response(spectra(three()), references=["9"]), "references: unknown channel"),
        (lambda: frequency_response(spectra(three()), references=[]), "references: names no channel"),
        (lambda: frequency_response(spectra(three()), references=["0"], estimator="H3"), "estimator: unknown"),
        (
            lambda: frequency_response(spectra(three()), references=["0", "1"], estimator="H2"),
            "takes one reference",
        ),
        (lambda: frequency_response(spectra(three()[:, :128]), references=["0"]), "leave no freedom"),
        (
            lambda: frequency_response(spectra([np.zeros(2000), *three()]), references=["0"]),
            "reference without power",
        ),
        (
            lambda: frequency_response(spectra([*three(), three()[0]]), references=["0", "3"]),
            "references that depend on one another, at every line",
        ),
        (lambda: frequency_response(spectra(three()), references=["0"], estimator="Hv"), "noise_ratio: Hv needs"),
        (lambda: frequency_response(three(), references=["0"]), "spectra: has no `csd`"),
        (lambda: blow_spectra(three(), sampling_Hz=RATE), r"blows: must have 3 dimension\(s\)"),
        (lambda: blow_spectra(np.full((2, 2, 64), np.nan), sampling_Hz=RATE), r"blows\[0, 0, 0\]: not finite"),
        (lambda: blow_spectra(np.ones((2, 2, 64)), sampling_Hz=RATE, blow_at_s=1.0), "blow_at_s: outside"),
        (lambda: blow_spectra(np.ones((2, 2, 64)), sampling_Hz=RATE, force=2), "force: there are 2 channels"),
    ],
)
def test_bad_arguments(call, message):
    with pytest.raises(InputError, match=message):
        call()
