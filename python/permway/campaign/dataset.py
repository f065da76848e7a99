"""A record of a campaign as labelled arrays, and which of its lines are used."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr

from permway.arrays import Reals
from permway.campaign.parts import Condition, Record
from permway.errors import InputError

SI_UNITS = {
    "displacement": "m",
    "velocity": "m/s",
    "acceleration": "m/s2",
    "force": "N",
    "strain": "1",
    "bending_moment": "N m",
}


@dataclass(frozen=True)
class Dataset:
    """One record of a campaign, ready to be compared with a prediction.

    Attributes
    ----------
    record : Record
        As the campaign file has it.
    condition : Condition
    data : xarray.Dataset
        In SI, named by sensors and force points; by the record's statistic:

        - "frf": `frf` (sensor, force, frequency), complex; `coherence`; `log_variance`, of the log magnitude and
          of the phase in rad; attributes `noise` and `averages`. Of noise "scatter" the coherence is NaN, and
          there are no averages.
        - "csd", "psd": as :func:`permway.recordings.estimates.welch.cross_spectra` gives them: `csd` (channel,
          channel2, frequency), `psd` (channel, frequency), `degrees_of_freedom`, attribute `averages`.
        - "bands": `mean_square` (channel, band).
        - "decay": `decay_rate` (band,), dB/m.
        - "transmissibility": `transmissibility` (channel, frequency), complex.
        - "modes": `modes` and `relative_sd` (quantity, frequency), natural frequency in Hz and damping ratio;
          `shape` (sensor, frequency) if it is listed.
        - "passage": `spectrum`, complex, and `noise_sd` (channel, frequency).
        - "material": `modulus` (point,), complex, Pa or N/m, with `frequency` and `temperature_C` of every point.
    """

    record: Record
    condition: Condition
    data: xr.Dataset

    @cached_property
    def _names(self) -> dict[str, list[str]]:
        return {}

    def names(self, dimension: str) -> list[str]:
        """Of its sensors, forces or channels, in their order."""
        if dimension not in self._names:
            self._names[dimension] = [str(name) for name in self.data.variables[dimension].values]
        return self._names[dimension]

    def template(self, blank: Callable[[xr.Dataset], xr.Dataset]) -> xr.Dataset:
        """What is predicted of it, to be filled: made once, by its kind."""
        if not self._templates:
            self._templates.append(blank(self.data))
        return self._templates[0]

    @cached_property
    def _templates(self) -> list[xr.Dataset]:
        return []

    @cached_property
    def frequency_Hz(self) -> Reals:
        """Its lines, shape (F,)."""
        return np.asarray(self.data.variables["frequency"].values, dtype=np.float64)


def level_averages(data: xr.Dataset) -> Reals:
    """Averages that each channel's power is worth, (channels,): fewer if its level varies along the record."""
    averages = float(data.attrs["averages"])
    known = data.get("level_averages")
    return np.full(data["channel"].size, averages) if known is None else np.asarray(known.values)


def in_band(frequency_Hz: Reals, record: Record) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Which frequencies a record uses: its band, and never 0 Hz.

    Raises
    ------
    InputError
        If none is left.
    """
    low, high = record.band_Hz or (0.0, np.inf)
    slack = 1e-9
    used = (frequency_Hz > 0.0) & (frequency_Hz >= low * (1.0 - slack)) & (frequency_Hz <= high * (1.0 + slack))
    if not used.any():
        reach = f"{frequency_Hz.min():g} to {frequency_Hz.max():g} Hz" if frequency_Hz.size else "nothing"
        raise InputError(
            "holds no line of the record", where="band_Hz", value=(low, high), remedy=f"it has {reach}"
        )
    return np.asarray(used)
