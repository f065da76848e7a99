"""Predicted against measured, with the nominal values and recalibrated: all numbers, none of them drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.campaign.compare import NEPER_DB, POWER_DB, curves, flat, third_octaves
from permway.campaign.kinds import KINDS, kind_of
from permway.diagnosis.blocks_modes import missed_modes
from permway.diagnosis.compare_tables import calibration_of, parameters_of
from permway.diagnosis.fit import Fit, Free, free_parameters
from permway.diagnosis.observations import Observations, Solved
from permway.diagnosis.residuals import standardised
from permway.diagnosis.tangent import STEP

RAW, RECALIBRATED, CLEAN = "raw", "recalibrated", "calibration errors out"


@dataclass(frozen=True)
class Comparison:
    """A campaign's records beside what its model predicts of them.

    Attributes
    ----------
    campaign : Campaign
        With its nominal values.
    fit : Fit or None
        None if nothing was recalibrated.
    records : tuple of Dataset
        See :func:`permway.campaign.compare.curves`; beside that `predicted_dB` (model, channel, frequency), one
        standard deviation of the predicted level, by the priors for the raw model and what the records left of
        them for the recalibrated one.
    bands : tuple of Dataset
        Record by record, see :func:`permway.campaign.compare.third_octaves`.
    residuals : tuple of Dataset
        Record by record `z` (model, part, row, frequency): see :func:`permway.diagnosis.residuals.standardised`.
    parameters : Dataset
        By `parameter`.
    calibration : Dataset
        By `source`: the size of the calibration errors that were allowed.
    left_out : mapping of str to str
        Records that cannot be predicted, and why.
    """

    campaign: Campaign
    fit: Fit | None
    records: tuple[xr.Dataset, ...]
    bands: tuple[xr.Dataset, ...]
    residuals: tuple[xr.Dataset, ...]
    parameters: xr.Dataset
    calibration: xr.Dataset
    left_out: Mapping[str, str]

    @property
    def models(self) -> list[str]:
        """Names of the models that are beside each other."""
        return [RAW] if self.fit is None else [RAW, RECALIBRATED]

    def fits(self) -> list[dict[str, Any]]:
        """How well each model fits, by kind of record.

        Returns
        -------
        list of dict
            `kind`, `records`, `channels`; `noise_dB_rms`, what noise alone would leave of levels in one-third
            octaves; of each model `MODEL_dB_rms` of these, and `MODEL_within_2_sigma`, the share of standardised
            residuals, of which 95 % would be if there were noise alone.
        """
        rows = []
        for kind in dict.fromkeys(KINDS[record.attrs["statistic"]].title for record in self.records):
            mine = [i for i, record in enumerate(self.records) if KINDS[record.attrs["statistic"]].title == kind]
            row: dict[str, Any] = {
                "kind": kind,
                "records": len(mine),
                "channels": sum(self.records[i].sizes["channel"] for i in mine),
            }
            noise = np.concatenate([self.bands[i]["scatter_dB"].values.ravel() for i in mine])
            noise = noise[np.isfinite(noise)]
            row["noise_dB_rms"] = float(np.sqrt(np.mean(noise**2))) if noise.size else None
            for model in self.models:
                level = np.concatenate(
                    [self.bands[i]["deviation_dB"].sel(model=model).values.ravel() for i in mine]
                )
                z = np.concatenate([self.residuals[i]["z"].sel(model=model).values.ravel() for i in mine])
                z, level = z[np.isfinite(z)], level[np.isfinite(level)]
                row[f"{model}_dB_rms"] = float(np.sqrt(np.mean(level**2))) if level.size else None
                row[f"{model}_within_2_sigma"] = float(np.mean(np.abs(z) <= 2.0)) if z.size else None
            rows.append(row)
        return rows

    def summary(self) -> dict[str, Any]:
        """For people and machines."""
        found: dict[str, Any] = {"campaign": self.campaign.stated.title, "fits": self.fits()}
        if self.fit is not None:
            table = self.parameters
            found["parameters"] = table.sizes["parameter"]
            found["left_tolerance"] = table["parameter"].values[table["left"].values].tolist()
            found["not_informed"] = table["parameter"].values[table["not_informed"].values].tolist()
        missed = [line for record in self.records for line in missed_modes(record)]
        if missed:
            found["missed"] = missed
        found["left_out"] = [{"record": name, "why": why} for name, why in self.left_out.items()]
        return found


def assemble(
    observations: Observations,
    fit: Fit | None,
    *,
    left_out: Mapping[str, str] | None = None,
) -> Comparison:
    """The comparison of records that are read, and of a model that is recalibrated, already.

    Residuals are counted in the noise and the calibration errors of pairs of the fit, for both models.
    """
    campaign = observations.campaign
    whole = observations if fit is None else fit.observations
    measure = whole.selected(whole.records)
    mine = np.isin(whole.block_of, whole.records)
    free = free_parameters(campaign)
    solved = {RAW: measure.predicted(campaign)}
    spreads: dict[str, list[Reals] | None] = {
        RAW: _spread(measure, free, np.zeros(len(free)), np.eye(len(free)), solved[RAW])
    }
    rows = {RAW: measure.residuals(solved[RAW].datasets)}
    if fit is not None:
        solved[RECALIBRATED] = measure.predicted(fit.campaign)
        # An amendment may have brought parameters of its own, which a campaign's values do not hold.
        alike = fit.free == free or [f.name for f in fit.free] == [f.name for f in free]
        spreads[RECALIBRATED] = (
            _spread(measure, free, fit.z, fit.covariance, solved[RECALIBRATED]) if alike else None
        )
        rows |= {RECALIBRATED: fit.residuals[mine], CLEAN: fit.clean[mine]}
    block_of = measure.block_of
    records, bands, residuals = [], [], []
    for index, block in enumerate(measure.blocks):
        predictions = {name: s.datasets[index] for name, s in solved.items()}
        record = curves(campaign, block.dataset, predictions, block.scatter_dB())
        unknown = np.full(record["scatter_dB"].shape, np.nan)
        spread = np.stack([unknown if s is None else s[index] for s in spreads.values()])
        attrs = {"long_name": "standard deviation of the predicted level", "units": "dB"}
        record["predicted_dB"] = (("model", "channel", "frequency"), spread, attrs)
        records.append(record)
        bands.append(third_octaves(record))
        own = {name: values[block_of == index] for name, values in rows.items()}
        if fit is not None:
            predictions[CLEAN] = predictions[RECALIBRATED]
        residuals.append(standardised(block, own, predictions))
    return Comparison(
        campaign=campaign,
        fit=fit,
        records=tuple(records),
        bands=tuple(bands),
        residuals=tuple(residuals),
        parameters=parameters_of(campaign, fit),
        calibration=calibration_of(measure),
        left_out=dict(left_out or {}),
    )


def _spread(
    observations: Observations, free: Sequence[Free], z: Reals, covariance: Reals, solved: Solved
) -> list[Reals]:
    """Standard deviation of predicted levels by that of the parameters, dB; by block, (channel, frequency)."""
    slopes: list[list[Reals]] = [[] for _ in observations.blocks]
    for place, parameter in enumerate(free):
        step = STEP if z[place] + STEP <= parameter.limits[1] else -STEP
        moved = z.copy()
        moved[place] += step
        values = {f.name: f.value(float(v)) for f, v in zip(free, moved, strict=True)}
        near = observations.predicted(observations.campaign.with_values(values), solved)
        for slope, dataset, one, other in zip(
            slopes, observations.datasets, near.datasets, solved.datasets, strict=True
        ):
            change = np.abs(flat(dataset, one)) / np.abs(flat(dataset, other))
            slope.append(np.asarray(np.log(change) / step))
    found = []
    for slope, dataset in zip(slopes, observations.datasets, strict=True):
        scale = POWER_DB if kind_of(dataset.record).power else NEPER_DB
        if not slope:
            found.append(np.zeros(flat(dataset, dataset.data).shape))
            continue
        jacobian = np.stack(slope, axis=-1)
        variance = np.einsum("cfp,pq,cfq->cf", jacobian, covariance, jacobian, optimize=True)
        found.append(scale * np.sqrt(np.maximum(variance, 0.0)))
    return found
