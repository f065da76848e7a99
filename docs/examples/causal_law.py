"""A constant loss factor is not causal: what Kramers and Kronig's relations ask of a pad's stiffness."""

from __future__ import annotations

import numpy as np
import permway
from look import axes, show
from matplotlib.figure import Figure
from permway.laws import Law, LawCheck

FREQUENCY_HZ = np.geomspace(1.0, 1000.0, 200)
LAWS = {
    "hysteretic": {"type": "hysteretic", "stiffness": 3.0e7, "loss_factor": 0.2},
    "springpot beside a spring": {
        "type": "fractional_kelvin_voigt",
        "stiffness": 1.0e7,
        "coefficient": 1.0e7,
        "order": 0.15,
    },
}


def compute() -> dict[str, tuple[Law, LawCheck]]:
    """Each law and what its check says from 1 to 1000 Hz."""
    laws = {name: permway.law_from_dict(table) for name, table in LAWS.items()}
    return {name: (law, law.check((1.0, 1000.0))) for name, law in laws.items()}


def numbers(found: dict[str, tuple[Law, LawCheck]]) -> dict[str, float]:
    """What the page quotes."""
    springpot = found["springpot beside a spring"][0]
    storage, factor = springpot.storage([1.0, 1000.0]), springpot.loss_factor([1.0, 1000.0])
    return {
        "hysteretic: causal (1 yes, 0 no)": float(found["hysteretic"][1].causal),
        "springpot: causal (1 yes, 0 no)": float(found["springpot beside a spring"][1].causal),
        "springpot: storage at 1000 Hz over that at 1 Hz": float(storage[1] / storage[0]),
        "springpot: loss factor at 1 Hz": float(factor[0]),
        "springpot: loss factor at 1000 Hz": float(factor[1]),
    }


def picture(found: dict[str, tuple[Law, LawCheck]]) -> Figure:
    """Storage and loss factor."""
    figure, (left, right) = axes(2, height=3.2)
    for name, (law, _) in found.items():
        left.semilogx(FREQUENCY_HZ, law.storage(FREQUENCY_HZ) / 1e6, label=name)
        right.semilogx(FREQUENCY_HZ, law.loss_factor(FREQUENCY_HZ))
    left.set(xlabel="frequency, Hz", ylabel="storage, MN/m", ylim=(0, 50))
    right.set(xlabel="frequency, Hz", ylabel="loss factor", ylim=(0, 0.25))
    left.legend(frameon=False)
    return figure


if __name__ == "__main__":
    show(__file__, compute, numbers, picture)
