"""Noise by the scatter of neighbouring lines: against noise that is known, of responses in closed form."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from campaigns import tables, write
from permway.campaign.campaign import Campaign, read_campaign
from permway.diagnosis.frf_lines import thinned
from permway.errors import InputError
from permway.recordings.line_scatter import FREEDOM, scatter_variance

SIGMA = 0.02
"""Of the real and of the imaginary part, over the response at rest."""


def oscillator(frequency_Hz: np.ndarray, loss: float = 0.2) -> np.ndarray:
    ratio = frequency_Hz / 20.0
    return np.asarray(1.0 / (1.0 - ratio**2 + 1j * loss))


def noisy(frequency_Hz: np.ndarray, seed: int, many: int = 1) -> np.ndarray:
    random = np.random.default_rng(seed)
    shape = (many, frequency_Hz.size)
    noise = SIGMA * (random.standard_normal(shape) + 1j * random.standard_normal(shape))
    return oscillator(frequency_Hz) + noise


@pytest.mark.parametrize("uneven", [False, True])
def test_the_variance_is_that_of_the_noise(uneven: bool) -> None:
    frequency = np.arange(5.0, 60.0, 0.1)
    if uneven:
        frequency = np.delete(frequency, np.arange(0, frequency.size, 3))
    values = noisy(frequency, 1, many=400)
    found = scatter_variance(frequency, values, where="x") * np.abs(values) ** 2
    # Everywhere, over the resonance too, and at both ends.
    assert found.mean(axis=0) == pytest.approx(SIGMA**2, rel=0.16)
    assert found.mean() == pytest.approx(SIGMA**2, rel=0.01)


def test_degrees_of_freedom_are_those_of_the_scatter() -> None:
    frequency = np.arange(5.0, 60.0, 0.1)
    values = noisy(frequency, 2, many=2000)
    found = (scatter_variance(frequency, values, where="x") * np.abs(values) ** 2)[:, 200]
    # Of a chi square of n degrees the variance over the square of the mean is 2 / n.
    assert 2.0 * found.mean() ** 2 / found.var() == pytest.approx(FREEDOM, rel=0.1)


def test_a_parabola_has_no_noise_whatever_the_steps() -> None:
    frequency = np.cumsum(np.random.default_rng(3).uniform(0.5, 2.0, 30))
    values = (1.0 + 2.0j) + 0.3 * frequency + 1j * frequency**2
    assert scatter_variance(frequency, values, where="x") == pytest.approx(0.0, abs=1e-20)


def test_few_lines_are_refused() -> None:
    with pytest.raises(InputError, match="11 lines show no scatter"):
        scatter_variance(np.arange(1.0, 12.0), np.ones(11, dtype=complex), where="x")


def written(folder: Path, *, coherence: bool = False, **record: Any) -> Campaign:
    """The small campaign with one record of frequency responses."""
    campaign, model = tables()
    own = {"file": "frf.npz", "noise": "scatter", **record}
    campaign["records"] = [{k: v for k, v in {**campaign["records"][0], **own}.items() if v is not None}]
    campaign.pop("held_out", None)
    frequency = np.arange(5.0, 60.0, 0.1)
    values = np.stack([noisy(frequency, seed, many=2) for seed in (5, 6)], axis=1).transpose(2, 1, 0)
    names = {"sensor": np.array(["r", "d"]), "hammer": np.array(["a", "b"])}
    held = {"coh": np.full(values.shape, 0.9)} if coherence else {}
    np.savez(folder / "frf.npz", f=frequency, frf=values, **names, **held)
    return read_campaign(write(folder, campaign, model))


def test_a_record_without_coherence_states_what_stands_for_it(tmp_path: Path) -> None:
    (dataset,) = written(tmp_path, averages=None).load()
    data = dataset.data
    assert data.attrs["noise"] == "scatter"
    assert "averages" not in data.attrs
    assert np.isnan(data["coherence"].values).all()
    size = np.abs(data["frf"].values[0]) ** 2
    assert np.median(data["log_variance"].values[0] * size) == pytest.approx(SIGMA**2, rel=0.15)


@pytest.mark.parametrize(
    ("record", "coherence", "message"),
    [
        ({"averages": None, "noise": None}, False, "averages"),
        ({"noise": None}, False, "has no coherence"),
        ({"averages": None}, True, "has a coherence"),
        ({"averages": 8}, False, "without averages"),
    ],
)
def test_what_states_the_noise_is_never_guessed(
    tmp_path: Path, record: dict[str, Any], coherence: bool, message: str
) -> None:
    with pytest.raises(InputError, match=message):
        written(tmp_path, coherence=coherence, **record).load()


def test_a_record_states_how_many_lines_its_resonances_take(tmp_path: Path) -> None:
    coarse = thinned(written(tmp_path, averages=None).load()[0])
    fine = thinned(written(tmp_path, averages=None, lines_per_frequency=1e4).load()[0])
    assert np.diff(coarse.frequency_Hz).min() >= coarse.frequency_Hz[0] / 40.0 - 1e-9
    assert fine.frequency_Hz.size == 550 > 3 * coarse.frequency_Hz.size
