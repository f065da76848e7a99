"""How much less a second model vibrates than a first: insertion loss in one-third octaves."""

from __future__ import annotations

import numpy as np
import xarray as xr

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.estimates.bands import Bands, bands_within
from permway.response.quantities import accelerance

FEWEST_LINES = 3
"""A band with fewer frequencies of the answers is left out."""

_SAME = 1e-9


def insertion_loss(without: xr.Dataset, having: xr.Dataset) -> xr.Dataset:
    """Insertion loss between the answers of two models, 10 lg(power without / power with) of acceleration.

    Of models with a train it is that under the train, from `line_acceleration_psd` at wheels and sensors; of
    others that under a force of equal power at all frequencies of a band, from `receptance`. A frequency stands
    for what is nearer to it than to its neighbours.

    Parameters
    ----------
    without, having : Dataset
        From :func:`permway.solve`, or :func:`permway.receptance` or :func:`permway.train_response`, at the same
        frequencies and places (of the same names): the reference, and what has the elastic part.

    Returns
    -------
    xarray.Dataset
        Over `band`, the nominal frequency in Hz, and places (or sensors and forces): `insertion_loss` in dB,
        positive where the second vibrates less; `power_without`, `power_with`, whose ratio it is; `lines`, the
        frequencies in the band. `insertion_loss_total` of all bands together.

    Raises
    ------
    InputError
        For answers that differ in frequencies, places, train or irregularity, or hold no whole band.
    """
    for where, data in (("without", without), ("having", having)):
        if not isinstance(data, xr.Dataset):
            remedy = "as in insertion_loss(solve(first), solve(second))"
            raise InputError(f"must be a Dataset, not a {type(data).__name__}", where=where, remedy=remedy)
    powers = _powers(without, having)
    frequency = without["frequency"].values
    share, bands = _bands(frequency)
    width = np.diff(_edges(frequency))
    summed = [(share * width) @ p.transpose("frequency", ...).values.reshape(frequency.size, -1) for p in powers]
    rest = [d for d in powers[0].dims if d != "frequency"]
    shape = tuple(powers[0].sizes[d] for d in rest)
    loss = 10.0 * np.log10(summed[0] / summed[1])
    total = 10.0 * np.log10(summed[0].sum(axis=0) / summed[1].sum(axis=0))
    dims = ("band", *rest)
    unit = {"units": str(powers[0].attrs["units"])}
    return xr.Dataset(
        {
            "insertion_loss": (dims, loss.reshape(-1, *shape), {"long_name": "insertion loss", "units": "dB"}),
            "power_without": (dims, summed[0].reshape(-1, *shape), {"long_name": "power without", **unit}),
            "power_with": (dims, summed[1].reshape(-1, *shape), {"long_name": "power with", **unit}),
            "insertion_loss_total": (
                rest,
                total.reshape(shape),
                {"long_name": "insertion loss of all bands", "units": "dB"},
            ),
        },
        coords={
            "band": ("band", bands.nominal_Hz, {"long_name": "nominal mid-band frequency", "units": "Hz"}),
            "lines": ("band", share.sum(axis=1), {"long_name": "frequencies in the band", "units": "1"}),
            **{name: c for name, c in powers[0].coords.items() if set(c.dims) <= set(rest)},
        },
        attrs={"excitation": "train" if "line_acceleration_psd" in without else "force of equal power in a band"},
    )


def _powers(without: xr.Dataset, having: xr.Dataset) -> tuple[xr.DataArray, xr.DataArray]:
    """Densities of acceleration of both, of equal places and frequencies."""
    if ("line_acceleration_psd" in without) != ("line_acceleration_psd" in having):
        raise InputError(
            "one has a train, the other has not", where="without, having", remedy="compare what is excited alike"
        )
    if "line_acceleration_psd" in without:
        _check_same(without, having, "place")
        _check_excited_alike(without, having)
        return without["line_acceleration_psd"], having["line_acceleration_psd"]
    for where, data in (("without", without), ("having", having)):
        if "receptance" not in data:
            raise InputError(
                "has neither line_acceleration_psd nor receptance",
                where=where,
                value=sorted(str(n) for n in data.data_vars),
                remedy="take an answer of permway.solve",
            )
    _check_same(without, having, "sensor")
    _check_same(without, having, "force")
    first, second = (abs(accelerance(data["receptance"])) ** 2 for data in (without, having))
    return first.assign_attrs(units="(m/s2/N)2 Hz"), second


def _check_same(without: xr.Dataset, having: xr.Dataset, kind: str) -> None:
    """Refuse other frequencies, and other names of places."""
    one, two = (data["frequency"].values for data in (without, having))
    if one.shape != two.shape or not np.allclose(one, two, rtol=_SAME):
        raise InputError(
            "the answers are at other frequencies",
            where="having",
            remedy="give both models the same [frequencies]",
        )
    names = [[str(n) for n in data[kind].values] for data in (without, having)]
    if names[0] != names[1]:
        raise InputError(
            f"has other {kind}s than without",
            where="having",
            value=names[1],
            remedy=f"name them alike: {names[0]}",
        )


def _check_excited_alike(without: xr.Dataset, having: xr.Dataset) -> None:
    speeds = [data.attrs.get("speed_m_per_s") for data in (without, having)]
    if speeds[0] != speeds[1]:
        raise InputError(
            "the train has another speed", where="having", value=speeds[1], remedy=f"take {speeds[0]}"
        )
    one, two = (data["irregularity_psd"].values for data in (without, having))
    if not np.allclose(one, two, rtol=_SAME, atol=0.0):
        raise InputError(
            "the irregularity is another", where="having", remedy="give both models the same [irregularity]"
        )


def _edges(frequency: Reals) -> Reals:
    """Of the cell that each frequency stands for."""
    middle = 0.5 * (frequency[1:] + frequency[:-1])
    return np.asarray(np.concatenate([[frequency[0]], middle, [frequency[-1]]]))


def _bands(frequency: Reals) -> tuple[Reals, Bands]:
    """Share of every frequency's cell in every whole band that has enough of them."""
    found = bands_within(float(frequency[0]), float(frequency[-1]))
    if frequency.size >= FEWEST_LINES and found.number.size:
        inside = (frequency >= found.low_Hz[:, None]) & (frequency < found.high_Hz[:, None])
        enough = np.flatnonzero(inside.sum(axis=1) >= FEWEST_LINES)
        if enough.size:
            # Bands run on without gaps from the first that is resolved.
            number = found.number[enough[0] :]
            thin = np.flatnonzero(inside[enough[0] :].sum(axis=1) < FEWEST_LINES)
            bands = Bands(number=number[: thin[0]] if thin.size else number)
            return bands.weights(_edges(frequency)), bands
    raise InputError(
        f"no one-third octave has {FEWEST_LINES} frequencies between {frequency[0]:g} and {frequency[-1]:g} Hz",
        where="frequency",
        remedy="take more, or at closer steps",
    )
