"""From a DMA table on disk to a law on disk, with pictures: what `permway fit-pad` does."""

from __future__ import annotations

import io
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from permway.errors import InputError
from permway.files import prepare_folder, write_bytes
from permway.laws.compare import CANDIDATES, Comparison, compare_laws
from permway.laws.dma import DmaTable, read_dma
from permway.laws.identify import Identification, identify
from permway.laws.lawfile import save_law
from permway.laws.overlay import overlay
from permway.laws.pictures import master_curve, residuals, shift_factors, surfaces
from permway.laws.search import Progress
from permway.laws.tfdv import TFDV

COMPARE = "compare"
_SHIFTS = ("wlf", "arrhenius", "wlf_arrhenius")
_ROOM_C = 20.0
_ONE_TEMPERATURE_K = 5.0
_APART_DECADES = 0.1
"""Law and overlay differ: half is what 2 % of scatter makes, twice moves a resonance by a third of an octave."""
_DPI = 200


def fit_table(
    dma: str | Path,
    *,
    output: str | Path,
    law: str = COMPARE,
    shift: str = "wlf",
    reference_temperature_C: float | None = None,
    vertical: str = "none",
    seed: int = 0,
    pictures: str | Path | None = None,
    frequency_Hz: float | None = None,
    temperature_C: float | None = None,
    decimal: str | None = None,
    shape_factor_m: float | None = None,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Read a DMA table, identify a law and its shift, and write LAW.toml.

    Parameters
    ----------
    dma : path
        Table, see :func:`permway.laws.dma.read_dma`.
    output : path
        Law to write, see :func:`permway.laws.lawfile.save_law`.
    law : str
        A family, or "compare" to try all candidates and keep the one with the lowest BIC.
    shift : {"wlf", "arrhenius", "wlf_arrhenius", "compare", "free", "none"}
        "compare" tries the first three and keeps the one with the lowest BIC. Not used for a table of one
        temperature, which has nothing to shift; the answer's notes then say so.
    reference_temperature_C : float, optional
        By default 20 degrees Celsius, or the isotherm of the table nearest to it where 20 lies outside.
    vertical, seed
        As for :func:`permway.laws.identify.identify`.
    pictures : path, optional
        Folder for master_curve.png, shift.png, surfaces.png and residuals.png; made if it does not exist.
    frequency_Hz, temperature_C, decimal, shape_factor_m
        As for :func:`permway.laws.dma.read_dma`.
    progress : callable, optional
        Called with the steps done and the steps in all.

    Returns
    -------
    dict
        Plain values: file written, errors, parameters with 90 % intervals, comparison, check, notes.

    Raises
    ------
    InputError
        For a table, a law or a path that cannot be used; nothing is written then.
    """
    table = read_dma(
        dma,
        frequency_Hz=frequency_Hz,
        temperature_C=temperature_C,
        decimal=decimal,
        shape_factor_m=shape_factor_m,
    )
    if pictures is not None:
        prepare_folder(Path(pictures))
    notes: tuple[str, ...] = ()
    if shift != "none" and _one_temperature(table):
        notes = (f"the table holds one temperature, so no shift was identified ({shift} asked for)",)
        shift = "none"
    shifts = _SHIFTS if shift == COMPARE else (shift,)
    reference = None if shift == "none" else _reference(table, reference_temperature_C)
    comparison: Comparison | None = None
    if law == COMPARE:
        # A family with more numbers than the table can support is no candidate.
        laws = [name for name in CANDIDATES if all(_affordable(name, table, each) for each in shifts)]
        if not laws:
            raise InputError(
                f"{len(table)} rows cannot determine any of the laws",
                where=str(dma),
                remedy="measure at more frequencies or temperatures",
            )
    else:
        laws = [law]
    if law == COMPARE or len(shifts) > 1:
        comparison = compare_laws(
            table,
            laws=laws,
            shifts=shifts,
            reference_temperature_C=reference,
            vertical=vertical,
            seed=seed,
            progress=progress,
        )
        found = comparison.best
    else:
        found = identify(
            table,
            law=law,
            shift=shifts[0],
            reference_temperature_C=reference,
            vertical=vertical,
            seed=seed,
            progress=progress,
        )
    save_law(output, found)
    drawn = [] if pictures is None else _draw(found, Path(pictures))
    return _answer(found, comparison, output=Path(output), drawn=drawn, notes=notes)


def _reference(table: DmaTable, given: float | None) -> float:
    nodes = table.isotherms()
    if given is not None or not len(nodes):
        return _ROOM_C if given is None else given
    return _ROOM_C if nodes[0] <= _ROOM_C <= nodes[-1] else float(nodes[np.abs(nodes - _ROOM_C).argmin()])


def _one_temperature(table: DmaTable) -> bool:
    if table.temperature_C is None:
        return True
    return float(table.temperature_C.max() - table.temperature_C.min()) <= _ONE_TEMPERATURE_K


def _affordable(name: str, table: DmaTable, shift: str) -> bool:
    numbers = {"springpot_parallel": 3, "zener": 3, "fractional_zener": 4, "maxwell:2": 4}.get(name, 7)
    extra = {"none": 0, "arrhenius": 1, "wlf": 2, "wlf_arrhenius": 4}.get(shift, len(table.isotherms()) - 1)
    return 2 * len(table) > numbers + extra


def _draw(found: Identification, folder: Path) -> list[str]:
    figures = {"master_curve": master_curve, "residuals": residuals}
    if found.shift != "none":
        figures |= {"shift": shift_factors, "surfaces": surfaces}
    written = []
    for name, draw in figures.items():
        path = folder / f"{name}.png"
        buffer = io.BytesIO()
        draw(found).savefig(buffer, format="png", dpi=_DPI)
        written.append(str(write_bytes(path, buffer.getvalue())))
    return written


def _answer(
    found: Identification,
    comparison: Comparison | None,
    *,
    output: Path,
    drawn: list[str],
    notes: tuple[str, ...],
) -> dict[str, Any]:
    frequency = found.table.frequency_Hz
    band = float(frequency.min()), float(frequency.max())
    answer: dict[str, Any] = {
        "law_file": str(output),
        "law": found.family,
        "quantity": "stiffness of the part, N/m" if found.table.quantity == "stiffness" else "modulus, Pa",
        "shift": found.shift,
        "reference_temperature_C": found.reference_temperature_C,
        "rows": found.n_rows,
        "rms_log10_modulus": found.rms_log10_modulus,
        "rms_loss_factor": found.rms_loss_factor,
        "bic": found.bic,
        "seed": found.seed,
        "parameters": [asdict(parameter) for parameter in found.parameters],
    }
    if band[0] < band[1]:
        check = found.law.check(band, found.reference_temperature_C)
        answer["check"] = {
            "band_Hz": list(band),
            "passive": check.passive,
            "causal": check.causal,
            "reasons": list(check.reasons),
            "caveats": list(check.caveats),
        }
    if comparison is not None:
        answer["comparison"] = comparison.table()
    if drawn:
        answer["pictures"] = drawn
    steps, apart = _overlaid(found)
    if steps:
        answer["overlay"] = steps
    answer["notes"] = [*notes, *apart, *found.notes]
    return answer


def _overlaid(found: Identification) -> tuple[list[dict[str, Any]], tuple[str, ...]]:
    """Shifts between neighbouring temperatures without a law, beside the law's; and where the two differ."""
    law = found.law
    if not isinstance(law, TFDV):
        return [], ()
    frequency = found.table.frequency_Hz
    if np.ptp(frequency) <= 1e-3 * frequency[0]:
        note = (
            f"all rows are at {frequency[0]:g} Hz: temperatures cannot be laid over each other, and how far one "
            "shifts the law is seen only together with how it goes over frequency; measure at several frequencies"
        )
        return [], (note,)
    steps, apart = [], []
    for step in overlay(found.table).steps:
        own = float(law.log10_shift(step.cold_C) - law.log10_shift(step.warm_C))
        steps.append(
            {
                "from_C": step.cold_C,
                "to_C": step.warm_C,
                "overlay_decades": step.decades,
                "standard_error": None if step.decades is None else step.error,
                "law_decades": own,
                "note": step.why,
            }
        )
        if step.decades is not None and abs(step.decades - own) > max(_APART_DECADES, 3.0 * step.error):
            apart.append(f"{step.cold_C:.1f} to {step.warm_C:.1f} degC")
    if not apart:
        return steps, ()
    note = f"law and overlay differ by more than {_APART_DECADES:g} decades from {', '.join(apart)}: "
    return steps, (note + "the curves do not fall on one, or the law misfits; look at the master curve",)
