"""Spectra of universal files: several functions of one pair, and densities as records of a campaign."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import campaigns
import numpy as np
import pytest
import pyuff
import written
from hypothesis import given, settings
from hypothesis import strategies as st
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.predict import predict
from permway.errors import InputError
from permway.recordings.estimates.welch import cross_spectra
from permway.recordings.look import look
from permway.recordings.readers import read_frf

RATE = 256.0
F = np.arange(1.0, 11.0)


def function(path: Path, kind: int, data: np.ndarray, x: np.ndarray, **more: Any) -> None:
    fields: dict[str, Any] = {
        "binary": 1, "func_type": kind, "rsp_node": 1, "rsp_dir": 3, "ref_node": 2, "ref_dir": 3, "data": data,
        "x": x,
        "abscissa_spacing": 1, "abscissa_spec_data_type": 18, "abscissa_axis_units_lab": "Hz",
        "ordinate_spec_data_type": 12, "orddenom_spec_data_type": 0, "ordinate_axis_units_lab": "NONE",
    }  # fmt: skip
    written.append_uff(path, pyuff.prepare_58(**fields | more))


def repeats(path: Path, *, coherence: tuple[int, ...] = (1, 2), **more: Any) -> None:
    """Two repeats of one pair, by their numbers."""
    for number in (1, 2):
        function(path, 4, number * (F + 1j), F, ver_num=number, **more)
    for number in coherence:
        function(path, 6, np.full(F.size, number / 10.0), F, ver_num=number)


def test_a_function_of_one_pair_by_its_number(tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    repeats(path)
    second = read_frf(path, responses=["1:+Z (version 2)"])
    assert (second.responses, second.references) == (("1:+Z (version 2)",), ("2:+Z",))
    np.testing.assert_allclose(second.values[0], 2 * (F + 1j), rtol=1e-6)
    assert second.coherence is not None
    np.testing.assert_allclose(second.coherence[0], 0.2, rtol=1e-6)


def test_a_coherence_of_nobody_knows_which(tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    repeats(path, coherence=(3, 4))
    function(path, 4, F + 0j, F, rsp_node=7)
    function(path, 6, np.ones(F.size), F, rsp_node=7)
    assert read_frf(path, responses=["7:+Z"]).coherence is not None
    with pytest.raises(InputError, match=r"a coherence without its frequency response \(got '1:\+Z \(version 3\)"):
        read_frf(path, responses=["1:+Z (version 2)"])


def test_functions_that_nothing_distinguishes(tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    for _ in range(2):
        function(path, 4, F + 1j, F, ver_num=1)
    function(path, 4, F + 0j, F, rsp_node=7)
    assert read_frf(path, responses=["7:+Z"]).responses == ("7:+Z",)
    with pytest.raises(InputError, match="a pair measured twice"):
        read_frf(path)


def measured(seed: int, channels: int = 2) -> np.ndarray:
    random = np.random.default_rng(seed)
    mixed = np.array([[1.0, 0.0, 0.0], [0.6, 0.5, 0.0], [-0.3, 0.2, 0.9]])[:channels, :channels]
    return np.asarray(mixed @ random.standard_normal((channels, round(40 * RATE))))


def spectra(path: Path, csd: np.ndarray, frequency: np.ndarray, **more: Any) -> None:
    for i in range(csd.shape[0]):
        both = {"rsp_node": i + 1, "ref_node": i + 1, "rsp_dir": 3, "ref_dir": 3}
        function(path, 9, csd[i, i].real, frequency, **both | more)
        for j in range(i):
            function(path, 3, csd[i, j], frequency, **both | {"ref_node": j + 1} | more)


def campaign(folder: Path, file: str, **more: Any) -> Campaign:
    table, model = campaigns.tables()
    record = {
        "name": "run", "file": file, "condition": "fast", "statistic": "csd",
        "channels": {"1:+Z": "axle", "2:+Z": "floor"},
        "segment_s": 0.5, "band_Hz": [8.0, 60.0],
    }  # fmt: skip
    table["records"] = [{key: value for key, value in {**record, **more}.items() if value is not None}]
    table["held_out"] = []
    table["sensors"][3]["unit"] = "m/s2"
    return read_campaign(campaigns.write(folder, table, model))


@settings(max_examples=10)
@given(seed=st.integers(0, 2**31), unit=st.sampled_from(["(m/s^2)^2/Hz", "m2/s4/Hz", "NONE"]))
def test_spectra_are_those_of_the_record(seed: int, unit: str, tmp_path_factory: Any) -> None:
    """The same run as samples and as spectra by another program: the same cross spectra, phase and all."""
    folder = tmp_path_factory.mktemp("spectra")
    x = measured(seed)
    found = cross_spectra(x, sampling_Hz=RATE, segment_s=0.5, overlap=0.0)
    csd, frequency = found["csd"].values, found["frequency"].values
    spectra(folder / "run.uff", csd, frequency, ordinate_axis_units_lab=unit)
    (dataset,) = campaign(folder, "run.uff", averages=80.0).load()
    used = (frequency >= 8.0) & (frequency <= 60.0)
    np.testing.assert_allclose(dataset.data["csd"].values, csd[:, :, used], rtol=1e-6)
    np.testing.assert_allclose(dataset.data["frequency"].values, frequency[used], rtol=1e-6)
    assert dataset.data.attrs["averages"] == 80.0
    np.testing.assert_allclose(dataset.data["degrees_of_freedom"].values, 160.0)
    np.testing.assert_allclose(dataset.data["line_covariance"].values, found["line_covariance"].values, rtol=1e-6)


def test_spectra_are_predicted(tmp_path: Path) -> None:
    found = cross_spectra(measured(1), sampling_Hz=RATE, segment_s=0.5, overlap=0.0)
    spectra(tmp_path / "run.uff", found["csd"].values, found["frequency"].values)
    read = campaign(tmp_path, "run.uff", averages=80.0)
    (predicted,) = predict(read, read.load())
    assert predicted["csd"].shape == (2, 2, 27)
    assert np.all(predicted["psd"].values > 0.0)


@pytest.mark.parametrize(
    ("change", "stated"),
    [
        ({"averages": None}, r"it holds spectra: in a campaign statistic = \"csd\" with averages"),
        ({"segment_s": 1.0}, r"lines 2 Hz apart, and segment_s means 1 Hz .*segment_s = 0.5"),
        ({"unit": "m/s2"}, "whether these are densities is not stated"),
        ({"unit": "(mm/s2)^2/Hz"}, "the record states"),
        ({"channels": {"1:+Z": "axle", "9:+Z": "floor"}}, r"no auto spectrum of this channel \(got '9:\+Z'\)"),
    ],
)
def test_refused(change: dict[str, Any], stated: str, tmp_path: Path) -> None:
    found = cross_spectra(measured(2), sampling_Hz=RATE, segment_s=0.5, overlap=0.0)
    spectra(tmp_path / "run.uff", found["csd"].values, found["frequency"].values)
    with pytest.raises(InputError, match=stated):
        campaign(tmp_path, "run.uff", **{"averages": 80.0, **change}).load()


def test_cross_spectra_that_are_missing_or_of_another_scale(tmp_path: Path) -> None:
    found = cross_spectra(measured(3), sampling_Hz=RATE, segment_s=0.5, overlap=0.0)
    csd, frequency = found["csd"].values.copy(), found["frequency"].values
    for i in range(2):
        both = {"rsp_node": i + 1, "ref_node": i + 1, "rsp_dir": 3, "ref_dir": 3}
        function(tmp_path / "a.uff", 9, csd[i, i].real, frequency, **both)
    with pytest.raises(InputError, match="holds no cross spectrum of two channels"):
        campaign(tmp_path, "a.uff", averages=80.0).load()
    one = campaign(tmp_path, "a.uff", averages=80.0, channels={"2:+Z": "floor"}).load()[0]
    np.testing.assert_allclose(one.data["psd"].values[0], csd[1, 1, 4:31].real, rtol=1e-6)
    csd[1, 0] *= 2.0
    spectra(tmp_path / "b.uff", csd, frequency)
    with pytest.raises(InputError, match="larger than the auto spectra allow"):
        campaign(tmp_path, "b.uff", averages=80.0).load()


def test_an_auto_spectrum_does_not_state_that_it_is_a_density(tmp_path: Path) -> None:
    function(tmp_path / "a.uff", 2, np.ones(50), 2.0 * np.arange(50), ref_node=1)
    one = {"averages": 80.0, "channels": {"1:+Z": "axle"}}
    with pytest.raises(InputError, match=r"densities is not stated.*\"\(m/s2\)\^2/Hz\""):
        campaign(tmp_path, "a.uff", **one).load()
    (dataset,) = campaign(tmp_path, "a.uff", unit={"1:+Z": "(m/s2)^2/Hz"}, **one).load()
    np.testing.assert_array_equal(dataset.data["psd"].values, 1.0)


def test_look_shows_spectra(tmp_path: Path) -> None:
    function(tmp_path / "a.uff", 9, np.ones(50), 2.0 * np.arange(50), ref_node=1, ordinate_axis_units_lab="g^2/Hz")
    result = look(tmp_path / "a.uff")
    assert [row["unit"] for row in result["spectra"]] == ["g^2/Hz"]
    assert all(text in result["campaign"] for text in ("segment_s = 0.5", 'unit = "g"', "averages"))
