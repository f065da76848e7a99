"""Hammer blows in CSV to frequency responses: `python blows_to_frf.py FOLDER` writes FOLDER/blows.npz.

Each `blows POINT.csv` holds the force and the accelerations, one blow of four seconds after the other.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from permway.recordings.estimates.blows import blow_spectra
from permway.recordings.estimates.frf import frequency_response
from permway.recordings.readers.front import read_time

BLOW_S = 4.0


def responses(folder: Path) -> dict[str, np.ndarray]:
    """Frequency (F,), and (F, sensor, point): response in m/s2 per N, and its coherence."""
    files = sorted(folder.glob("blows *.csv"))
    found = []
    for file in files:
        record = read_time(file)
        assert record.sampling_Hz is not None
        length = int(BLOW_S * record.sampling_Hz)
        blows = record.values.reshape(len(record.channels), -1, length).swapaxes(0, 1)
        spectra = blow_spectra(blows, sampling_Hz=record.sampling_Hz, channels=record.channels)
        found.append(frequency_response(spectra, references=["hammer"]).isel(reference=0))
    return {
        "f": found[0]["frequency"].values,
        "frf": np.stack([f["frf"].values.T for f in found], axis=-1),
        "coh": np.stack([f["coherence"].values.T for f in found], axis=-1),
        "sensor": found[0]["response"].values.astype(str),
        "hammer": np.array([file.stem.removeprefix("blows ") for file in files]),
    }


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    np.savez(folder / "blows.npz", **responses(folder))
