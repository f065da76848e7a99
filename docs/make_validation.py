"""Writes docs/validation.md: printed values of the literature beside computed ones.

`python docs/make_validation.py` computes the cases by the functions of tests/literature. With `--paper TABLES`,
the `tables.json` of `permway reproduce`, the paper's tables are written anew too; without it they are kept.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT / "tests"), str(ROOT / "tests" / "literature")]

PAGE = Path(__file__).parent / "validation.md"
PAPER = "## The paper's tables"

HEAD = """# Validation

Written by `python docs/make_validation.py` from the cases of `tests/literature`; a test holds the cheap
rows against what is computed.
*Ratio* is computed over printed. Where it is not 1 to the digits printed, the last column says what is known.

```{rst-class} remarks
```

| case | quantity | unit | printed | computed | ratio | source, remark |
|---|---|---|---:|---:|---:|---|
"""


@dataclass(frozen=True)
class Case:
    """A printed value and ours; `printed` as the source has it."""

    case: str
    quantity: str
    unit: str
    printed: str
    ours: float
    source: str

    def row(self) -> str:
        """Of the table: two digits more than printed."""
        digits = len(self.printed.split("e")[0].replace(".", "").replace("-", "").lstrip("0"))
        ours = f"{self.ours:.{digits + 2}g}"
        ratio = self.ours / float(self.printed)
        cells = (self.case, self.quantity, self.unit, self.printed, ours, f"{ratio:.{digits + 1}f}", self.source)
        return "| " + " | ".join(cells) + " |"


def beams() -> Iterator[Case]:
    """Girder, free slab, natural frequencies."""
    import test_beams as b

    form = "closed form"
    for f, printed in (("1", "1.668317e-9"), ("5.72", "1.603321e-8"), ("50", "1.648455e-10")):
        value = b.respond(b.alone(b.GIRDER), [float(f)], 16.25, formulation="chain")[0, 0]
        yield Case(
            "simply supported girder", f"receptance at its middle, {f} Hz", "m/N", printed, abs(value), form
        )
    for f, printed in (("10", "7.160116e-8"), ("200", "1.603340e-9")):
        value = b.respond(b.alone(b.SLAB), [float(f)], 0.0, formulation="chain")[0, 0]
        yield Case("free slab", f"receptance at its tip, {f} Hz", "m/N", printed, abs(value), form)
    for number, printed in enumerate(("18.752", "51.691", "101.335"), 1):
        lossless = b.alone(b.SLAB.model_copy(update={"loss_factor": 1e-6}))
        value = resonance(lambda f, line=lossless: b.respond(line, [f], 0.0, formulation="chain")[0, 0], printed)
        yield Case("free slab", f"natural frequency {number}", "Hz", printed, value, form)
    zeng = "Zeng et al., Shock and Vibration 2014, 304219"
    for number, printed in enumerate(("5.72", "22.89"), 1):
        lossless = b.alone(b.GIRDER.model_copy(update={"loss_factor": 1e-6}))
        value = resonance(
            lambda f, line=lossless: b.respond(line, [f], 32.5 / 4, formulation="chain")[0, 0], printed
        )
        remark = "; the second is four times the first, so the print is 0.01 high" if number == 2 else ""
        yield Case("girder of nine spans", f"natural frequency {number}", "Hz", printed, value, zeng + remark)


def resonance(response, printed: str) -> float:
    """Where a lossless body no longer resists, near a printed frequency."""
    middle = float(printed)
    return brentq(lambda f: (1.0 / response(f)).real, 0.97 * middle, 1.03 * middle)


def rail() -> Iterator[Case]:
    """UIC60: pinned-pinned, on a bed, on 241 supports."""
    import test_uic60_track as u
    from lines import hysteretic, supported, uic60
    from permway.model.line import Line

    knothe = "Timoshenko 1921; Knothe and Grassie 1993"
    for bay, *printed in u.PINNED_PINNED:
        for theory, value in zip(("timoshenko", "euler"), printed, strict=True):
            span = uic60(theory=theory, loss_factor=1e-6).model_copy(
                update={"intervals_m": ((-bay / 2, bay / 2),), "ends": "pinned"}
            )
            line = Line(bodies={"rail": span}, joints=(), laws={})
            found = resonance(lambda f, line=line: u.respond(line, [f])[0, 0], f"{value:.2f}")
            yield Case(
                "UIC60 between two pins",
                f"bay of {bay:g} m, {theory.capitalize()}",
                "Hz",
                f"{value:.2f}",
                found,
                knothe,
            )
    values, exponents = u.winkler(u.WINKLER_HZ)
    decay = 8.686 * np.abs(exponents.real).min(axis=0)
    for (f, printed, rate), value, own in zip(u.WINKLER, values, decay, strict=True):
        text = f"{abs(printed):.9e}"
        name = "UIC60 on a bed"
        yield Case(
            name, f"receptance, {f:g} Hz", "m/N", text, abs(value), "closed form; the solver meets it to 1e-7"
        )
        yield Case(name, f"decay of the slower wave, {f:g} Hz", "dB/m", f"{rate:.4f}", own, "closed form")
    grid = np.linspace(20.0, 3000.0, 1500)[[row[0] for row in u.SUPPORTS]]
    for kg, column, name in ((None, 2, "pads"), (162.0, 3, "pads, sleepers, ballast")):
        track = supported(
            uic60(loss_factor=0.02),
            count=241,
            spacing_m=0.6,
            pad=hysteretic(u.BED),
            ballast=hysteretic(50e6 * (1 + 1j)),
            sleeper_kg=kg,
        )
        found = 2 * np.pi * grid * np.abs(u.respond(track, grid)[:, 0])
        for row, value in zip(u.SUPPORTS, found, strict=True):
            printed = f"{row[column]:.8e}"
            what = f"mobility, {row[1]:g} Hz"
            yield Case(
                f"UIC60 on 241 supports, {name}", what, "m/s/N", printed, value, "benchmark of rolland, TU Berlin"
            )


def vehicles() -> Iterator[Case]:
    """Natural frequencies, and the paper's Table 6 with simple tracks."""
    import test_vehicle_frequencies as v

    trailer = v.zeng2014_trailer().natural_frequencies_Hz(on_contact=np.inf)
    zeng = "Zeng et al. 2014"
    names = ("body bounce", "body pitch", "bogie bounce", "bogie pitch")
    for name, index, printed in zip(names, (0, 1, 2, 4), ("0.75", "0.84", "6.00", "7.10"), strict=True):
        remark = "; from the printed half distance 8.6875 m, rounded 8.75 would give 0.841" if index == 1 else ""
        yield Case("trailer", name, "Hz", printed, trailer[index], zeng + remark)
    found = v.manchester_vehicle_1().natural_frequencies_Hz(on_contact=np.inf)
    for number, printed in enumerate(("1.0725", "1.2973", "7.4187", "7.4255", "11.6174", "11.6174")):
        yield Case(
            "Manchester vehicle 1", f"mode {number + 1}", "Hz", printed, found[number], "Manchester benchmarks"
        )
    rows = ((1.0, 0, "0.40840"), (5.0, 0, "0.06800"), (1.0, 1, "0.01041"), (7.0, 1, "0.00081"))
    for f, degree, printed in rows:
        value = v.body_acceleration(v.crh380a(share=0.5), np.array([f]), v.simple_track)[0, degree]
        what = f"{('body bounce', 'body pitch')[degree]}, {f:g} Hz"
        yield Case(
            "CRH380A on a simple track",
            what,
            "(m/s2)2/Hz",
            printed,
            value,
            "the paper's Table 6, in its conventions",
        )


