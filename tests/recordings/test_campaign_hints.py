"""Keys of a record that win over its file, and units held against sensors."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from campaigns import tables, write
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.load import load_record
from permway.errors import InputError

RATE = 512.0
SAMPLES = np.random.default_rng(3).normal(size=(2, 3000))


def campaign_of(folder: Path, content: str | bytes, **record: Any) -> Campaign:
    """The small campaign with a run of this content, its record changed."""
    campaign, model = tables()
    campaign["records"][1] |= record
    for key, value in list(campaign["records"][1].items()):
        if value is None:
            del campaign["records"][1][key]
    path = write(folder, campaign, model)
    (folder / "run.csv").write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_campaign(path)


def psd(campaign: Campaign) -> np.ndarray:
    return np.asarray(load_record(campaign, campaign.stated.records[1]).data["psd"].values)


@pytest.fixture
def plain(tmp_path: Path) -> np.ndarray:
    folder = tmp_path / "plain"
    folder.mkdir()
    rows = [f"{a:.6f},{b:.6f}" for a, b in SAMPLES.T]
    return psd(campaign_of(folder, "\n".join(["axle,floor", *rows]) + "\n"))


def commas(text: str) -> str:
    return text.replace(".", ",")


@pytest.mark.parametrize(
    ("head", "row", "coding", "keys"),
    [
        (["Logger", "x;y", "axle;floor"], "{0};{1}", "utf-8", {"header_row": 3, "decimal": ","}),
        (["Logger", "x;y", "axle;floor"], "{0};{1}", "utf-16", {"skip_rows": 2, "encoding": "utf-16"}),
        (["axle [furlong];floor [mg]"], "{0};{1}", "utf-8", {"unit": {"axle": "m/s2", "floor": "g"}}),
        (["# fs = 9,999 Hz", "axle;floor"], "{0};{1}", "utf-8", {}),
        (["time;axle;floor"], "{2};{0};{1}", "utf-8", {"unit": {"time": "ms"}, "sampling_Hz": None}),
        (["time;axle;floor"], "{2};{0};{1}", "utf-8", {"time_column": "none"}),
        (["n;axle;floor"], "{2};{0};{1}", "utf-8", {"time_column": "n", "unit": {"n": "ms"}, "sampling_Hz": None}),
        (["axle;floor;slow;note"], "{0};{1};;x", "utf-8", {}),
    ],
)  # fmt: skip
def test_what_the_record_states_wins(
    head: list[str], row: str, coding: str, keys: dict[str, Any], plain: np.ndarray, tmp_path: Path
) -> None:
    rows = [
        row.format(commas(f"{a:.6f}"), commas(f"{b:.6f}"), commas(f"{i / RATE * 1e3:.6f}"))
        for i, (a, b) in enumerate(SAMPLES.T)
    ]
    campaign = campaign_of(tmp_path, "\n".join([*head, *rows]).encode(coding), **keys)
    np.testing.assert_allclose(psd(campaign), plain, rtol=1e-9)


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ({"header_row": -1}, "header_row"),
        ({"decimal": "x"}, "decimal"),
        ({"encoding": "klingon"}, "encoding.*no such character set"),
        ({"header_row": 2, "skip_rows": 5}, "header_row.*among those that are skipped"),
        ({"axes": ["frequency", "response", "reference"]}, "axes.*goes with statistic 'frf'"),
    ],
)
def test_keys_that_cannot_be(keys: dict[str, Any], expected: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=expected):
        campaign_of(tmp_path, "a\n1\n", **keys)


@pytest.mark.parametrize(
    ("unit", "stated", "expected"),
    [
        ("(mm/s2)/N", None, r"r / a.*\(got '\(mm/s2\)/N'\).*unit = \"\(m/s2\)/N\""),
        ("m/s2", None, "the sensor and the force point make it '\\(m/s2\\)/N'"),
        ("dB", None, "in decibels is no ratio"),
        ("(m/s2)/N", "(mm/s2)/N", "the record states '\\(mm/s2\\)/N'"),
        ("blurb", "(m/s2)/N", ""),
        ("(m/s^2)/N", None, ""),
    ],
)
def test_responses_are_in_the_unit_of_sensor_over_force(
    unit: str, stated: str | None, expected: str, tmp_path: Path
) -> None:
    campaign, model = tables()
    campaign["records"][0] |= {"file": "frf.npz", "responses": {"r": "rail@12"}, "references": {"a": "hit"}}
    if stated is not None:
        campaign["records"][0]["unit"] = stated
    path = write(tmp_path, campaign, model)
    values = np.ones((4, 1, 1)) * 1j
    np.savez(
        tmp_path / "frf.npz", f=np.arange(1.0, 5.0), frf=values, coh=np.full((4, 1, 1), 0.9),
        sensor=np.array(["r"]), hammer=np.array(["a"]), unit=unit,
    )  # fmt: skip
    read = read_campaign(path)
    if expected:
        with pytest.raises(InputError, match=expected):
            load_record(read, read.stated.records[0])
    else:
        data = load_record(read, read.stated.records[0]).data
        np.testing.assert_array_equal(data["frf"].values.ravel(), np.full(4, 1j))
