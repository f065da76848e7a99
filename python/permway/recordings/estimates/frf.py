"""Frequency response functions with coherence and variance, from segments or blows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np
import xarray as xr

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.recordings.estimates.checks import attribute, check_positive, variable

Estimator = Literal["H1", "H2", "Hv"]

_DEAD = 1e-24
"""Share of a reference's greatest power below which a line holds rounding only."""

_SINGULAR = 1e-10
"""Reciprocal condition of the references' coherency matrix below which they cannot be distinguished."""


def frequency_response(
    spectra: xr.Dataset,
    *,
    references: Sequence[str],
    responses: Sequence[str] | None = None,
    estimator: Estimator = "H1",
    noise_ratio: float | None = None,
) -> xr.Dataset:
    """Frequency response functions between channels of a cross-spectral matrix.

    H1 = S_yx S_xx^-1: noise in the responses only; H2 = S_yy / S_xy: noise in the reference only; Hv: total
    least squares, noise in both in a given ratio (Bendat and Piersol 2010, chapters 6, 7 and 9; Rocklin,
    Crowley and Vold 1985; Leclere et al. 2012). The variance is that of ln|H|, and of the phase in rad, each:
    for one reference (1 - g2) / (2 (K - 1) g2), which is each estimator's own under its own assumption; for q
    references [S_xx^-1]_jj S_yy.x / (2 (K - q) |H_j|^2). For Hv with several references it is of first order
    only.

    Parameters
    ----------
    spectra : xarray.Dataset
        Of :func:`permway.recordings.estimates.welch.cross_spectra` or
        :func:`permway.recordings.estimates.blows.blow_spectra`.
    references, responses : sequence of str
        Names of channels; by default every channel that is no reference responds.
    estimator : "H1", "H2" or "Hv"
    noise_ratio : float
        For Hv, which needs it: noise of the responses over noise of the references, as densities, in their units.

    Returns
    -------
    xarray.Dataset
        `frf` (response, reference, frequency), complex; `variance`, the same shape; `coherence`
        (response, frequency), multiple for several references; `degrees_of_freedom` 2 (K - q). Lines at which a
        reference has no power or depends on the others are not `usable`: NaN, infinite variance, no coherence.

    Raises
    ------
    InputError
        For unknown channels, too few averages, references dead or dependent at every line.
    """
    if estimator not in get_args(Estimator):
        raise InputError("unknown", where="estimator", value=estimator, remedy=f"use one of {get_args(Estimator)}")
    csd = variable(spectra, "csd", "spectra")
    names = [str(name) for name in csd["channel"].values]
    inputs = _known(references, names, "references")
    others = [name for index, name in enumerate(names) if index not in inputs]
    outputs = _known(others if responses is None else responses, names, "responses")
    if len(inputs) > 1 and estimator == "H2":
        raise InputError("takes one reference", where="estimator", value="H2", remedy='use "H1" or "Hv"')
    averages = attribute(spectra, "averages", "spectra")
    free = averages - len(inputs)
    if free <= 0.0:
        raise InputError(
            f"{averages:.3g} average(s) leave no freedom for {len(inputs)} reference(s)",
            where="spectra",
            remedy="shorten the segments, or take more blows",
        )
    matrix: Complexes = csd.transpose("frequency", "channel", "channel2").values
    s_xx, s_yx = matrix[:, inputs][:, :, inputs], matrix[:, outputs][:, :, inputs]
    power: Reals = np.stack([matrix[:, index, index].real for index in outputs], axis=1)
    inverse, known = _inverse(s_xx)
    first: Complexes = s_yx @ inverse
    explained = np.einsum("fyx,fyx->fy", first, s_yx.conj()).real
    coherence = np.divide(explained, power, out=np.zeros_like(power), where=power > 0.0).clip(0.0, 1.0)
    left = np.maximum(power - explained, 0.0)
    frf = first
    if estimator == "H2":
        some = coherence[:, :, None] > 0.0
        frf = np.divide(first, coherence[:, :, None], out=np.full_like(first, np.nan), where=some)
    elif estimator == "Hv":
        if noise_ratio is None:
            raise InputError(
                "Hv needs the noise of the responses over that of the references",
                where="noise_ratio",
                remedy="give the ratio of their densities, in the channels' units",
            )
        frf = _total_least_squares(matrix, inputs, outputs, check_positive(noise_ratio, "noise_ratio"))
    spread = np.einsum("fxx->fx", inverse).real[:, None, :] * left[:, :, None] / (2.0 * free)
    square = np.abs(first) ** 2
    variance = np.divide(spread, square, out=np.full(square.shape, np.inf), where=square > 0.0)
    frf, variance = np.where(known[:, None, None], frf, np.nan), np.where(known[:, None, None], variance, np.inf)
    coherence = np.where(known[:, None], coherence, 0.0)
    return _dataset(
        spectra,
        frf,
        variance,
        coherence,
        [names[i] for i in outputs],
        [names[i] for i in inputs],
        free,
        estimator,
        known,
    )