def moving() -> Iterator[Case]:
    """Forces, masses and a train that move over a beam."""
    import test_moving_loads as m
    from permway.model.place import Place
    from permway.response.passby import Axles, MassOnSpring, couple, hslm_a, passby
    from scipy.interpolate import CubicSpline

    def force(eta: float) -> float:
        axles = Axles(lags_m=(0.0,), loads_N=(5750 * m.G,), speed_m_per_s=25.0, body="beam")
        line = m.bridge(3.5e10, 1.3901, 18358.0, eta)
        options = {
            "highest_Hz": 150.0,
            "quantity": "displacement",
            "window_s": 1.4 / eta,
            "wraparound_limit": 0.05,
        }
        data = passby(line, axles, sensors=m.CENTRE, **options)
        return CubicSpline(data["time"], data["history"][0, 0])(0.438)

    fryba = "Fryba 1999; cut at 150 Hz"
    value = m.lossless(force, 0.02, 0.01, 0.005)
    yield Case("moving force", "midspan at 0.438 s", "m", "4.192782e-4", value, fryba)
    rows = (
        ("moving sprung mass", (3.5e10, 1.3901, 18358.0), 25.0, 0.436, "4.186e-4", "Fryba 1999"),
        ("moving sprung mass", (2.87e9, 2.90, 2303.0), 100 / 3.6, 0.371, "2.4073e-3", "Yang and Yau 1997"),
    )
    for name, beam, speed, time, printed, source in rows:

        def mass(eta: float, beam=beam, speed=speed, time=time) -> float:
            data = couple(
                m.bridge(*beam, eta),
                MassOnSpring(mass_kg=5750.0),
                speed_m_per_s=speed,
                contact_N_per_m=1.595e6,
                step_s=0.005,
                sensors=m.CENTRE,
                body="beam",
                window_s=1.0 / eta,
            )
            return CubicSpline(data["time"], data["displacement"][0])(time) * m.G / m.STANDARD_GRAVITY

        yield Case(name, f"midspan at {time:g} s", "m", printed, m.lossless(mass, 0.04, 0.02, 0.01), source)
    weight, length = 15e3, 15.0
    bending = weight * (2 * np.pi * 5.0 * (length / np.pi) ** 2) ** 2
    line = m.bridge(bending, 1.0, weight, 0.02, length=length, modes=1)
    data = passby(
        line,
        hslm_a(1, speed_m_per_s=325 / 3.6, body="beam"),
        sensors=[Place(body="beam", x_m=length / 2)],
        highest_Hz=120.0,
        quantity="acceleration",
        formulation="receptance",
    )
    remark = (
        "EN 1991-2; an independent equation of the first mode gives 53.6, and 54.8 only with a bogie more than "
        "the standard's train is taken to have"
    )
    peak = float(np.abs(data["history"]).max())
    yield Case("HSLM-A1 over 15 m, first mode", "largest acceleration, 325 km/h", "m/s2", "54.8", peak, remark)


