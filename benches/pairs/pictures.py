"""Draws the pictures of the cases: `python benches/pairs/pictures.py FOLDER`, FOLDER being that of `run.py`.

What was measured, what the model as stated says of it, and what the amended one does.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from permway.arrays import Reals
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.predict import predict
from permway.formats.model_file import read_model
from scipy.fft import irfft

IMAGES = Path(__file__).resolve().parents[2] / "docs" / "images" / "cases"
STATED, AMENDED = "#b04a3a", "#2a6f97"


def models(folder: Path) -> dict[str, Campaign]:
    """The campaign with the model as stated and as amended."""
    campaign = read_campaign(folder / "campaign.toml")
    return {
        "as stated": campaign,
        "amended": campaign.with_model(read_model(folder / "out" / "amended.toml")),
    }


def cart(folder: Path) -> None:
    """Level of the response."""
    figure = Figure(figsize=(6.4, 3.2), layout="constrained")
    axes = figure.subplots()
    for (name, campaign), colour in zip(models(folder).items(), (STATED, AMENDED), strict=True):
        datasets = campaign.load()
        data = datasets[0].data
        frequency = data["frequency"].values
        if name == "as stated":
            axes.plot(frequency, _dB(data["frf"].values), ".", color="0.3", ms=3, label="measured")
        (found,) = predict(campaign, datasets, threads=1)
        axes.plot(frequency, _dB(found["frf"].values), color=colour, label=name)
    axes.set(xlabel="frequency, Hz", ylabel="displacement over force, dB re 1 m/N", xscale="log")
    axes.legend(frameon=False)
    _save(figure, "cart")


def _dB(frf: np.ndarray) -> Reals:
    return np.asarray(20.0 * np.log10(np.abs(frf).reshape(frf.shape[-1])))


def truss(folder: Path) -> None:
    """Strain of the chord at the bearing and deflection of the middle, below the band's end."""
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    axes = figure.subplots(2, 1, sharex=True)
    for (name, campaign), colour in zip(models(folder).items(), (STATED, AMENDED), strict=True):
        datasets = campaign.load()
        data = datasets[0].data
        (found,) = predict(campaign, datasets, threads=1)
        for one, channel, unit in zip(axes, ("d5", "S22"), (("mm", 1e3), ("um/m", 1e6)), strict=True):
            if name == "as stated":
                one.plot(
                    *_history(data, data["spectrum"], channel, unit[1]), color="0.3", lw=2.5, label="measured"
                )
            one.plot(*_history(data, found["spectrum"], channel, unit[1]), color=colour, label=name)
            one.set_ylabel(f"{channel}, {unit[0]}")
    axes[0].legend(frameon=False)
    axes[1].set_xlabel("time, s")
    _save(figure, "truss")


def _history(data: xr.Dataset, spectrum: xr.DataArray, channel: str, scale: float) -> tuple[Reals, Reals]:
    """What the lines of the band make of the record."""
    samples, rate = int(data.attrs["samples"]), float(data.attrs["sampling_Hz"])
    whole = np.zeros(samples // 2 + 1, dtype=np.complex128)
    row = int(np.flatnonzero(data["channel"].values == channel)[0])
    whole[np.round(data["frequency"].values * samples / rate).astype(int)] = spectrum.values[row]
    return np.arange(samples) / rate, np.asarray(scale * rate * irfft(whole, n=samples))


def _save(figure: Figure, name: str) -> None:
    IMAGES.mkdir(parents=True, exist_ok=True)
    figure.savefig(IMAGES / f"{name}.png", dpi=110)


def main() -> None:
    """Draw what FOLDER holds."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    for draw, name in ((cart, "cart-5-7"), (truss, "truss-40")):
        if (folder / name / "out" / "amended.toml").exists():
            draw(folder / name)


if __name__ == "__main__":
    main()
