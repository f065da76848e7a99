"""Trains that roll over supports: what must hold of harmonics, and an independent integration in time."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import permway
import pytest
from permway.arrays import Complexes, Reals
from permway.campaign.importers.sheet import import_sheet
from permway.campaign.predictions.motion import influence
from permway.challenge import rolling as marched
from permway.challenge.case import Case, draw, write
from permway.challenge.irregularity import profile
from permway.challenge.layout import Layout
from permway.challenge.plan import Chain
from permway.challenge.running import with_dashpots
from permway.errors import InputError
from permway.problem.model import Model
from permway.response.rolling import Kernel, kernel, kernels, rolled
from permway.response.rolling.bays import bays

LAYOUT = Layout(spans=3, bays=61, spacing_m=0.6, approach_bays=40)
SECONDS, SAMPLING_HZ, LAPS = 2.0, 1024.0, 4
SPEED = LAPS * LAYOUT.length_m / SECONDS


def case() -> Case:
    """Three short spans with layers of dashpots, as the file states."""
    drawn = draw(3, "null")
    tests = replace(
        drawn.tests,
        seconds=SECONDS,
        lines_Hz=(4.0, 400.0, 4.0),
        sensors=(("rail", 18.0),),
        points=(("rail", 18.0),),
    )
    values = with_dashpots(drawn.nominal)
    return replace(drawn, layout=LAYOUT, nominal=values, true=values, tests=tests, chain=Chain(clean=True))


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Model:
    folder = tmp_path_factory.mktemp("rolling")
    write(case(), folder / "sheet")
    return import_sheet(folder / "sheet", folder / "imported").model


@pytest.fixture(scope="module")
def wheels() -> Reals:
    return np.array(LAYOUT.wheels_m(case().true["vehicle"]))


def of(model: Model, wheels: Reals, speed: float, to_Hz: float = 700.0) -> Kernel:
    return kernel(model.line, "rail", wheels, speed_m_per_s=speed, spacing_m=0.6, to_Hz=to_Hz, temperature_C=20.0)


def under(model: Model, wheels: Reals, lines: Reals) -> Complexes:
    places = [permway.Place(body="rail", x_m=float(x), name=f"{i}") for i, x in enumerate(wheels)]
    data = permway.receptance(model.line, lines, forces=places, sensors=places, temperature_C=20.0)
    return np.asarray(data["receptance"].values)


def test_wheels_that_hardly_move_find_the_rail_of_a_standing_train(
    model: Model, wheels: Reals, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Place by place of a bay: the sum of all harmonics there."""
    monkeypatch.setattr(kernels, "_starts", lambda *_: None)
    monkeypatch.setattr(kernels, "NEAR", (5,))
    found = of(model, wheels, 1e-3, to_Hz=300.0)
    lines = np.array([5.0, 30.0, 100.0, 250.0])
    rows = np.searchsorted(found.frequency_Hz, lines)
    standing, shifted = under(model, wheels, lines), wheels + 5 * 0.6
    assert np.allclose(found.standing[rows], standing, rtol=1e-9)
    for index, source in product(range(8), range(4)):
        # Along the bay in which the wheel is.
        along = (shifted[source] - LAYOUT.station(0) + 0.075 * index) % 0.6
        ahead = along - (shifted[source] - LAYOUT.station(0)) % 0.6
        moved = (under(model, shifted + ahead, lines) - under(model, shifted, lines) + standing)[..., source]
        turns = np.exp(2j * np.pi * np.arange(-5, 6) * index / 8.0)
        summed = np.tensordot(turns, found.harmonics[..., source][:, rows], axes=1)
        assert np.abs(summed - moved).max() < 0.01 * np.abs(moved).max()


def test_a_train_that_passes_spans_does_so_wherever_it_is_taken_to_start(model: Model, wheels: Reals) -> None:
    """Receptances under a standing train depend on where in a span it stands; their mean over one does not."""
    here, there = (of(model, wheels + bays * 0.6, SPEED, to_Hz=60.0) for bays in (-3, 2))
    band = slice(20, 50)
    rolls, stands = (
        np.linalg.norm((one - other)[band]) / np.linalg.norm(other[band])
        for one, other in ((there.harmonics[3], here.harmonics[3]), (there.standing, here.standing))
    )
    assert rolls < 0.02
    assert stands > 5.0 * rolls