def cases() -> list[Case]:
    """All."""
    return [*beams(), *rail(), *vehicles(), *moving()]


def paper(tables: dict) -> str:
    """The paper's tables from `permway reproduce`."""
    lines = [
        PAPER,
        "",
        "From `permway reproduce`, in the paper's conventions with the girder free on its bearings. *One law*:",
        "for all temperatures; *free*: the pad's stiffness identified at each. Table 8 is open: it contradicts",
        "tables 5 and 7.",
        "",
        "| table | quantity | °C | Hz | pad | unit | printed | computed | ratio | bar |",
        "|---|---|---:|---:|---|---|---:|---:|---:|---|",
    ]
    for row in tables["rows"]:
        if row["convention"] != "paper, free girder" or row["printed"] is None or row["computed"] is None:
            continue
        at = "" if row["at_Hz"] is None else f"{row['at_Hz']:g}"
        bar = f"{row['bar']}: {row['status']}" if row["bar"] else ""
        cells = [
            row["table"],
            row["quantity"].replace("_", " "),
            f"{row['temperature_C']}",
            at,
            row["pad"],
            row["unit"],
        ]
        cells += [f"{row['printed']:g}", f"{row['computed']:.4g}", f"{row['ratio']:.3f}", bar]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    if "--paper" in sys.argv:
        tail = paper(json.loads(Path(sys.argv[sys.argv.index("--paper") + 1]).read_text("utf-8")))
    else:
        text = PAGE.read_text("utf-8")
        tail = text[text.index(PAPER) :]
    PAGE.write_text(HEAD + "\n".join(case.row() for case in cases()) + "\n\n" + tail, "utf-8")