def _known(chosen: Sequence[str], names: list[str], where: str) -> list[int]:
    wanted = [chosen] if isinstance(chosen, str) else [str(name) for name in chosen]
    if not wanted:
        raise InputError("names no channel", where=where, remedy=f"choose from {names}")
    for name in wanted:
        if name not in names:
            raise InputError("unknown channel", where=where, value=name, remedy=f"choose from {names}")
    return [names.index(name) for name in wanted]


def _inverse(s_xx: Complexes) -> tuple[Complexes, np.ndarray[tuple[int], np.dtype[np.bool_]]]:
    """Inverse at each line, and at which lines there is one: no reference dead or dependent."""
    power = np.einsum("fxx->fx", s_xx).real
    live = (power > _DEAD * power.max(axis=0)).all(axis=1)
    size = np.sqrt(np.where(live[:, None], power, 1.0))
    scale = size[:, :, None] * size[:, None, :]
    unit = np.where(live[:, None, None], s_xx / scale, np.eye(s_xx.shape[1]))
    worst = np.linalg.eigvalsh(unit)[:, 0] / s_xx.shape[1]
    known = live & (worst > _SINGULAR)
    if not known.any():
        raise InputError(
            "a reference without power, or references that depend on one another, at every line",
            where="references",
            value=f"smallest eigenvalue {worst[live].max(initial=0.0):.2g}",
            remedy="take other or fewer references, or more averages",
        )
    unit[~known] = np.eye(s_xx.shape[1])
    return np.asarray(np.linalg.inv(unit) / scale), known


def _total_least_squares(matrix: Complexes, inputs: list[int], outputs: list[int], ratio: float) -> Complexes:
    """For each response, the direction of least power in (references, response / sqrt(ratio)).

    That direction v has v^H (x, y) = 0 up to noise, so that y = -sum conj(v_x) x / conj(v_y).
    """
    answer = np.empty((matrix.shape[0], len(outputs), len(inputs)), dtype=np.complex128)
    for row, output in enumerate(outputs):
        chosen = [*inputs, output]
        part = matrix[:, chosen][:, :, chosen].copy()
        part[:, -1, :] /= np.sqrt(ratio)
        part[:, :, -1] /= np.sqrt(ratio)
        least = np.linalg.eigh(part)[1][:, :, 0].conj()
        answer[:, row] = -np.sqrt(ratio) * least[:, :-1] / least[:, -1:]
    return answer


def _dataset(
    spectra: xr.Dataset,
    frf: Complexes,
    variance: Reals,
    coherence: Reals,
    responses: list[str],
    references: list[str],
    free: float,
    estimator: Estimator,
    known: np.ndarray[tuple[int], np.dtype[np.bool_]],
) -> xr.Dataset:
    dims = ("response", "reference", "frequency")
    units = dict(zip(spectra["channel"].values.tolist(), spectra["unit"].values.tolist(), strict=True))
    # A line that is real, or meets its mirror image, has as much less freedom as its power has.
    share = spectra["degrees_of_freedom"].values / (2.0 * spectra.attrs["averages"])
    return xr.Dataset(
        {
            "frf": (
                dims,
                frf.transpose(1, 2, 0),
                {"long_name": "frequency response function", "units": "unit/unit2"},
            ),
            "variance": (
                dims,
                variance.transpose(1, 2, 0),
                {"long_name": "variance of the logarithm of the modulus, and of the phase in rad", "units": "1"},
            ),
            "coherence": (("response", "frequency"), coherence.T, {"long_name": "coherence", "units": "1"}),
            "degrees_of_freedom": (
                "frequency",
                2.0 * free * share,
                {"long_name": "degrees of freedom of the variance", "units": "1"},
            ),
            "line_covariance": spectra["line_covariance"],
        },
        coords={
            "response": responses,
            "reference": references,
            "frequency": spectra["frequency"],
            "usable": spectra["usable"] & known,
            "response_unit": ("response", [units[name] for name in responses]),
            "reference_unit": ("reference", [units[name] for name in references]),
        },
        attrs={**spectra.attrs, "estimator": estimator, "references": len(references)},
    )