def test_spans_are_what_comes_back_where_a_line_has_them(model: Model, wheels: Reals) -> None:
    """Stations of the middle one, from its pier to the next."""
    starts = kernels._starts(model.line, "rail", wheels)
    assert starts is not None
    assert np.diff(starts) == pytest.approx(np.full(19, 0.6))
    assert LAYOUT.length_m / 3 <= starts[0] < starts[-1] < 2 * LAYOUT.length_m / 3
    endless = model.line.model_copy(update={"bodies": {"rail": model.line.bodies["rail"]}})
    assert kernels._starts(endless, "rail", wheels) is None


def test_a_rail_is_known_wherever_it_is_read_at_a_few_places(model: Model) -> None:
    """Between fasteners, and under a force, to a part in ten thousand of what it yields there."""
    rail, random = bays(model.line, "rail", 20.0, 24.0), np.random.default_rng(5)
    lines = np.array([5.0, 60.0, 200.0, 400.0, 700.0])

    def read(of: Reals, by: Reals) -> Complexes:
        sensors, forces = (
            [permway.Place(body="rail", x_m=float(x), name=f"{i}") for i, x in enumerate(places)]
            for places in (of, by)
        )
        data = permway.receptance(model.line, lines, forces=forces, sensors=sensors, temperature_C=20.0)
        return np.asarray(data["receptance"].values)

    squared = (2.0 * np.pi * lines)[:, None] ** 2
    for y in random.uniform(21.0, 23.0, 4):
        x = np.append(random.uniform(20.0, 24.0, 6), y + np.array([-0.02, 0.0, 0.1]))
        to, still, moving = rail.shares(x)
        (by,), by_still, by_moving = rail.shares(np.array([y]))
        grid = read(rail.read_m, rail.read_m[by : by + 4])
        columns = np.einsum("fxb,fb->fx", grid, by_still[:, 0] + squared * by_moving[:, 0])
        shares = still + squared[:, :, None] * moving
        found = sum(shares[:, k] * columns[:, to + k] for k in range(4))
        at_once, by_mass = rail.beyond(x, y)
        found = found + at_once + squared * by_mass
        true = read(x, np.array([y]))[..., 0]
        off = np.abs(found - true).max(axis=1) / np.abs(true).max(axis=1)
        assert off[:4].max() < 1e-4
        assert off[4] < 1e-3


def test_a_train_that_rolls_not_at_all_stands(model: Model, wheels: Reals) -> None:
    assert model.train is not None
    vehicle, contact = model.train.vehicle, model.train.contact.receptance(model.train.vehicle.share)
    lines = np.arange(4.0, 300.0, 7.0)
    track = under(model, wheels, lines)
    still = rolled(vehicle, contact, lines, track, of(model, wheels, SPEED), speed_m_per_s=SPEED, share=0.0)
    assert np.allclose(still.per_profile[3], influence(model, lines, track), rtol=1e-9)
    assert np.abs(np.delete(still.per_profile, 3, axis=0)).max() == 0.0
    assert np.abs(still.lines).max() == 0.0


