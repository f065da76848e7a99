"""The deck of the tutorial: hammer blows in CSV against what its nominal model predicts."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from blows_to_frf import responses
from look import axes, show
from make_deck import write
from matplotlib.figure import Figure
from permway.campaign.campaign import read_campaign
from permway.campaign.predict import predict

SHOWN = (("rail@6", "rail 6.0"), ("rail@6", "rail 9.3"))


def compute() -> dict[str, np.ndarray]:
    """Measured and predicted accelerance of two pairs, and their coherence."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        write(folder)
        np.savez(folder / "blows.npz", **responses(folder))
        campaign = read_campaign(folder / "campaign.toml")
        blows = campaign.load()[0]
        (model,) = predict(campaign, [blows], threads=1)
    found = {"frequency": blows.data["frequency"].values}
    for sensor, force in SHOWN:
        pair = {"sensor": sensor, "force": force}
        found[f"measured {force}"] = blows.data["frf"].sel(pair).values
        found[f"predicted {force}"] = model["frf"].sel(pair).values
        found[f"coherence {force}"] = blows.data["coherence"].sel(pair).values
    return found


def numbers(found: dict[str, np.ndarray]) -> dict[str, float]:
    """What the page quotes."""
    quoted = {}
    for _, force in SHOWN:
        ratio = np.abs(found[f"measured {force}"] / found[f"predicted {force}"])
        quoted[f"struck at {force}, root mean square deviation, dB"] = float(
            np.sqrt(np.mean((20 * np.log10(ratio)) ** 2))
        )
        quoted[f"struck at {force}, median coherence"] = float(np.median(found[f"coherence {force}"]))
    return quoted


def picture(found: dict[str, np.ndarray]) -> Figure:
    """Both pairs."""
    figure, pair = axes(2)
    for one, (_, force) in zip(pair, SHOWN, strict=True):
        one.loglog(found["frequency"], np.abs(found[f"measured {force}"]), label="measured", linewidth=1.0)
        one.loglog(found["frequency"], np.abs(found[f"predicted {force}"]), label="nominal model", linewidth=1.0)
        one.set(title=f"rail at 6 m, struck at {force} m", xlabel="frequency, Hz", xticks=[10, 30, 100, 200])
        one.title.set_fontsize(10)
        one.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
        one.xaxis.set_minor_formatter(lambda x, _: "")
    pair[0].set_ylabel("accelerance, m/s$^2$/N")
    pair[1].legend(frameon=False)
    return figure


if __name__ == "__main__":
    show(__file__, compute, numbers, picture)
