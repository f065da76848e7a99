"""Folders as `permway import` reads them, each small and quickly read: a rig, pads, decay rates."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from permway.campaign.importers.rubber_rig import MASSES_KG, RIG

MODULUS_PA = 5.0e6
SHARE = 0.15
"""Springpot beside the spring of the rubber, at 1 rad/s and 21 degrees Celsius, and its order 0.3."""

LEVELS = {"01g": 0.981, "1g": 9.81}
"""Acceleration of the base, m/s2."""


def modulus(frequency_Hz: np.ndarray, temperature_C: float = 21.0) -> np.ndarray:
    """Of the rubber, Pa; a WLF shift about 21 degrees Celsius."""
    away = temperature_C - 21.0
    shift = 10.0 ** (-9.0 * away / (120.0 + away))
    return MODULUS_PA * (1.0 + SHARE * (2j * np.pi * frequency_Hz * shift) ** 0.3)


def make_rig(folder: Path, shaken: tuple[str, ...], materials: tuple[str, ...] = ("rubber",)) -> Path:
    """A DMA sweep and, of every name as "1g_253g", the shaker's record."""
    for material in materials:
        (folder / material / "dma").mkdir(parents=True)
        (folder / material / "shaker").mkdir()
        rows = ["freq_hz,temperature_C,G_storage_pa,G_loss_pa"]
        for temperature in (-10.0, 5.0, 21.0, 40.0):
            frequency = np.geomspace(1.0, 50.0, 8)
            values = modulus(frequency, temperature)
            rows += [
                f"{f:.6g},{temperature},{g.real:.8g},{g.imag:.8g}" for f, g in zip(frequency, values, strict=True)
            ]
        (folder / material / "dma" / "tf_015p.csv").write_text("\n".join(rows) + "\n")
        for name in shaken:
            make_shaken(folder / material / "shaker" / f"{name}.csv")
    return folder


def make_shaken(path: Path, *, softer: float = 1.0) -> None:
    """A record of a mass on two rings, by the file's name; at 1 g the rubber may be softer."""
    level, mass = path.stem.split("_")[0], path.stem.split("_")[-1]
    frequency = np.linspace(150.0, 600.0, 91)
    stiffness = RIG.shape_factor_m * modulus(frequency) * (softer if level == "1g" else 1.0)
    kilograms = MASSES_KG[mass] + RIG.moving_mass_kg
    moved = LEVELS[level] * stiffness / (stiffness - kilograms * (2.0 * np.pi * frequency) ** 2)
    rows = ["freq_hz,base_accel_ms2,base_phase_rad,mass_accel_ms2,mass_phase_rad"]
    rows += [
        f"{f:.6g},{LEVELS[level]},0.0,{abs(a):.8g},{np.angle(a):.8g}"
        for f, a in zip(frequency, moved, strict=True)
    ]
    path.write_text("\n".join(rows) + "\n")


def make_pads(folder: Path, materials: tuple[str, ...] = ("eva", "pu")) -> Path:
    """Moduli and loss factors over frequency."""
    for material in materials:
        (folder / material).mkdir(parents=True)
        frequency = np.geomspace(10.0, 1000.0, 20)
        values = modulus(frequency)
        for name, column in (
            ("storage_modulus_MPa.tsv", 1e-6 * values.real),
            ("loss_factor.tsv", values.imag / values.real),
        ):
            rows = [f"{f:.8g}\t{v:.8g}" for f, v in zip(frequency, column, strict=True)]
            (folder / material / name).write_text("\n".join(rows) + "\n")
    return folder


def make_decay(folder: Path) -> Path:
    """Two tests of decay rates, one vertical, one lateral."""
    folder.mkdir()
    bands = [100, 125, 160, 200, 250, 315, 400, 500, 630, 800, 1000, 1250, 1600, 2000, 2500, 3150, 4000, 5000]
    rates = [str(round(2.0 + 10.0 / (1.0 + (b / 400.0 - 1.0) ** 2), 2)) for b in bands]
    rows = ["tdr_id,messdatum,temp,rail,dir," + ",".join(map(str, bands))]
    rows += [f"{i},2012-09-13,13.0,li,{way}," + ",".join(rates) for i, way in ((1, "v"), (2, "h"))]
    (folder / "tdr_reference_section.csv").write_text("\n".join(rows) + "\n")
    return folder
