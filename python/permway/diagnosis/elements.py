"""Elements of which mechanics outside the catalogue are made: laws of up to three constants."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from permway.diagnosis.catalogue._change import constant_loss, fixed_mass
from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import between_free, linear_free, log_free
from permway.laws import Hysteretic, Maxwell, Parallel, Scaled, Springpot
from permway.laws.base import Law
from permway.laws.waves import Waves

AT_HZ = 100.0
"""Where the stiffness of a springpot is counted."""

Values = Mapping[str, float]


@dataclass(frozen=True)
class Element:
    """A kind of element.

    Attributes
    ----------
    name : str
    free : callable
        From a typical stiffness in N/m and the frequency where it acts to the constants.
    law : callable
        From the constants to the law that is added.
    words : callable
    """

    name: str
    free: Callable[[float, float], tuple[Free, ...]]
    law: Callable[[Values], Law]
    words: Callable[[Values], str]


def _spring(v: Values) -> Law:
    """One that pushes away loses as much as one that pulls back: none gives energy."""
    stiffness = v["stiffness_N_per_m"]
    spring = Scaled(law=Hysteretic(stiffness=1.0), factor=stiffness)
    return Parallel(first=spring, second=constant_loss(abs(stiffness) * v["loss_factor"]))


def _dashpot(v: Values) -> Law:
    return Scaled(law=Springpot(coefficient=1.0, order=1.0), factor=v["damping_Ns_per_m"])


def _springpot(v: Values) -> Law:
    at = float((2.0 * np.pi * AT_HZ) ** v["order"])
    return Scaled(law=Springpot(coefficient=1.0, order=v["order"]), factor=v["stiffness_N_per_m"] / at)


def _maxwell(v: Values) -> Law:
    stiffness = v["stiffness_N_per_m"]
    return Maxwell(stiffness=stiffness, damping=stiffness / (2.0 * np.pi * v["frequency_Hz"]))


def _inerter(v: Values) -> Law:
    """A force in proportion to the difference of two accelerations (Smith 2002, IEEE T. Automat. Contr. 47)."""
    return fixed_mass(v["inertance_kg"])


def _rod(v: Values) -> Law:
    """A rod that is held below and free above, -m omega^2 tan(b) / b with b = (pi / 2) f / f1 / sqrt(1 + i eta).

    It is one half of a rod of twice the length whose ends move alike.
    """
    stiffness = 0.5 * v["mass_kg"] * (4.0 * v["frequency_Hz"]) ** 2
    return Waves(stiffness=stiffness, delay_s=0.5 / v["frequency_Hz"], loss_factor=v["loss_factor"], part="end")


def _signed(name: str, unit: str, size: float) -> Free:
    return linear_free(name, unit, 0.0, size, -8.0 * size, 8.0 * size)


ELEMENTS = (
    Element(
        "spring",
        lambda k, f: (_signed("stiffness_N_per_m", "N/m", k), between_free("loss_factor", "1", 0.0, 2.0)),
        _spring,
        lambda v: f"a spring of {v['stiffness_N_per_m']:.3g} N/m, loss factor {v['loss_factor']:.2g}",
    ),
    Element(
        "dashpot",
        lambda k, f: (log_free("damping_Ns_per_m", "N s/m", k / (2.0 * np.pi * f), 3.0),),
        _dashpot,
        lambda v: f"a dashpot of {v['damping_Ns_per_m']:.3g} N s/m",
    ),
    Element(
        "springpot",
        lambda k, f: (
            log_free("stiffness_N_per_m", "N/m", k * float(np.sqrt(AT_HZ / f)), 3.0),
            between_free("order", "1", 0.02, 0.98),
        ),
        _springpot,
        lambda v: f"a springpot of order {v['order']:.2f}, {v['stiffness_N_per_m']:.3g} N/m at {AT_HZ:g} Hz",
    ),
    Element(
        "maxwell",
        lambda k, f: (log_free("stiffness_N_per_m", "N/m", k, 3.0), log_free("frequency_Hz", "Hz", f, 3.0)),
        _maxwell,
        lambda v: (
            f"a spring of {v['stiffness_N_per_m']:.3g} N/m in series with a dashpot, relaxing at "
            f"{v['frequency_Hz']:.3g} Hz"
        ),
    ),
    Element(
        "inerter",
        lambda k, f: (log_free("inertance_kg", "kg", k / (2.0 * np.pi * f) ** 2, 3.0),),
        _inerter,
        lambda v: f"an inertance of {v['inertance_kg']:.3g} kg",
    ),
)

STANDING = (
    Element(
        "rod",
        lambda k, f: (
            log_free("mass_kg", "kg", k / (2.0 * np.pi * f) ** 2, 3.0),
            log_free("frequency_Hz", "Hz", f, 3.0),
            log_free("loss_factor", "1", 0.1, 2.5),
        ),
        _rod,
        lambda v: (
            f"a standing rod of {v['mass_kg']:.3g} kg, a quarter wave long at {v['frequency_Hz']:.3g} Hz, loss "
            f"factor {v['loss_factor']:.2g}"
        ),
    ),
)
"""What stands on a body: a mast, a post, a pier that carries waves."""
