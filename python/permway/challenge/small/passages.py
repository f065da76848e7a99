"""Trains that pass one accelerometer beside a ballasted track: small campaigns with a void or lost fasteners.

Records are made in time by :mod:`permway.challenge.small.passed`; axles carry constant loads over a smooth rail.
Of three campaigns one conceals nothing, one a void below sleepers, one fasteners that hold little. A void is one
that loads do not close: its supports keep a share of their stiffness.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from permway.campaign.campaign import read_campaign
from permway.challenge.beams import Complexes, Reals, Section
from permway.challenge.small import errors as measured
from permway.challenge.small.draws import generator, log_between
from permway.challenge.small.make import true_values
from permway.challenge.small.passages_drawn import BAND_HZ, PASSAGES, RATE_HZ, TOLERANCES, Drawn, draw
from permway.challenge.small.passed import Axles, Ballasted, lost
from permway.challenge.small.strength import Blows, Scale
from permway.challenge.small.write import write_arrays, write_tables, write_truth
from permway.challenge.weigh import keep
from permway.diagnosis.side_by_side import one_thread_of_blas

CASES = 40
"""Of a suite, unless others are asked for."""

OCTAVES = (0.5, 2.0)
"""Over which the chain's error correlates. At a third of it a chain would ring for as long as a train takes."""

NOISE = (1e-3, 3e-2)
"""Of a sample over the largest of the record, evenly in its logarithm."""

TRACK = tuple(TOLERANCES)[:4]
"""Parameters with which the modes change."""

STEP = 1e-3
"""Of slopes, in standard deviations of a prior."""


def name_of(seed: int, index: int) -> str:
    """A campaign's folder."""
    return f"{PASSAGES}-{seed}-{index:04d}"


@one_thread_of_blas()
def make_passages(seed: int, index: int, folder: Path) -> str:
    """Write one campaign and its truth, unless they are there; its name.

    Parameters
    ----------
    seed, index : int
    folder : Path
        Gets `passages-SEED-INDEX/`, `truth/` and `weights/`.
    """
    name = name_of(seed, index)
    truth = Path(folder) / "truth" / f"{name}.json"
    if truth.is_file():
        return name
    drawn = draw(seed, index)
    errors = measured.draw_errors(generator(seed, index, "errors", tier=PASSAGES))
    random = generator(seed, index, "chain", tier=PASSAGES)
    errors = replace(errors, length_octaves=log_between(random, *OCTAVES), noise=log_between(random, *NOISE))
    campaign = read_campaign(write_tables(Path(folder) / name, drawn.campaign, drawn.model))
    values, beyond = true_values(campaign, generator(seed, index, "parameters", tier=PASSAGES))
    there = passed(drawn, values, track_of(drawn, values, concealed=True))
    _write(drawn, there, errors, generator(seed, index, "records", tier=PASSAGES), Path(folder) / name)
    deviance, change_dB = 0.0, 0.0
    if drawn.effect is not None:
        track = track_of(drawn, values, concealed=False)
        base, slopes = passed(drawn, values, track), []
        for one, value in beyond.items():
            moved = {**values, one: value}
            on = track_of(drawn, moved, concealed=False) if one in TRACK else track
            slopes.append(passed(drawn, moved, on))
        deviance = deviance_of(base, slopes, there, errors)
        change_dB = float(max(_change_dB(a, b) for a, b in zip(there, base, strict=True)))
        keep(Path(folder), name, deviance, [])
    write_truth(
        truth,
        {
            "format": 1,
            "tier": PASSAGES,
            "seed": seed,
            "index": index,
            "maker": "elements in time",
            "layout": "ballast",
            "records": {"passages": len(drawn.samples), "body": drawn.sensor[0]},
            "errors": {
                "size_dB": errors.size_dB,
                "length_octaves": errors.length_octaves,
                "noise": errors.noise,
            },
            "deviance": round(deviance, 4),
            "change_dB": round(change_dB, 5),
            "effects": [] if drawn.effect is None else [copy.deepcopy(drawn.effect)],
            "parameters": values,
        },
    )
    return name


