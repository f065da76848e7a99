"""Random tables of text as loggers and spreadsheets write them."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any

import numpy as np
from drawn import RATES, UNITS, Meaning, Responses, Times, by_pair, chance, pick, responses, signals
from permway.recordings.readers.hints import Hints

_TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "second": 1.0, "min": 60.0}
_REMARKS = {
    "fs = {} Hz": 1.0, "# sampling rate: {}": 1.0, "sample rate [Hz]: {}": 1.0, "fs: {} kHz": 1e-3,
    "Sampling frequency (Hz): {}": 1.0, "fs={} MHz": 1e-6,
}  # fmt: skip


def _number(value: float, form: str, comma: bool) -> str:
    text = format(value, form)
    return text.replace(".", ",") if comma else text


def _back(text: str) -> float:
    return float(text.replace(",", "."))


def times(random: np.random.Generator, folder: Path) -> tuple[Path, Meaning]:
    """A record in time."""
    count, samples = int(random.integers(1, 5)), int(random.integers(3, 300))
    x = signals(random, count, samples)
    rate = pick(random, *RATES)
    separator = pick(random, ",", ";", "\t")
    quoted = chance(random, 0.2)
    comma = chance(random, 0.4) and (separator != "," or quoted)
    form = pick(random, ".6g", ".9g", ".17g", ".6e", ".6f", ".3f", ".0f")
    texts = [[_number(v, form, comma) for v in row] for row in x]
    x = np.array([[_back(text) for text in row] for row in texts])
    names = [
        pick(random, "acc", "box left", "Kanal", "X (100g)", "T", "7", "v; w") + f" {i}" for i in range(count)
    ]
    units = [pick(random, None, *UNITS) for _ in names]
    style = pick(random, "square", "round", "row", "row in brackets", "comma", "none")
    if style in ("comma", "round"):
        # A letter alone in round brackets may be a side, and after a comma a name.
        units = [u if u is None or "/" in u or u in ("mm", "um", "kN", "mg", "mV") else "mm/s" for u in units]
    if style == "none":
        units = [None] * count
    if style.startswith("row") and all(u is None for u in units):
        units[0] = "g"
    columns, head, below = [*texts], list(names), [u or "" for u in units]
    meant_rate: float | None = rate
    remark, precision = "", 1e-4
    kind = pick(random, "none", "remark", "seconds", "unit", "epoch", "clock")
    if kind == "remark":
        template, scale = list(_REMARKS.items())[int(random.integers(len(_REMARKS)))]
        expected = f"{rate * scale:.10g}"
        expected = expected.replace(".", ",") if chance(random, 0.3) else expected
        if chance(random, 0.1) and rate >= 1000.0 and scale == 1.0:
            expected = f"{rate:,.0f}" if rate == round(rate) else expected
        remark = pick(random, "# ", "% ", "// ") + template.format(expected)
    elif kind != "none":
        column, label, unit, precision = _time_column(random, kind, rate, samples, comma)
        columns, head, below = [column, *columns], [label, *head], [unit, *below]
    else:
        meant_rate = None
    if style == "row in brackets":
        below = [pick(random, f"({u})", f"[{u}]") if u else "" for u in below]
    if style in ("square", "round", "comma", "none"):
        first = len(head) - count
        forms = {"square": "{} [{}]", "round": "{} ({})", "comma": "{}, {}", "none": "{}"}
        head = [
            name if not unit else forms["square" if i < first and style == "none" else style].format(name, unit)
            for i, (name, unit) in enumerate(zip(head, below, strict=True))
        ]
    if chance(random, 0.2):
        columns.append([pick(random, "on", "", "off") for _ in range(samples)])
        head, below = [*head, "state"], [*below, ""]
    lines = [head, *([below] if style.startswith("row") else []), *map(list, zip(*columns, strict=True))]
    text = _written(lines, separator, quoted)
    ask: dict[str, Any] = {"channels": names}
    above = [remark] if remark else []
    if chance(random, 0.15):
        notes = ["Logger 7", f"Serial{separator}12", f"Samplerate{separator}999"][: int(random.integers(1, 4))]
        above += notes
        if chance(random, 0.5):
            ask["hints"] = Hints(header_row=len(above) + 1)
    if chance(random, 0.1) and not above:
        above = [f"sep={separator}"]
    end = pick(random, "\n", "\r\n")
    body = end.join([*above, *text.split("\n")])
    coding = pick(random, "utf-8", "utf-8-sig", "latin-1", "utf-16")
    if coding == "utf-16" and chance(random, 0.5):
        ask["hints"] = Hints(encoding="utf-16", header_row=len(above) + 1)
    path = folder / "a.csv"
    path.write_bytes(body.encode(coding))
    factors = [UNITS[u] if u else 1.0 for u in units]
    return path, Times(
        channels=dict(zip(names, (row * f for row, f in zip(x, factors, strict=True)), strict=True)),
        units=dict(zip(names, units, strict=True)),
        rate_Hz=meant_rate,
        rate_precision=precision,
        ask=ask,
    )


def _time_column(
    random: np.random.Generator, kind: str, rate: float, samples: int, comma: bool
) -> tuple[list[str], str, str, float]:
    """Cells, name, unit, and what the printed digits leave of the rate."""
    t = np.arange(samples) / rate
    if kind == "clock":
        start = np.datetime64("2026-01-05T10:00:00", "us")
        moments = start + np.round(t * 1e6).astype("timedelta64[us]")
        return [str(m).replace("T", pick(random, "T", " ")) for m in moments], "timestamp", "", 2e-4
    if kind == "epoch":
        power = pick(random, 3, 6)
        cells = [str(round((1_767_607_200.0 + s) * 10**power)) for s in t]
        worth = 10.0**-power
        return cells, pick(random, "time", "timestamp"), "", max(1e-4, 1.1 * worth * rate / (samples - 1))
    unit = "s" if kind == "seconds" else list(_TIME_UNITS)[int(random.integers(len(_TIME_UNITS)))]
    digits = int(random.integers(3, 10))
    cells = [_number(s / _TIME_UNITS[unit], f".{digits}f", comma) for s in t]
    worth = 10.0**-digits * _TIME_UNITS[unit]
    expected = "" if kind == "seconds" and chance(random, 0.5) else unit
    # Even steps in few digits are taken as they stand; how far that may be off is what their last digit is worth.
    return (
        cells,
        pick(random, "time", "Time", "t", "Zeit"),
        expected,
        max(1e-4, 1.1 * worth * rate / (samples - 1)),
    )


def _written(lines: list[list[str]], separator: str, quoted: bool) -> str:
    stream = io.StringIO()
    quoting = csv.QUOTE_ALL if quoted else csv.QUOTE_MINIMAL
    csv.writer(stream, delimiter=separator, quoting=quoting, lineterminator="\n").writerows(lines)
    return stream.getvalue().rstrip("\n") + "\n"


def frf(random: np.random.Generator, folder: Path) -> tuple[Path, Meaning]:
    """Frequency responses, a row for each frequency, sensor and point."""
    f, values, coherence = responses(random)
    sensors, points = ([f"{k}{i}" for i in range(n)] for k, n in zip("sp", values.shape[1:], strict=True))
    unit, factor = pick(random, (None, 1.0), ("(m/s2)/N", 1.0), ("mm/kN", 1e-6), ("g/N", 9.80665))
    hz, scale = pick(random, ("Hz", 1.0), (None, 1.0), ("kHz", 1e-3), ("rad/s", 2.0 * np.pi))
    polar = pick(random, None, "deg", "rad", "")
    first = "real" if polar is None else "magnitude"
    second = "imag" if polar is None else f"phase [{polar}]" if polar else "phase"
    head = [f"frequency [{hz}]" if hz else "frequency", "sensor", "point", f"{first} [{unit}]" if unit else first]
    head += [second, "coherence"]
    rows = []
    for i, sensor in enumerate(sensors):
        for j, point in enumerate(points):
            for line, frequency in enumerate(f):
                z = values[line, i, j]
                angle = np.rad2deg(np.angle(z)) if polar == "deg" else np.angle(z)
                parts = (z.real, z.imag) if polar is None else (abs(z), angle)
                cells = (repr(float(frequency * scale)), sensor, point, *(repr(float(p)) for p in parts))
                rows.append([*cells, repr(float(coherence[line, i, j]))])
    if chance(random, 0.1):
        rows[int(random.integers(len(rows)))][3] = ""
    path = folder / "frf.csv"
    path.write_text(_written([head, *rows], pick(random, ",", ";", "\t"), chance(random, 0.2)))
    meant = by_pair(values, sensors, points, factor)
    cohere = by_pair(coherence, sensors, points)
    return path, Responses(f, meant, cohere, None if unit is None else factor)


def _complex_text(z: complex, comma: bool, style: str) -> str:
    sign = "-" if z.imag < 0 or (z.imag == 0 and np.signbit(z.imag)) else "+"
    text = style.format(repr(float(z.real)), sign, repr(abs(float(z.imag))))
    return text.replace(".", ",") if comma else text


def frf_wide(random: np.random.Generator, folder: Path) -> tuple[Path, Meaning]:
    """Frequency responses side by side: a column of complex text, or two columns, for each."""
    f, values, coherence = responses(random)
    sensors, points = ([f"{k}{i}" for i in range(n)] for k, n in zip("sp", values.shape[1:], strict=True))
    unit, factor = pick(random, (None, 1.0), ("(m/s2)/N", 1.0), ("mm/kN", 1e-6), ("g/N", 9.80665))
    hz, scale = pick(random, ("Hz", 1.0), (None, 1.0), ("kHz", 1e-3), ("rad/s", 2.0 * np.pi))
    form = pick(random, "complex", "parts", "deg", "rad", "dB", "no unit")
    words = pick(random, ("Real", "Imag"), ("re", "im"), ("Real part", "Imaginary part"))
    words = words if form == "parts" else pick(random, ("Magnitude", "Phase"), ("mag", "angle"))
    style = pick(random, "{}{}{}j", "{} {} {}i", "({}{}{}j)", "{}{}j{}")
    separator = pick(random, ",", ";", "\t")
    comma, quoted = chance(random, 0.4), chance(random, 0.2)
    comma = comma and (separator != "," or quoted)
    named = pick(random, "{} / {}", "H({}/{})", "FRF {} < {}", "{}{}")
    with_coherence, two_lines, unit_row = chance(random, 0.7), chance(random, 0.3), chance(random, 0.3)
    frequency = f * scale
    heads, units, columns = [["frequency", ""]], [hz or ""], [[repr(float(v)) for v in frequency]]
    pairs: dict[str, tuple[str, str]] = {}
    for i, sensor in enumerate(sensors):
        for j, point in enumerate(points):
            name, z = named.format(sensor, point), values[:, i, j]
            pairs[name] = (sensor, point)
            if form == "complex":
                heads.append([name, ""])
                units.append(unit or "")
                columns.append([_complex_text(complex(v), comma, style) for v in z])
            else:
                size, second = np.abs(z), unit or ""
                angle = np.angle(z) if form == "rad" else np.rad2deg(np.angle(z))
                if form == "dB":
                    size, unit_of_size = 20.0 * np.log10(size), f"dB re 1 {unit}" if unit else "dB"
                else:
                    unit_of_size = unit or ""
                if form != "parts":
                    second = {"no unit": ""}.get(form, "deg" if form == "dB" else form)
                parts = (z.real, z.imag) if form == "parts" else (size, angle)
                heads += [[name, word] for word in words]
                units += [unit_of_size, second]
                columns += [[_number(float(v), ".17g", comma) for v in part] for part in parts]
            if with_coherence:
                heads.append([name, "coherence"])
                units.append("")
                columns.append([_number(float(v), ".17g", comma) for v in coherence[:, i, j]])
    if comma:
        columns[0] = [cell.replace(".", ",") for cell in columns[0]]
    if not unit_row:
        at = 0 if not two_lines or form == "complex" else 1
        for head, expected in zip(heads[1:], units[1:], strict=True):
            head[at] += f" [{expected}]" if expected else ""
        heads[0][0] += f" [{hz}]" if hz else ""
    lines = [[" ".join(part for part in head if part) for head in heads]]
    if two_lines and form != "complex":
        lines = [[head[0] for head in heads], [head[1] for head in heads]]
    rows = [*lines, *([units] if unit_row and any(units) else []), *map(list, zip(*columns, strict=True))]
    path = folder / "wide.csv"
    path.write_text(_written(rows, separator, quoted), encoding="utf-8")
    stated = named == "{}{}" and (len(pairs) == 1 or chance(random, 0.8))
    ask = {"hints": Hints(pairs=pairs)} if stated else {}
    return path, Responses(
        f,
        by_pair(values, sensors, points, factor),
        by_pair(coherence, sensors, points) if with_coherence else None,
        factor if unit else None,
        precision=1e-9,
        ask=ask,
    )