def test_rolling_agrees_with_an_integration_in_time(
    model: Model, wheels: Reals, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Line by line with its phase, of finite elements that share no code: where a standing train is far off."""
    monkeypatch.setattr(marched, "FINER", 4)
    monkeypatch.setattr(marched, "BEFORE_S", 2.0)
    samples = round(SECONDS * SAMPLING_HZ)
    frequency = np.fft.rfftfreq(samples, 1.0 / SAMPLING_HZ)
    random = np.random.default_rng(4)
    met = profile(random, np.zeros_like, samples=samples, sampling_Hz=SAMPLING_HZ, speed=SPEED)
    met[(frequency < 0.5) | (frequency > 440.0)] = 0.0
    plan = case().plan()
    theirs = marched.rolled(plan, met, SPEED, samples=samples, sampling_Hz=SAMPLING_HZ)
    # There the first wheel begins at a station; here it stands where the sheet has it.
    late = (wheels[0] % LAYOUT.spacing_m) / SPEED
    rolls, stands, kept = solved(model, wheels, met, frequency, late)
    channels = theirs[kept][:, :5]
    lines = frequency[kept]
    passing = round(SPEED / LAYOUT.spacing_m * SECONDS) / SECONDS
    off = {}
    for name, ours in (("rolls", rolls), ("stands", stands)):
        for where, low, high in (
            ("low", 10.0, 60.0),
            ("high", 130.0, 240.0),
            ("passing", passing - 0.1, passing + 0.1),
            ("twice", 2.0 * passing - 0.1, 2.0 * passing + 0.1),
        ):
            band = (lines > low) & (lines < high)
            off[name, where] = np.linalg.norm((ours - channels)[band], axis=0) / np.linalg.norm(
                channels[band], axis=0
            )
    assert off["rolls", "low"].max() < 0.09
    assert off["rolls", "high"].max() < 0.04
    assert off["stands", "high"].min() > 0.2
    assert off["rolls", "passing"].max() < 0.02
    assert off["rolls", "twice"].max() < 0.1
    assert min(off["stands", where].min() for where in ("passing", "twice")) > 0.8


def solved(
    model: Model, wheels: Reals, met: Complexes, frequency: Reals, late: float
) -> tuple[Complexes, Complexes, np.ndarray]:
    """Accelerations of four wheelsets and a bogie as the solver has them, rolling and standing; the lines kept."""
    assert model.train is not None
    vehicle, contact = model.train.vehicle, model.train.contact.receptance(model.train.vehicle.share)
    degrees = [
        vehicle.degrees.index(f"car1.{name}")
        for name in ("wheelset1", "wheelset2", "wheelset3", "wheelset4", "bogie1.bounce")
    ]
    kept = np.flatnonzero((frequency > 4.0) & (frequency < 260.0))
    lines, size = frequency[kept], 2 * (met.size - 1)
    track, behind = under(model, wheels, lines), wheels[0] - wheels
    by = rolled(vehicle, contact, lines, track, of(model, wheels, SPEED), speed_m_per_s=SPEED)
    whole = np.concatenate([met, met[-2:0:-1].conj()])

    def under_wheels(bins: np.ndarray) -> Complexes:
        at = bins * SAMPLING_HZ / size
        heights = np.where(np.abs(bins) < size // 2, whole[bins % size], 0.0)
        return heights[:, None] * np.exp(2j * np.pi * at[:, None] * (late - behind / SPEED))

    step = round(by.passing_Hz * SECONDS)
    rolls = sum(
        np.einsum("fdw,fw->fd", part[:, degrees], under_wheels(kept + int(order) * step))
        for order, part in zip(by.orders, by.per_profile, strict=True)
    )
    for number, amplitudes in enumerate(by.lines[:2], start=1):
        rolls[kept == number * step] += 0.5 * size * amplitudes[degrees]
    stands = np.einsum("fdw,fw->fd", influence(model, lines, track)[:, degrees], under_wheels(kept))
    back = (np.exp(-2j * np.pi * lines * late) * -((2.0 * np.pi * lines) ** 2))[:, None]
    return rolls * back, stands * back, kept


@pytest.mark.parametrize("wrong", [{"speed_m_per_s": 0.0}, {"spacing_m": np.nan}, {"to_Hz": -1.0}])
def test_faults_of_use_are_reported(model: Model, wheels: Reals, wrong: dict[str, float]) -> None:
    given = {"speed_m_per_s": 60.0, "spacing_m": 0.6, "to_Hz": 100.0, **wrong}
    with pytest.raises(InputError, match=f"{next(iter(wrong))}: must be above zero"):
        kernel(model.line, "rail", wheels, temperature_C=20.0, **given)
