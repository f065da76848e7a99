"""A pad's law and its shift over temperature from a table of DMA tests, with the truth known."""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from look import axes, show
from matplotlib.figure import Figure
from permway.laws import TFDV, WLF, FractionalZener
from permway.laws.dma import read_dma
from permway.laws.identify import Identification, identify

FREQUENCY_HZ = np.geomspace(0.5, 50.0, 9)
TEMPERATURES_C = (-40.0, -30.0, -20.0, -10.0, 0.0, 10.0, 20.0, 30.0)
SCATTER = 0.02
RUBBER = TFDV(
    law=FractionalZener(relaxed=4.0e6, unrelaxed=4.0e8, relaxation_time_s=2.0e-7, order=0.45),
    shift=WLF(c1=9.0, c2_K=120.0, reference_temperature_C=20.0),
    reference_temperature_C=20.0,
    vertical="none",
)


def write_table(path: Path) -> None:
    """The table as a laboratory hands it over: storage and loss, each 2 % off at random."""
    random = np.random.default_rng(0)
    rows = ["temperature (degC),frequency (Hz),storage modulus (MPa),loss modulus (MPa)"]
    for t in TEMPERATURES_C:
        for f in FREQUENCY_HZ:
            modulus = complex(RUBBER.complex(f, t)) / 1e6
            storage, loss = np.array([modulus.real, modulus.imag]) * np.exp(SCATTER * random.standard_normal(2))
            rows.append(f"{t:g},{f:.4g},{storage:.5g},{loss:.5g}")
    path.write_text("\n".join(rows) + "\n")


def compute() -> Identification:
    """What the table says, the form of the law given."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "dma.csv"
        write_table(path)
        return identify(read_dma(path), law="fractional_zener", shift="wlf", reference_temperature_C=20.0, seed=0)


def numbers(found: Identification) -> dict[str, float]:
    """What the page quotes."""
    order = next(p for p in found.parameters if p.name.endswith("order"))
    far = found.law.complex(300.0, -20.0) / RUBBER.complex(300.0, -20.0)
    return {
        "order of the springpot": order.value,
        "its 90 % interval, from": order.low,
        "to": order.high,
        "scatter left, per cent of storage": 100.0 * np.log(10.0) * found.rms_log10_modulus,
        "modulus at 300 Hz and -20 °C, found over true": float(abs(far)),
    }


def picture(found: Identification) -> Figure:
    """Measured and identified, temperature by temperature."""
    figure, (left, right) = axes(2)
    f = np.geomspace(FREQUENCY_HZ[0], FREQUENCY_HZ[-1], 60)
    table = found.table
    assert table.temperature_C is not None
    for t, colour in zip((-30.0, -10.0, 10.0, 30.0), ("#26293b", "#2a7bb0", "#6a994e", "#c8553d"), strict=True):
        law, mine = found.law.complex(f, t), table.temperature_C == t
        for one, values, measured in (
            (left, law.real, table.storage_Pa[mine]),
            (right, law.imag / law.real, table.loss_factor[mine]),
        ):
            one.semilogx(f, values, color=colour, label=f"{t:g} °C")
            one.semilogx(table.frequency_Hz[mine], measured, "o", color=colour, markersize=3.5)
    left.set(xlabel="frequency, Hz", ylabel="storage modulus, Pa", yscale="log")
    right.set(xlabel="frequency, Hz", ylabel="loss factor")
    right.legend(frameon=False, fontsize=8)
    return figure


if __name__ == "__main__":
    if len(sys.argv) > 1:
        write_table(Path(sys.argv[1]))
    else:
        show(__file__, compute, numbers, picture)
