"""The passage at 70 km/h by models of that at 40: `python benches/pairs/truss_held_out.py FOLDER`.

FOLDER is that of `run.py`. Speed and time of entry alone are found on the passage that is held out; stiffness and
effects are those of the other. Prints per channel the root mean square of measured less predicted, over that of
what was measured, for the model as stated, recalibrated and amended.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.predict import predict
from permway.diagnosis.verdict import Verdict
from permway.formats.model_file import read_model
from scipy import optimize
from truss import passage


def errors(campaign: Campaign) -> np.ndarray:
    """Of each channel, speed and time of entry at their best for all, shape (channels,)."""
    datasets = campaign.load()
    measured = datasets[0].data["spectrum"].values
    size = np.sqrt((np.abs(measured) ** 2).sum(axis=1, keepdims=True))
    nominal = {name: campaign.parameters.known[name].nominal for name in ("speed", "entry")}

    def off(z: np.ndarray) -> np.ndarray:
        values = {"speed": nominal["speed"] * (1.0 + 0.01 * z[0]), "entry": nominal["entry"] + 0.1 * z[1]}
        found = predict(campaign.with_values(values), datasets, threads=1)[0]["spectrum"].values
        left = (measured - found) / size
        return np.concatenate([left.real.ravel(), left.imag.ravel()])

    left = optimize.least_squares(off, np.zeros(2), diff_step=1e-3).fun.reshape(2, *measured.shape)
    return np.asarray(np.sqrt((left**2).sum(axis=(0, 2))))


def main() -> None:
    """Predict and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    held_out = read_campaign(passage(folder, 70))
    fitted = read_campaign(folder / "truss-40" / "campaign.toml")
    found = folder / "truss-40" / "out"
    verdict = Verdict.read(found / "verdict.json")
    stiffness = {"stiffness": verdict.recalibrated.before["stiffness"].value}
    models = {
        "as stated": fitted.model,
        "recalibrated": fitted.with_values(stiffness).model,
        "amended": read_model(found / "amended.toml"),
    }
    for km_per_h, campaign in ((40, fitted), (70, held_out)):
        for name, model in models.items():
            each = errors(campaign.with_model(model))
            print(km_per_h, name, [f"{value:.3f}" for value in each], f"all {np.sqrt(np.mean(each**2)):.3f}")


if __name__ == "__main__":
    main()
