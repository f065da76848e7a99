"""From a DMA table on disk to a law on disk, with pictures: what `permway fit-pad` does."""

from __future__ import annotations

import io
from dataclasses import asdict
from pathlib import Path
from typing import Any

from permway.files import prepare_folder, write_bytes
from permway.laws.compare import CANDIDATES, Comparison, compare_laws
from permway.laws.dma import DmaTable, read_dma
from permway.laws.identify import Identification, identify
from permway.laws.lawfile import save_law
from permway.laws.pictures import master_curve, residuals, shift_factors, surfaces
from permway.laws.search import Progress

COMPARE = "compare"
_ONE_TEMPERATURE_K = 5.0
_DPI = 200


def fit_table(
    dma: str | Path,
    *,
    output: str | Path,
    law: str = COMPARE,
    shift: str = "wlf",
    reference_temperature_C: float | None = 20.0,
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
    shift : {"wlf", "arrhenius", "free", "none"}
        Not used for a table of one temperature, which has nothing to shift; the answer's notes then say so.
    reference_temperature_C, vertical, seed
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
    reference = None if shift == "none" else reference_temperature_C
    comparison: Comparison | None = None
    if law == COMPARE:
        # A family with more numbers than the table can tell is no candidate.
        laws = [name for name in CANDIDATES if _affordable(name, table, shift)]
        comparison = compare_laws(
            table,
            laws=laws,
            shifts=(shift,),
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
            shift=shift,
            reference_temperature_C=reference,
            vertical=vertical,
            seed=seed,
            progress=progress,
        )
    save_law(output, found)
    drawn = [] if pictures is None else _draw(found, Path(pictures))
    return _answer(found, comparison, output=Path(output), drawn=drawn, notes=notes)


def _one_temperature(table: DmaTable) -> bool:
    if table.temperature_C is None:
        return True
    return float(table.temperature_C.max() - table.temperature_C.min()) <= _ONE_TEMPERATURE_K


def _affordable(name: str, table: DmaTable, shift: str) -> bool:
    numbers = {"springpot_parallel": 3, "zener": 3, "fractional_zener": 4, "maxwell:2": 4}.get(name, 7)
    extra = {"none": 0, "arrhenius": 1, "wlf": 2}.get(shift, len(table.isotherms()) - 1)
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
    answer["notes"] = [*notes, *found.notes]
    return answer
