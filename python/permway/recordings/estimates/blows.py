"""Cross spectra of hammer blows: transients, one transform each, no overlap."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.estimates.checks import as_reals, check_names, check_positive, check_units
from permway.recordings.estimates.welch import spectra_dataset
from permway.recordings.estimates.windows import Segments


def blow_spectra(
    blows: ArrayLike,
    *,
    sampling_Hz: float,
    channels: Sequence[str] | None = None,
    units: str | Sequence[str] | None = None,
    force: int = 0,
    blow_at_s: float = 0.0,
    force_window_s: float | None = None,
    exponential_s: float | None = None,
) -> xr.Dataset:
    """Cross spectra averaged over blows, as a dataset that `frequency_response` takes.

    Densities are energy of a blow per Hz over its length; K is the number of blows. The part before the blow
    should be short. Under an exponential window of all channels, exp(-(t - blow_at_s) / tau), the response
    function is that at the complex frequency omega - i / tau: every pole is damped by 1 / tau more than in
    truth (attribute `added_decay_per_s`), which a model is given too, or a modal fit takes off. (ISO
    7626-5:2019, clause 8.)

    Parameters
    ----------
    blows : array_like, shape (blow, channel, sample)
    sampling_Hz : float
    channels : sequence of str, optional
    units : str or sequence of str, optional
    force : int
        Which channel is the hammer.
    blow_at_s : float
        When the blow falls.
    force_window_s : float, optional
        The force is kept this long after the blow, and faded out over a quarter as much again.
    exponential_s : float, optional
        tau of the exponential window.

    Raises
    ------
    InputError
        For NaN, a shape that does not fit, or windows beyond the record.
    """
    record = as_reals(blows, "blows", ndim=3)
    rate = check_positive(sampling_Hz, "sampling_Hz")
    count, size, length = record.shape
    if min(record.shape) == 0 or length < 8:
        raise InputError(
            "too small", where="blows", value=f"shape {record.shape}", remedy="give (blow, channel, sample)"
        )
    if isinstance(force, bool) or not isinstance(force, int | np.integer) or not -size <= force < size:
        raise InputError(f"there are {size} channels", where="force", value=force)
    time = np.arange(length) / rate - blow_at_s
    if not 0.0 <= blow_at_s < length / rate:
        raise InputError(f"outside the record of {length / rate:.4g} s", where="blow_at_s", value=blow_at_s)
    if force_window_s is not None:
        kept = _force_window(time, check_positive(force_window_s, "force_window_s"))
        record = record.copy()
        record[:, force] *= kept
    if exponential_s is not None:
        record = record * np.exp(-np.maximum(time, 0.0) / check_positive(exponential_s, "exponential_s"))
    transform = np.fft.rfft(record, axis=2).transpose(2, 1, 0)
    csd = transform @ transform.conj().transpose(0, 2, 1) / count * 2.0 / (rate * length)
    csd[0] *= 0.5
    if length % 2 == 0:
        csd[-1] *= 0.5
    # Blows do not overlap, and their lines are independent: what differs from blow to blow is noise.
    layout = Segments(window=np.ones(length), step=length, count=count)
    data = spectra_dataset(
        csd.transpose(1, 2, 0),
        layout=layout,
        sampling_Hz=rate,
        detrended=False,
        channels=check_names(channels, size),
        units=check_units(units, size),
        window="blow",
        duration_s=count * length / rate,
    )
    return data.assign_attrs(added_decay_per_s=0.0 if exponential_s is None else 1.0 / exponential_s)


def _force_window(time: Reals, keep_s: float) -> Reals:
    fade = np.clip((time - keep_s) / (0.25 * keep_s), 0.0, 1.0)
    return np.asarray(np.where(time < 0.0, 0.0, 0.5 * (1.0 + np.cos(np.pi * fade))))
