"""One small campaign from seed and index: files, and its truth in a folder of its own."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from permway.campaign.campaign import Campaign, read_campaign
from permway.challenge.beams import Complexes
from permway.challenge.small import errors as measured
from permway.challenge.small.by_elements import STEP, ByElements
from permway.challenge.small.by_model import ByModel
from permway.challenge.small.draws import TIER, generator
from permway.challenge.small.elements_effects import PATH
from permway.challenge.small.kinds import FAULTS, Maker, NoiseTells, conceal, draw_kind
from permway.challenge.small.layouts import draw_layout
from permway.challenge.small.places import BLOWS, RUN_S, SAMPLING_HZ, Tests, draw_tests
from permway.challenge.small.stated import Small, noise_of, noisier, parts_of, truth_of
from permway.challenge.small.strength import Scale
from permway.challenge.small.write import write_arrays, write_tables, write_truth
from permway.challenge.weigh import keep
from permway.diagnosis.catalogue import entries
from permway.diagnosis.side_by_side import one_thread_of_blas


def name_of(seed: int, index: int) -> str:
    """A campaign's folder."""
    return f"{TIER}-{seed}-{index:04d}"


@one_thread_of_blas()
def make_small(seed: int, index: int, folder: Path) -> str:
    """Write one campaign and its truth, unless they are there; its name.

    With one thread of BLAS: sums in another order would be other bytes.

    Parameters
    ----------
    seed, index : int
    folder : Path
        Gets `small-SEED-INDEX/`, `truth/` and `weights/`.
    """
    name = name_of(seed, index)
    truth = Path(folder) / "truth" / f"{name}.json"
    if truth.is_file():
        return name
    small = draw_small(seed, index, Path(folder) / name)
    _measure(small, generator(seed, index, "noise"), Path(folder) / name)
    deviance, *each = small.deviances()
    if small.chosen:
        keep(Path(folder), name, deviance, each)
    write_truth(truth, truth_of(small, seed, index, deviance))
    return name


def draw_small(seed: int, index: int, folder: Path) -> Small:
    """Draw a campaign; its two tables are written, for they are read again as any campaign's.

    Parameters
    ----------
    seed, index : int
    folder : Path
        Of the campaign.
    """
    random = generator(seed, index, "layout")
    by_elements = bool(random.random() < 0.5)
    layout = draw_layout(random)
    tests = draw_tests(random, layout, runs=not by_elements)
    errors = measured.draw_errors(generator(seed, index, "errors"))
    campaign = read_campaign(write_tables(folder, tests.campaign, tests.model))
    values, beyond = true_values(campaign, generator(seed, index, "parameters"))
    maker: Maker = (
        ByElements(tests, layout, values, beyond) if by_elements else ByModel(campaign, tests, layout, values)
    )
    scale = Scale(parts_of(maker.base, tests, errors, measured.ROUNDING), maker.slopes(), STEP)
    random = generator(seed, index, "effects")
    kind = draw_kind(random)
    drawn = [*PATH, *FAULTS] if by_elements else _possible(tests)
    names = [name for name in drawn if name not in NEVER]
    chosen = conceal(random, maker, scale, kind, names, _noise_tells(tests))
    return Small(campaign, layout, tests, errors, maker, scale, chosen, values)


NEVER = ("beam_damping", "bearing_rotation", "girder_shear", "level_friction", "level_stiffness")
"""Entries younger than the published seeds: with them each seed would draw other campaigns."""


def _possible(tests: Tests) -> list[str]:
    """Entries of the catalogue that may be there: of train and profile only where something runs."""
    running = tests.speed_m_per_s is not None
    return [
        name for name, entry in sorted(entries().items()) if running or entry.DOMAIN in ("path", "measurement")
    ]


def true_values(campaign: Campaign, random: np.random.Generator) -> tuple[dict[str, float], dict[str, float]]:
    """True parameters, drawn from their priors, and the same one step of slopes away."""
    values, beyond = {}, {}
    for name, known in campaign.parameters.known.items():
        z = float(random.standard_normal())
        values[name], beyond[name] = float(known.value(z)), float(known.value(z + STEP))
    return values, beyond


def _noise_tells(tests: Tests) -> NoiseTells:
    """Deviance of factors on noise: twice the divergence of the exponential densities of all blows and lines."""
    count = 2 * (BLOWS - 1) * tests.frequency_Hz.size * len(tests.forces) * len(tests.temperatures_C)
    on_line = {sensor["name"] for sensor in tests.sensors}

    def states(factors: dict[str, float]) -> float:
        known = [q for name, q in factors.items() if name in on_line]
        return float(sum(0.5 * count * (q - 1.0 - np.log(q)) for q in known))

    return states


def _measure(small: Small, random: np.random.Generator, folder: Path) -> None:
    """Write the records."""
    tests, errors = small.tests, small.errors
    factors = noisier(small.effects)
    powers = np.array([factors.get(sensor["name"], 1.0) for sensor in tests.sensors])
    noise = noise_of(small.maker.base[0], errors, powers)
    there = small.maker.responses(small.effects)
    functions = measured.root(tests.frequency_Hz, errors.length_octaves)

    def gains(kind: str, count: int) -> Complexes:
        return np.array([measured.smooth(random, functions, errors.size(kind)) for _ in range(count)])

    sensors, points = gains("sensor", len(tests.sensors)), gains("force", len(tests.forces))
    for index, values in enumerate(there[0]):
        read = values * sensors[:, None, :] * points[None, :, :]
        frf, coherence = measured.struck(random, read, noise[index], BLOWS)
        content = {
            "f": tests.frequency_Hz,
            "frf": np.moveaxis(frf, -1, 0).astype(np.complex64),
            "coh": np.moveaxis(coherence, -1, 0).astype(np.float32),
            "sensor": np.array([sensor["name"] for sensor in tests.sensors]),
            "hammer": np.array([force["name"] for force in tests.forces]),
        }
        write_arrays(folder / f"blows{index + 1}.npz", content)
    if tests.speed_m_per_s is not None:
        _run(small, random, folder)


def _run(small: Small, random: np.random.Generator, folder: Path) -> None:
    names = list(small.tests.campaign["records"][-1]["channels"])
    frequency, density = small.maker.in_detail(small.effects)
    functions = measured.root(frequency, small.errors.length_octaves)
    size = small.errors.size("sensor")
    gains = np.array([measured.smooth(random, functions, size) for _ in names]).T
    density = density * gains[:, :, None] * gains.conj()[:, None, :]
    series = measured.run_in_time(random, frequency, density, SAMPLING_HZ, RUN_S)
    content = {"fs": SAMPLING_HZ, "acceleration": series.astype(np.float32), "channels": np.array(names)}
    write_arrays(folder / "run.npz", content)
