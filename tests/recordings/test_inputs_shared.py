"""Files with properties that people have reported of their programs, each with its right value or refusal.

Source: the README beside the files; where the folder is absent all is skipped. What the tests of the formats write
themselves covers the same kinds in their whole width.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.campaign.campaign import read_campaign
from permway.errors import InputError
from permway.recordings.readers import read_frf, read_time
from permway.recordings.readers.hints import Hints
from permway.units import parse_unit

INPUTS = Path(__file__).parents[3] / "shared" / "inputs"
pytestmark = pytest.mark.skipif(not INPUTS.is_dir(), reason="../shared/inputs is absent")

SINE = (0.0, 0.382683, 0.707107)
"""First samples of most files: sin(2 pi 32 n / 512)."""

Ask = Mapping[str, Any]
NODE, ANY = ("101:+Z",), None

# File: how it is read, rate, units, first samples of the first channel.
TIMES: dict[str, list[tuple[Ask, float | None, tuple[str | None, ...], tuple[float, ...]]]] = {
    "csv_Time_millis.csv": [({}, 500.0, (None,), SINE)],
    "csv_coarse_time.csv": [({"sampling_Hz": 512.0}, 512.0, ("m/s2",), SINE)],
    "csv_decimal_comma_after_200_zeros.csv": [({}, 1000.0, ("m/s2",), (0.0, 0.0))],
    "csv_decimal_comma_quoted.csv": [({}, 512.0, ("m/s2",), SINE)],
    "csv_endaq.csv": [({}, 512.0, (None, None), SINE), ({"channels": ["X (100g)"]}, 512.0, (None,), SINE)],
    "csv_hash_fs_MHz.csv": [({}, 1e6, ("g", "g"), SINE)],
    "csv_hash_fs_decimal_comma.csv": [
        ({}, 51.2, ("g", "g"), SINE),
        ({"sampling_Hz": 64.0}, 64.0, ("g", "g"), SINE),
    ],
    "csv_hash_fs_thousands.csv": [({"sampling_Hz": 51200.0}, 51200.0, ("g", "g"), SINE)],
    "csv_header_unit_comma.csv": [({}, 512.0, ("m/s2",), SINE)],
    "csv_index_first_column.csv": [({"channels": ["acc"]}, 512.0, (None,), SINE)],
    "csv_keysight_second_Volt.csv": [({}, 512.0, ("V", "V"), SINE)],
    "csv_latin1_unit.csv": [({}, 512.0, ("m/s2", "degC"), SINE)],
    "csv_milli_micro_sign.csv": [({}, 512.0, ("mg",), (0.0, 382.683432))],
    "csv_missing_cells.csv": [({"channels": ["b"]}, 500.0, (None,), (1.0, 2.0, 3.0))],
    "csv_only_temperature_named_T.csv": [({}, None, ("m/s2", None), (0.0, 0.38077))],
    "csv_picoscope.csv": [({}, 512.0, ("V", "mV"), SINE)],
    "csv_sep_line_comma.csv": [({}, 512.0, ("m/s2",), SINE)],
    "csv_sep_line_excel.csv": [({}, 512.0, ("m/s2",), SINE)],
    "csv_short_rows_for_slow_channel.csv": [({"channels": ["acc"]}, 500.0, (None,), (1.0, 2.0, 3.0, 4.0))],
    "csv_t_is_temperature.csv": [({"channels": ["acc"]}, 512.0, ("m/s2",), (0.0, 0.38077))],
    "csv_three_header_lines.csv": [({}, 512.0, ("m/s2", "m/s2"), SINE)],
    "csv_time_ns.csv": [({}, 500.0, (None,), (0.0, 0.19867))],
    "csv_timestamp_ms_epoch.csv": [({}, 500.0, (None, None), (0.0, 0.19867))],
    "csv_units_row_in_parentheses.csv": [({}, 512.0, ("m/s2",), (0.0, 0.38077))],
    "csv_units_row_unknown_unit.csv": [({"channels": ["acc"]}, 512.0, ("m/s2",), (0.0, 0.38077))],
    "csv_header_semicolon_in_name.csv": [({}, 512.0, ("m/s2",), (0.0, 0.38077))],
    "csv_key_value_head_quoted_decimal_commas.csv": [
        ({"hints": Hints(header_row=6)}, 500.0, ("g", "g"), (0.0, 0.19867))
    ],
    "csv_actigraph_head.csv": [
        ({"hints": Hints(header_row=7), "sampling_Hz": 32.0}, 32.0, (None,) * 3, (-0.131, -0.118))
    ],
    "mat73_struct.mat": [({}, 512.0, (None, None), SINE)],
    "mat73_struct_and_scalar.mat": [({}, 512.0, (None, None), SINE)],
    "mat7_struct.mat": [({}, 512.0, (None, None), SINE)],
    "mat7_rate_in_struct.mat": [({}, 512.0, (None, None), SINE)],
    "mat7_time_in_ms.mat": [({"hints": Hints(unit={"time": "ms"})}, 512.0, (None,), SINE)],
    "nc4_packed_scale_factor.nc": [({}, 512.0, ("m/s2",), (0.0, 0.3826875, 0.70709375))],
    "nc4_time_milliseconds.nc": [({}, 512.0, ("m/s2",), SINE)],
    "nc4_datetime_time.nc": [({}, 512.0, ("m/s2",), SINE)],
    "tdms_x_ms.tdms": [({}, 512.0, ("g",), SINE)],
    "tdms_table_scale.tdms": [({}, 512.0, ("g",), (0.0, 6.128, 12.968))],
    "tdms_slow_channel.tdms": [({"channels": ["a"]}, 512.0, ("g",), SINE)],
    "tdms_start_times_differ.tdms": [({"channels": ["b"]}, 512.0, ("g",), (0.5, 0.461940, 0.353553))],
    "tdms_time_channel.tdms": [({}, 512.0, ("g",), SINE)],
    "tdms_time_channel_float.tdms": [({}, 512.0, ("g",), SINE)],
    "tdms_increment_one_untimed.tdms": [({"sampling_Hz": 512.0}, 512.0, ("g",), SINE)],
    "uff164_mm_then_58_unit_none.uff": [({}, 512.0, ("mm/s2",), SINE)],
    "uff164_mm_then_58_unit_said.uff": [({}, 512.0, ("mm/s2",), SINE)],
    "uff58_abscissa_ms.uff": [({}, 512.0, ("m/s2",), SINE)],
    "uff58_long_entity_name_node0.uff": [({"channels": ["PF-I-0301y+"]}, 512.0, ("m/s2",), SINE)],
    "uff58_dof_line_one_column_too_wide.uff": [({"channels": NODE}, 512.0, ("m/s2",), SINE)],
    "uff58_utf8_entity_name.uff": [({"channels": NODE}, 512.0, ("m/s2",), SINE)],
    "uff58_utf8_unit.uff": [({"channels": NODE}, 512.0, ("m/s2",), SINE)],
    "uff58_two_channels_node0_dir0.uff": [({"channels": ["Mic 02"]}, 512.0, ("m/s2",), (0.0, -0.382683))],
    "uff58_two_channels_node0_dir1.uff": [({"channels": ["Mic 02"]}, 512.0, ("m/s2",), (0.0, -0.382683))],
    "uff58_two_channels_same_dof_other_quantity.uff": [({"channels": ["7:+Z (force)"]}, 512.0, ("N",), SINE)],
    "uff58_uneven_two_channels_other_rates.uff": [({"channels": ["2:+Z"]}, 1024.0, ("m/s2",), (0.0, 0.382683))],
    "uff58_unit_right_aligned_V.uff": [({}, 512.0, ("V",), SINE)],
    "uff58_unit_right_aligned_mm.uff": [({}, 512.0, ("mm",), SINE)],
    "uff58_unit_right_aligned_mm_per_s.uff": [({}, 512.0, ("mm/s",), SINE)],
    "uff58_unit_right_aligned_m_per_s2.uff": [({}, 512.0, ("m/s2",), SINE)],
    "uff58_unit_right_aligned_blank_denominator_m_per_s2.uff": [({}, 512.0, ("m/s2",), SINE)],
    "uff58b_then_55.uff": [({}, 512.0, ("m/s2",), SINE)],
    "uff58b_le_double_real_uneven_abscissa_single.uff": [({}, 512.0, ("m/s2",), SINE)],
}


def same_unit(found: str | None, wanted: str | None) -> bool:
    if found is None or wanted is None:
        return found == wanted
    return parse_unit(found).same(parse_unit(wanted))


@pytest.mark.parametrize(
    ("file", "ask", "rate", "units", "first"),
    [(file, *case) for file, cases in TIMES.items() for case in cases],
    ids=[file for file, cases in TIMES.items() for _ in cases],
)
def test_times(
    file: str, ask: Ask, rate: float | None, units: tuple[str | None, ...], first: tuple[float, ...]
) -> None:
    record = read_time(INPUTS / file, **ask)
    assert record.sampling_Hz == (None if rate is None else pytest.approx(rate, rel=1e-9))
    assert len(record.units) == len(units)
    assert all(same_unit(found, wanted) for found, wanted in zip(record.units, units, strict=True)), record.units
    np.testing.assert_allclose(record.values[0, : len(first)], first, atol=1e-6)


REFUSED_TIMES = {
    "csv_hash_fs_thousands.csv": "line 1: a remark states the sampling rate .*sampling_Hz =",
    "csv_coarse_time.csv": r"511\.\d+ to 512\.\d+ Hz; .*sampling_Hz = 512\.0",
    "csv_actigraph_head.csv": "lines 1 to 6 are no part of a table .*header_row = 7",
    "csv_key_value_head_quoted_decimal_commas.csv": "lines 1 to 4 are no part of a table .*header_row = 6",
    "csv_missing_cells.csv": "line 3, column 'acc': the cell is empty",
    "mat7_time_in_ms.mat": 'times without a unit.*unit = { time = "ms" }',
    "nc3_fill_value.nc": "channel 'acc', sample 10 .*3 such samples here, the last is sample 12",
    "tdms_increment_one_untimed.tdms": "where nothing was timed .*sampling_Hz = ",
    "tdms_start_times_differ.tdms": r"channel 'b': sampled at 512 Hz from 0\.5 s, 'a' at 512 Hz from 0 s",
    "tdms_slow_channel.tdms": "channel 'temp': 8 samples where 'a' has 64.*channels = ",
    "tdms_unknown_scale.tdms": "scaled in a way that is not known.*PieceWisePolynomial",
    "uff58_uneven_two_channels_other_rates.uff": "channel '2:.Z': sampled at 1024 Hz .*'1:.Z' at 512 Hz",
    "uff58_time_over_length_axis8.uff": "does not stand over time: .* type 8 .*Distance",
    "uff58_type2_autospectrum.uff": "1 x auto spectrum .*with averages",
}


@pytest.mark.parametrize("file", REFUSED_TIMES)
def test_times_that_are_refused(file: str) -> None:
    with pytest.raises(InputError, match=REFUSED_TIMES[file]):
        read_time(INPUTS / file)


# File: pair, unit, frequencies, values of the first lines after 0 Hz.
FIRST = (-5.29014e-3 + 8.91062e-5j, -2.14828e-2 + 7.35380e-4j)
RESPONSES: dict[str, tuple[tuple[str, str], str | None, tuple[float, ...], tuple[complex, ...]]] = {
    "mat7_frf_square.mat": (("s1", "p2"), None, (5.0, 10.0), (11.985 - 0.59975j,)),
    "mat73_frf_square.mat": (("s1", "p2"), None, (5.0, 10.0), (11.985 - 0.59975j,)),
    "npz_frf_nan_at_0Hz.npz": (("s", "p"), None, (2.0, 4.0), FIRST),
    "uff58_frf_nan_at_0Hz.uff": (("1:+Z", "1:+Z"), "(m/s2)/N", (2.0, 4.0), FIRST),
    "uff58b_frf_nan_at_0Hz.uff": (("1:+Z", "1:+Z"), "(m/s2)/N", (2.0, 4.0), FIRST),
    "uff58_frf_abscissa_kHz.uff": (("1:+Z", "1:+Z"), "(m/s2)/N", (2.0, 4.0), FIRST),
    "uff58_frf_abscissa_rad_s.uff": (("1:+Z", "1:+Z"), "(m/s2)/N", (2.0, 4.0), FIRST),
    "uff58_frf_unit_right_aligned.uff": (("1:+Z", "1:+Z"), "(m/s2)/N", (2.0, 4.0), FIRST),
    "uff58_frf_unit_right_aligned_mm_per_kN.uff": (("1:+Z", "1:+Z"), "mm/kN", (2.0, 4.0), FIRST),
    "uff58_unit_in_both_records.uff": (("1:+Z", "1:+Z"), "(m/s2)/N", (2.0, 4.0), FIRST),
    "uff58_frfs_node0.uff": (("Acc1", "Ham"), "(m/s2)/N", (2.0, 4.0), FIRST),
    "uff58_uneven_odd.uff": (("1:+Z", "1:+Z"), "(m/s2)/N", (2.0, 4.0), FIRST),
    "uff58_uneven_odd_blank_filled.uff": (("1:+Z", "1:+Z"), "(m/s2)/N", (2.0, 4.0), FIRST),
    "uff58_uneven_odd_zero_filled.uff": (("1:+Z", "1:+Z"), "(m/s2)/N", (2.0, 4.0), FIRST),
    "uff58_uneven_one_point_per_line.uff": (("1:+Z", "1:+Z"), "(m/s2)/N", (2.0, 4.0), FIRST),
    "uff58b_le_double_cplx_uneven_abscissa_single.uff": (("1:+Z", "1:+Z"), "(m/s2)/N", (2.0, 4.0), FIRST),
}


@pytest.mark.parametrize("file", RESPONSES)
def test_responses(file: str) -> None:
    pair, unit, frequencies, values = RESPONSES[file]
    record = read_frf(INPUTS / file)
    lines = record.frequency_Hz[record.frequency_Hz > 0.0]
    found = record.pair(*pair)[record.frequency_Hz > 0.0]
    assert same_unit(record.unit, unit)
    np.testing.assert_allclose(lines[: len(frequencies)], frequencies, rtol=3e-6)
    np.testing.assert_allclose(found[: len(values)], values, rtol=1e-4)
    assert "zero_filled" not in file or record.frequency_Hz.size == 3


REFUSED_RESPONSES = {
    "uff58_frf_magnitude_only.uff": "of real numbers: a magnitude without its phase",
    "uff58_frf_dB.uff": "magnitude without its phase|decibels",
    "uff58_frf_over_rpm_axis19.uff": "does not stand over frequency: .* type 19",
    "uff55_node_in_11_columns.uff": "line 13: more than a node's number in its line",
    "csv_frf_phase_in_radians_without_unit.csv": 'degrees or radians.*unit = { phase = "rad" }',
    "csv_frf_negative_magnitude_dB.csv": "a magnitude below 0: is it a level in dB",
    "csv_frf_blank_cell.csv": "s / p, 20 Hz: the response is empty",
    "uff58_type2_autospectrum.uff": "1 x auto spectrum .*with averages",
}


@pytest.mark.parametrize("file", REFUSED_RESPONSES)
def test_responses_that_are_refused(file: str) -> None:
    with pytest.raises(InputError, match=REFUSED_RESPONSES[file]):
        read_frf(INPUTS / file)


def test_campaigns() -> None:
    (seven,) = read_campaign(INPUTS / "campaign_mat7" / "campaign.toml").load()
    (turned,) = read_campaign(INPUTS / "campaign_mat73" / "campaign.toml").load()
    for name in ("frf", "coherence"):
        np.testing.assert_array_equal(seven.data[name].values, turned.data[name].values)
    (binary,) = read_campaign(INPUTS / "campaign_uff58b_nan" / "campaign.toml").load()
    np.testing.assert_allclose(binary.data["frf"].values[0, 0], seven.data["frf"].values[0, 0], rtol=1e-6)


def test_every_file_is_read_or_refused_in_a_sentence_that_goes_on() -> None:
    """None ends in anything else, and a refusal names the file and what to do."""
    files = [path for path in sorted(INPUTS.glob("*.*")) if path.suffix != ".md" and "dma_" not in path.name]
    assert len(files) > 90
    refusals = {}
    for path in files:
        for read in (read_time, read_frf):
            try:
                read(path)
            except InputError as error:
                refusals[path.name] = error
    assert len(refusals) > 40
    silent = [name for name, error in refusals.items() if name not in str(error) or not error.remedy]
    assert silent == []
