"""Identification of a law and its shift factor from a DMA table.

Storage and loss are fitted at once, as the complex logarithm of the modulus: its real part is the relative
error of the modulus, its imaginary part the error of the phase, both dimensionless and of one size. The
paper fits the two apart, which gives no material (see `StorageLossPair`). A seeded differential evolution
(an evolutionary search with real coding) finds the valleys, a least squares over both sets of residuals
their bottoms, and the Jacobian there the intervals.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from permway.arrays import ABSOLUTE_ZERO_C, Reals, is_real
from permway.errors import InputError
from permway.laws.base import Law
from permway.laws.dma import DmaTable
from permway.laws.families import Scales, family
from permway.laws.intervals import Parameter, parameter_table
from permway.laws.search import STEPS, Problem, Progress, SearchResult, nodes_of, search
from permway.laws.shift_fit import ShiftFamily, middle, shift_family
from permway.laws.tfdv import TFDV


@dataclass(frozen=True, kw_only=True)
class Identification:
    """A law identified from a table.

    Attributes
    ----------
    law : Law
        The law; a `TFDV` if a shift was identified with it.
    family, shift : str
        As asked for.
    reference_temperature_C : float or None
        Of the shift.
    parameters : tuple of Parameter
        Of law and shift.
    log10_storage_error : ndarray, shape (n,)
        Law minus table, decades of storage modulus.
    loss_factor_error : ndarray, shape (n,)
        Law minus table.
    rms_log10_modulus, rms_loss_factor : float
        Root mean squares of these.
    n_parameters, n_rows : int
        Free numbers of law and shift; rows of the table.
    aic, bic : float
        Over both residual sets, for one common variance.
    seed, evaluations : int
        Of the search.
    table : DmaTable
        What it was identified from.
    notes : tuple of str
        What to know of the intervals.
    """

    law: Law
    family: str
    shift: str
    reference_temperature_C: float | None
    parameters: tuple[Parameter, ...]
    log10_storage_error: Reals
    loss_factor_error: Reals
    rms_log10_modulus: float
    rms_loss_factor: float
    n_parameters: int
    n_rows: int
    aic: float
    bic: float
    seed: int
    evaluations: int
    table: DmaTable
    notes: tuple[str, ...]


def identify(
    table: DmaTable,
    *,
    law: str = "fractional_zener",
    shift: str = "wlf",
    reference_temperature_C: float | None = None,
    vertical: str = "none",
    seed: int = 0,
    weights: tuple[float, float] = (1.0, 1.0),
    progress: Progress | None = None,
) -> Identification:
    """Identify a law and its shift factor.

    Parameters
    ----------
    table : DmaTable
        Frequency sweeps, temperature sweeps, or both.
    law : str
        A family, see :func:`permway.laws.families.family`.
    shift : {"none", "wlf", "arrhenius", "wlf_arrhenius", "free"}
        A free shift has one number per isotherm but one.
    reference_temperature_C : float, optional
        Needed with a shift. The law's parameters are written for it; what the law states at any temperature does
        not depend on it.
    vertical : {"none", "paper"}
        Vertical factor, see :class:`permway.laws.TFDV`.
    seed : int
        Of the evolutionary search; the same seed gives the same answer.
    weights : (float, float)
        Of the errors of log modulus and of phase.
    progress : callable, optional
        Called with the steps done and the steps in all.

    Returns
    -------
    Identification
        With 90 % intervals.

    Raises
    ------
    InputError
        For a table with too few rows, an unknown family, a shift without temperatures or reference.
    """
    problem = _pose(table, law, shift, reference_temperature_C, vertical, weights)
    found = search(problem, table, seed, progress)
    if progress is not None:
        progress(STEPS, STEPS)
    return _report(problem, table, found, reference_temperature_C, vertical, seed)


def _pose(
    table: DmaTable,
    law: str,
    shift: str,
    reference_C: float | None,
    vertical: str,
    weights: tuple[float, float],
) -> Problem:
    if vertical not in ("none", "paper"):
        raise InputError("not a vertical factor", where="vertical", value=vertical, remedy='use "none" or "paper"')
    if not (len(weights) == 2 and all(is_real(w) and np.isfinite(w) and w > 0.0 for w in weights)):
        raise InputError("two finite weights above zero are needed", where="weights", value=weights)
    if shift != "none" and reference_C is None:
        raise InputError(
            "a shift needs a reference temperature",
            where="reference_temperature_C",
            remedy="give degrees Celsius",
        )
    chosen = family(law)
    temperature = table.temperature_C
    shifted = shift_family(shift, temperature, nodes_of(table), reference_C)
    if shift == "none" and temperature is not None and np.ptp(temperature) > 5.0:
        raise InputError(
            f"the table spans {np.ptp(temperature):.3g} K but no shift is to be identified",
            where="shift",
            value=shift,
            remedy='use "wlf", "arrhenius", "wlf_arrhenius" or "free", or a table of one temperature',
        )
    lg_frequency = np.log10(table.frequency_Hz)
    scales = _scales(table, shifted)
    bounds = np.array(chosen.bounds(scales) + shifted.bounds)
    if 2 * len(table) <= len(bounds):
        raise InputError(
            f"{len(table)} rows cannot determine {len(bounds)} parameters",
            where="table",
            remedy="measure more rows",
        )
    factor, lg_scale = np.ones(len(table)), 0.0
    if vertical == "paper" and shift != "none" and temperature is not None and reference_C is not None:
        factor = (temperature - ABSOLUTE_ZERO_C) / (middle(temperature) - ABSOLUTE_ZERO_C)
        lg_scale = float(np.log10((reference_C - ABSOLUTE_ZERO_C) / (middle(temperature) - ABSOLUTE_ZERO_C)))
    measured = np.log(table.modulus)
    return Problem(
        law=chosen,
        shift=shifted,
        bounds=bounds,
        log_frequency=lg_frequency,
        vertical=factor,
        target=np.concatenate([measured.real, measured.imag]),
        weights=np.repeat(np.asarray(weights, dtype=np.float64), len(table)),
        lg_scale=lg_scale,
    )


def _scales(table: DmaTable, shifted: ShiftFamily) -> Scales:
    lg_modulus = np.log10(np.abs(table.modulus))
    lg_omega = np.log10(2.0 * np.pi * table.frequency_Hz)
    # How far a shift will stretch the axis is not known yet; the bounds need only be wide enough.
    stretch = 3.0 if shifted.bounds else 0.0
    return Scales(
        float(lg_modulus.min()),
        float(lg_modulus.max()),
        float(lg_omega.min()) - stretch,
        float(lg_omega.max()) + stretch,
    )


def _report(
    problem: Problem,
    table: DmaTable,
    found: SearchResult,
    reference_C: float | None,
    vertical: str,
    seed: int,
) -> Identification:
    x = found.x
    own = len(x) - len(problem.shift.bounds)
    law = problem.law.law(problem.at_reference(x))
    shift = problem.shift.shift(x[own:])
    if shift is not None and reference_C is not None:
        law = TFDV.model_validate(
            {"law": law, "shift": shift, "reference_temperature_C": reference_C, "vertical": vertical}
        )
    fitted = law.complex(table.frequency_Hz, table.temperature_C)
    storage_error = np.log10(fitted.real / table.storage_Pa)
    loss_error = fitted.imag / fitted.real - table.loss_factor
    count = 2 * len(table)
    square = float(np.sum(problem.residuals(x) ** 2))
    likelihood = count * np.log(max(square, np.finfo(float).tiny) / count)
    return Identification(
        law=law,
        family=problem.law.name,
        shift=problem.shift.name,
        reference_temperature_C=reference_C if shift is not None else None,
        parameters=parameter_table(problem, x, found.jacobian, square),
        log10_storage_error=storage_error,
        loss_factor_error=loss_error,
        rms_log10_modulus=float(np.sqrt(np.mean(storage_error**2))),
        rms_loss_factor=float(np.sqrt(np.mean(loss_error**2))),
        n_parameters=len(x),
        n_rows=len(table),
        aic=float(likelihood + 2.0 * len(x)),
        bic=float(likelihood + len(x) * np.log(count)),
        seed=seed,
        evaluations=found.evaluations,
        table=table,
        notes=(
            "intervals take the residuals as independent and the law as true; where the law misfits smoothly "
            "they are too narrow",
            f"{found.agreeing} of {found.starts} local finishes ended in this optimum",
            *table.notes,
        ),
    )