def track_of(drawn: Drawn, values: Mapping[str, float], *, concealed: bool) -> Ballasted:
    """The track with values of the parameters, with or without what is concealed."""
    bodies, ones = drawn.model["line"]["bodies"], (1.0,) * len(drawn.stations)
    rail, factors = bodies["rail"], {"pad": ones, "ballast": ones}
    if concealed and drawn.effect is not None:
        law = drawn.effect["place"]["joint"]
        factors[law] = lost(ones, drawn.numbers, drawn.effect["parameters"]["factor"])
    bending = rail["youngs_modulus_Pa"] * rail["second_moment_m4"]
    return Ballasted(
        Section(bending, rail["density_kg_per_m3"] * rail["area_m2"]),
        tuple(rail["intervals_m"][0]),
        drawn.stations,
        bodies["sleeper"]["mass_kg"],
        (values["pad.k"], values["pad.c"]),
        (values["ballast.k"], values["ballast.c"]),
        factors["pad"],
        factors["ballast"],
    )


def passed(drawn: Drawn, values: Mapping[str, float], track: Ballasted) -> list[Reals]:
    """Histories of all passages over a track, m/s2, (samples,) each."""
    found, degrees = [], track.reads(*drawn.sensor)
    for number, (condition, samples) in enumerate(
        zip(drawn.campaign["conditions"], drawn.samples, strict=True), start=1
    ):
        axles = condition["axles"]
        train = Axles(
            values["load"] * np.array(axles["loads_N"]),
            np.array(axles["lags_m"]),
            values[f"speed{number}"],
            axles["entry_s"] + values[f"entry{number}"],
        )
        ramp = (axles["from_m"], axles["to_m"], axles["ramp_m"])
        found.append(track.acceleration(train, degrees, rate_Hz=RATE_HZ, samples=samples, ramp=ramp))
    return found


def deviance_of(
    base: list[Reals], slopes: list[list[Reals]], there: list[Reals], errors: measured.Errors
) -> float:
    """What the effect adds to minus two log likelihood, after parameters and the chain's error took up their part.

    To first order, as :mod:`permway.challenge.small.strength` counts it, of the lines of the band.
    """
    parts = []
    for one in base:
        lines, spectrum = _lines(one)
        sigma = errors.noise * np.abs(one).max() * np.sqrt(0.5 * one.size) / RATE_HZ
        whole = np.sqrt(sigma**2 + (measured.IDEAL * np.abs(spectrum)) ** 2)
        functions = measured.root(lines, errors.length_octaves)
        shape = (1, 1, 1, lines.size)
        parts.append(Blows(spectrum.reshape(shape), whole.reshape(shape), functions, (errors.size("sensor"), 0.0)))

    def lined(histories: list[Reals]) -> list[Complexes]:
        return [_lines(one)[1][None, None, None, :] for one in histories]

    scale = Scale(parts, [lined(one) for one in slopes], STEP)
    return scale.deviance(lined(there))


def _lines(history: Reals) -> tuple[Reals, Complexes]:
    """Lines of the band, Hz, and a history's spectrum there."""
    frequency = np.fft.rfftfreq(history.size, 1.0 / RATE_HZ)
    used = (frequency >= BAND_HZ[0]) & (frequency <= BAND_HZ[1])
    return np.asarray(frequency[used], dtype=np.float64), np.asarray(np.fft.rfft(history)[used] / RATE_HZ)


def _change_dB(there: Reals, base: Reals) -> float:
    """By how much of its own size a record is changed, in decibels of a gain that would change it so."""
    return float(np.sqrt(np.mean((there - base) ** 2) / np.mean(base**2)) / measured.NEPER_PER_DB)


def _write(
    drawn: Drawn, there: list[Reals], errors: measured.Errors, random: np.random.Generator, folder: Path
) -> None:
    """Records through one chain, whose error is the same in all passages, and with noise."""
    # Below the band as at its lower end, so that the chain answers within the record.
    fine = np.geomspace(BAND_HZ[0], 0.5 * RATE_HZ, 200)
    gain = np.log(measured.smooth(random, measured.root(fine, errors.length_octaves), errors.size("sensor")))
    for number, history in enumerate(there, start=1):
        frequency = np.fft.rfftfreq(history.size, 1.0 / RATE_HZ)
        error = np.exp(np.interp(frequency, fine, gain.real) + 1j * np.interp(frequency, fine, gain.imag))
        error[0] = abs(error[0])
        read = np.fft.irfft(np.fft.rfft(history) * error, n=history.size)
        read = read + errors.noise * np.abs(history).max() * random.standard_normal(history.size)
        content = {"fs": RATE_HZ, "acceleration": read[:, None].astype(np.float32)}
        write_arrays(folder / f"run{number}.npz", {**content, "channels": np.array(["accelerometer"])})
