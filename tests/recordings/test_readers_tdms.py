"""When the samples of TDMS channels were taken."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter
from permway.errors import InputError
from permway.recordings.readers import read_time
from permway.recordings.readers.hints import Hints

START = np.datetime64("2026-01-05T10:00:00", "us")


def write(folder: Path, **channels: dict[str, Any]) -> Path:
    """Channels by name: properties, and `data`."""
    objects = []
    for name, properties in channels.items():
        data = properties.pop("data", np.sin(np.arange(64.0)))
        objects.append(ChannelObject("g", name, data, properties=properties))
    path = folder / "a.tdms"
    with TdmsWriter(str(path)) as file:
        file.write_segment([RootObject(), GroupObject("g"), *objects])
    return path


@pytest.mark.parametrize(
    ("properties", "rate"),
    [
        ({"wf_increment": 1 / 512}, 512.0),
        ({"wf_increment": 1.953125, "wf_xunit_string": "ms"}, 512.0),
        ({"wf_increment": 1953.125, "wf_xunit_string": "µs"}, 512.0),
        ({"wf_increment": 1.0, "wf_start_time": START}, 1.0),
        ({"wf_increment": 1.0}, "where nothing was timed .*sampling_Hz = "),
        ({"wf_increment": 2.0, "wf_xunit_string": "Hz"}, "wf_xunit_string: is no unit of time"),
        ({"wf_increment": 0.25, "wf_xname": "Distance"}, "does not stand over time .*Distance"),
    ],
)
def test_steps(properties: dict[str, Any], rate: float | str, tmp_path: Path) -> None:
    path = write(tmp_path, a=dict(properties))
    if isinstance(rate, str):
        with pytest.raises(InputError, match=rate):
            read_time(path)
        hints = Hints(time_column="none")
        assert read_time(path, sampling_Hz=512.0, hints=hints).sampling_Hz == 512.0
    else:
        assert read_time(path).sampling_Hz == pytest.approx(rate)


def test_starts(tmp_path: Path) -> None:
    step = {"wf_increment": 1 / 512}
    late = START + np.timedelta64(500, "ms")
    path = write(
        tmp_path, a={**step, "wf_start_time": START}, b={**step, "wf_start_time": late},
        c={**step, "wf_start_time": START, "wf_start_offset": 0.5}, d=dict(step),
    )  # fmt: skip
    assert read_time(path, channels=["b", "c"]).start_s == pytest.approx(0.5)
    for pair in (["a", "b"], ["a", "c"], ["a", "d"]):
        with pytest.raises(InputError, match=f"channel '{pair[1]}': sampled at 512 Hz from"):
            read_time(path, channels=pair)


def test_clocks_of_one_microsecond_are_together(tmp_path: Path) -> None:
    step = {"wf_increment": 1 / 512}
    path = write(
        tmp_path, a={**step, "wf_start_time": START}, b={**step, "wf_start_time": START + np.timedelta64(1, "us")}
    )
    assert read_time(path).sampling_Hz == pytest.approx(512.0)


def test_channels_of_times(tmp_path: Path) -> None:
    t = np.arange(64) / 512
    dates = START + np.round(t * 1e6).astype("timedelta64[us]")
    path = write(
        tmp_path,
        **{"Time [ms]": {"data": t * 1e3}, "a": {}, "temp": {"data": np.arange(8.0), "wf_increment": 0.5}},
    )
    assert read_time(path, channels=["a"]).sampling_Hz == pytest.approx(512.0)
    with pytest.raises(InputError, match="channel 'temp': 8 samples where 'a' has 64"):
        read_time(path)
    path = write(tmp_path, clock={"data": dates}, a={})
    assert read_time(path, channels=["a"]).sampling_Hz is None
    with pytest.raises(InputError, match="channel 'clock': samples must be real numbers"):
        read_time(path, channels=["clock"])
    record = read_time(path, hints=Hints(time_column="clock"))
    assert (record.channels, record.sampling_Hz) == (("a",), pytest.approx(512.0))


def test_a_table_scale(tmp_path: Path) -> None:
    """0, 1000, 1000 by npTDMS before 1.11: it took the table's own numbers."""
    scale: dict[str, Any] = {
        "NI_Scaling_Status": "unscaled", "NI_Number_Of_Scales": 1, "NI_Scale[0]_Scale_Type": "Table",
        "NI_Scale[0]_Table_Input_Source": 0xFFFFFFFF, "NI_Scale[0]_Table_Scaled_Values_Size": 3,
        "NI_Scale[0]_Table_Pre_Scaled_Values_Size": 3,
    }  # fmt: skip
    for i, (raw, value) in enumerate(((-100.0, -20.0), (0.0, 0.0), (100.0, 8.0))):
        scale |= {f"NI_Scale[0]_Table_Pre_Scaled_Values[{i}]": raw, f"NI_Scale[0]_Table_Scaled_Values[{i}]": value}
    path = write(tmp_path, a={"data": np.array([0, 50, -50, 100], dtype=np.int16), "wf_increment": 0.01, **scale})
    np.testing.assert_allclose(read_time(path).values[0], [0.0, 4.0, -10.0, 8.0])
