"""Parts that several preset lines share: rails, rows of concrete beams, approaches."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

import numpy as np
from pydantic import ValidationError

from permway.arrays import Reals
from permway.laws import KelvinVoigt
from permway.model.bodies import Beam, Interval
from permway.model.faults import model_error
from permway.model.stations import Spread
from permway.records import FrozenModel

Options = TypeVar("Options", bound=FrozenModel)


def chosen(record: type[Options], options: Mapping[str, Any]) -> Options:
    """Read the options of a preset.

    Raises
    ------
    InputError
        With the option at fault.
    """
    try:
        return record.model_validate(dict(options))
    except ValidationError as error:
        raise model_error(error, options, "") from error


def chn60(rails: float) -> Beam:
    """CHN60 rail as the paper has it, Table 2; `rails` of them as one beam."""
    return Beam(
        theory="timoshenko",
        youngs_modulus_Pa=2.1e11,
        second_moment_m4=3.217e-5,
        density_kg_per_m3=7850.0,
        area_m2=7.745e-3,
        shear_modulus_Pa=7.7e10,
        shear_coefficient=0.4,
        loss_factor=0.01,
        share=rails,
    )


def concrete_row(
    modulus: float,
    inertia: float,
    density: float,
    area: float,
    share: float,
    intervals: tuple[Interval, ...],
    modes: int | None = None,
    *,
    pinned: bool = False,
    loss_factor: float = 0.1,
) -> Beam:
    """A row of Euler beams: slabs, base plates or girders."""
    return Beam(
        youngs_modulus_Pa=modulus,
        second_moment_m4=inertia,
        density_kg_per_m3=density,
        area_m2=area,
        loss_factor=loss_factor,
        intervals_m=intervals,
        ends="pinned" if pinned else "free",
        modes=modes,
        share=share,
    )


def fastener_of_zeng() -> KelvinVoigt:
    """One fastener: 5.0e7 N/m and 3.625e4 N s/m, Zeng et al. 2014, Table 2."""
    return KelvinVoigt(stiffness=5.0e7, damping=3.625e4)


def approaches(stations: Reals, bays: int, spacing_m: float) -> tuple[Spread, ...]:
    """Stations before the first and behind the last, as many bays on either side."""
    if bays == 0:
        return ()
    first, last = float(stations[0]), float(stations[-1])
    reach = bays * spacing_m
    before = Spread(from_m=first - reach, to_m=first - spacing_m, spacing_m=spacing_m)
    behind = Spread(from_m=last + spacing_m, to_m=last + reach, spacing_m=spacing_m)
    return before, behind


def repeated(local: Sequence[float] | Reals, starts: Reals) -> Reals:
    """The same places on every span, ascending, m."""
    return np.asarray(starts[:, None] + np.asarray(local)[None, :], dtype=np.float64).reshape(-1)


def intervals(local: Sequence[tuple[float, float]], starts: Reals) -> tuple[Interval, ...]:
    """The same intervals on every span, m."""
    return tuple((float(s) + a, float(s) + b) for s in starts for a, b in local)
