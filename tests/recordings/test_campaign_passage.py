"""Records of passages: closed forms of moving forces, the passage that is predicted already, what is refused.

A hysteretic beam and one with viscous modal damping of half its loss factor differ by about the loss factor, for
(1 + i eta) turns what the beam does by eta at every frequency. The differences are held to 1.5 times that. What
Richardson's extrapolation of them to no loss leaves is 2e-4 of displacements; 1e-3 of strain and moment, by three
points 24 mm apart and modes left out; and of second order in the loss at resonance, 1.4e-3 of velocity and 2.4e-3
of acceleration.
"""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import passages
import pytest
from permway.campaign.campaign import read_campaign
from permway.campaign.passage import spectrum_of
from permway.campaign.predict import predict
from permway.errors import InputError
from permway.model.line import Line
from permway.model.place import Place
from permway.model.vehicle import STANDARD_GRAVITY
from permway.response.passby import Axles, couple, passby
from permway.response.passby.sprung import SprungMass
from scipy.interpolate import CubicSpline

LEFT = {"w": 3e-4, "v": 2e-3, "a": 3e-3, "e": 1.5e-3, "M": 1.5e-3}


def noisy(values: np.ndarray) -> np.ndarray:
    """With a trace of noise, which the time before the train must tell."""
    return values + 1e-6 * np.abs(values).max() * np.random.default_rng(1).standard_normal(values.size)


def differences(folder: Path, eta: float, window_s: float, **deck: float) -> dict[str, np.ndarray]:
    """Predicted less closed form, over the largest of the closed form's spectrum, (frequency,) by sensor."""
    time = passages.time_s()
    columns = {name: noisy(passages.history(name, time, 0.5 * eta)) for name in "wvaeM"}
    table = passages.campaign("wvaeM")
    table["records"][0]["window_s"] = window_s
    campaign = read_campaign(passages.write(folder, columns, table=table, **({"loss_factor": eta} | deck)))
    (dataset,) = campaign.load()
    (found,) = predict(campaign, [dataset], threads=1)
    measured, predicted = dataset.data["spectrum"].values, found["spectrum"].values
    size = np.abs(measured).max(axis=1, keepdims=True)
    return dict(zip("wvaeM", (predicted - measured) / size, strict=True))


def test_moving_forces_over_a_beam_of_little_loss(tmp_path: Path) -> None:
    coarse, fine = differences(tmp_path / "a", 0.02, 60.0), differences(tmp_path / "b", 0.01, 120.0)
    for name in "wvaeM":
        assert np.abs(coarse[name]).max() < 1.5 * 0.02, name
        assert np.abs(fine[name]).max() < 1.5 * 0.01, name
        assert np.abs(2.0 * fine[name] - coarse[name]).max() < LEFT[name], name


def test_moving_forces_over_a_beam_of_one_damping_ratio(tmp_path: Path) -> None:
    """The closed form's own damping: what is left is its modes, and the window's ends."""
    found = differences(tmp_path, 0.04, 60.0, loss_factor=0.0, damping_ratio=0.02)
    for name in "wvaeM":
        assert np.abs(found[name]).max() < 1e-3, name


def test_a_moment_that_goes_with_speed_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"sensors\.M.*goes with its speed.*damping_ratio"):
        differences(tmp_path, 0.02, 20.0, stiffness_damping_s=1e-4)


def predicted_history(quantity: str, x_m: float, window_s: float) -> np.ndarray:
    """What :func:`permway.response.passby.passby` predicts at the record's times, SI."""
    axles = Axles(lags_m=passages.LAGS_M, loads_N=passages.LOADS_N, speed_m_per_s=passages.SPEED, body="deck")
    line = Line.model_validate(passages.model()["line"])
    place = [Place(body="deck", x_m=x_m)]
    data = passby(line, axles, sensors=place, highest_Hz=60.0, quantity=quantity, window_s=window_s, threads=1)
    spline = CubicSpline(data["time"].values + passages.ENTRY_S, data["history"].values[0, 0])
    return np.asarray(spline(passages.time_s()))


def test_it_is_the_passage_that_is_predicted_already(tmp_path: Path) -> None:
    columns = {
        "w": noisy(1e3 * predicted_history("displacement", 12.0, 20.0)),
        "a": noisy(predicted_history("acceleration", 8.0, 20.0)),
    }
    table = passages.campaign("wa")
    table["records"][0]["window_s"] = 20.0
    campaign = read_campaign(passages.write(tmp_path, columns, table=table))
    (dataset,) = campaign.load()
    (found,) = predict(campaign, [dataset], threads=1)
    measured = dataset.data["spectrum"].values
    off = np.abs(found["spectrum"].values - measured).max(axis=1) / np.abs(measured).max(axis=1)
    # Accelerations are cut at 18.75 and at 60 Hz, and what lies between is cut off by the ends of the record.
    assert off[0] < 5e-5
    assert off[1] < 1e-3


def changed(folder: Path, **axles: Any) -> np.ndarray:
    """Predicted spectra with other keys of the axles."""
    time = passages.time_s()
    columns = {name: noisy(passages.history(name, time, 0.02)) for name in "wae"}
    table = passages.campaign("wae")
    table["conditions"][0]["axles"] |= axles
    table["parameters"] = []
    table["records"][0]["window_s"] = 20.0
    campaign = read_campaign(passages.write(folder, columns, table=table))
    (found,) = predict(campaign, campaign.load(), threads=1)
    return np.asarray(found["spectrum"].values)


def assert_alike(one: np.ndarray, other: np.ndarray, share: float) -> None:
    """To a share of the largest of each sensor."""
    assert (np.abs(one - other) < share * np.abs(other).max(axis=1, keepdims=True)).all()


def test_loads_add_up_and_scale(tmp_path: Path) -> None:
    whole = changed(tmp_path / "a")
    front = changed(tmp_path / "b", loads_N=[1.2e5, 1.2e5], lags_m=[0.0, 2.5])
    late = passages.ENTRY_S + 17.5 / passages.SPEED
    rear = changed(tmp_path / "c", loads_N=[1.4e5, 1.4e5], lags_m=[0.0, 2.5], entry_s=late)
    assert_alike(front + rear, whole, 1e-6)
    assert changed(tmp_path / "d", load_factor=1.3) == pytest.approx(1.3 * whole)


def test_a_train_that_runs_back_is_the_mirror_image(tmp_path: Path) -> None:
    """At mid span both are the same; at 8 m a sensor reads what one at 16 m reads of the other direction."""
    forward, backward = changed(tmp_path / "a"), changed(tmp_path / "b", direction="backward")
    assert_alike(backward[[0, 2]], forward[[0, 2]], 1e-5)
    table = passages.campaign("wae")
    table["sensors"][1]["x_m"] = passages.LENGTH_M - 8.0
    table["records"][0]["window_s"] = 20.0
    time = passages.time_s()
    columns = {name: noisy(passages.history(name, time, 0.02)) for name in "wae"}
    campaign = read_campaign(passages.write(tmp_path / "c", columns, table=table))
    (found,) = predict(campaign, campaign.load(), threads=1)
    assert_alike(backward[1:2], found["spectrum"].values[1:2], 1e-5)
    assert np.abs(backward[1] - forward[1]).max() > 0.1 * np.abs(forward[1]).max()


def test_a_record_that_begins_under_the_train(tmp_path: Path) -> None:
    """A second cut off its beginning is predicted as the same second of the whole."""
    time = passages.time_s()
    values = passages.history("w", time, 0.005)
    table = passages.campaign("w")
    table["sensors"][0]["chain"] = {"noise_floor": 1e-8}
    table["records"][0]["window_s"] = 80.0
    whole = read_campaign(passages.write(tmp_path / "a", {"w": values}, table=table, loss_factor=0.01))
    late = copy.deepcopy(table)
    late["conditions"][0]["axles"]["entry_s"] = passages.ENTRY_S - 1.0
    folder = tmp_path / "b"
    path = passages.write(folder, {"w": values}, table=late, loss_factor=0.01)
    rows = (folder / "run.csv").read_text(encoding="utf-8").splitlines()
    shifted = [f"{float(row.split(',')[0]) - 1.0:.9g},{row.split(',')[1]}" for row in rows[201:]]
    (folder / "run.csv").write_text("\n".join([rows[0], *shifted]) + "\n", encoding="utf-8")
    cut = read_campaign(path)
    (dataset,) = cut.load()
    (found,) = predict(cut, [dataset], threads=1)
    # The closed form, cut as well, is as near as it is to the whole.
    (given,) = whole.load()
    (before,) = predict(whole, [given], threads=1)
    off = [
        np.abs(p["spectrum"].values - d.data["spectrum"].values).max() / np.abs(d.data["spectrum"].values).max()
        for p, d in ((before, given), (found, dataset))
    ]
    assert off[0] < 1.1 * 0.01
    assert off[1] < 1.1 * 0.01


def test_noise_is_that_of_the_time_before_the_train(tmp_path: Path) -> None:
    time = passages.time_s()
    sd = 0.02
    values = passages.history("w", time, 0.02) + sd * np.random.default_rng(5).standard_normal(time.size)
    campaign = read_campaign(passages.write(tmp_path / "a", {"w": values}))
    (dataset,) = campaign.load()
    reported = dataset.data["noise_sd"].values[0, 0]
    # So much does white noise of this size scatter the real part of a line.
    lines = spectrum_of(1e-3 * sd * np.random.default_rng(6).standard_normal((400, time.size)), passages.RATE_HZ)
    assert reported == pytest.approx(lines[:, 40].real.std(), rel=0.15)
    table = passages.campaign("w")
    table["sensors"][0]["chain"] = {"noise_floor": 2.0 * sd**2 / passages.RATE_HZ}
    stated = read_campaign(passages.write(tmp_path / "b", {"w": values}, table=table))
    (other,) = stated.load()
    assert other.data["noise_sd"].values[0, 0] == pytest.approx(reported, rel=0.15)


def late_entry(table: dict) -> None:
    table["conditions"][0]["axles"]["entry_s"] = 0.05


def no_band(table: dict) -> None:
    del table["records"][0]["band_Hz"]


def high_band(table: dict) -> None:
    table["records"][0]["band_Hz"] = [0.1, 90.0]


def short_window(table: dict) -> None:
    table["records"][0]["window_s"] = 4.0


def past(table: dict) -> None:
    table["conditions"][0]["axles"]["entry_s"] = 9.0


def unequal(table: dict) -> None:
    table["conditions"][0]["axles"]["loads_N"] = [1e5]


def no_axles(table: dict) -> None:
    del table["conditions"][0]["axles"]


def no_speed(table: dict) -> None:
    del table["conditions"][0]["speed_m_per_s"]


def hammer(table: dict) -> None:
    table["conditions"][0]["kind"] = "hammer"
    del table["conditions"][0]["speed_m_per_s"]


def no_height(table: dict) -> None:
    table["sensors"][0] = {"name": "w", "body": "deck", "x_m": 12.0, "quantity": "strain", "unit": "um/m"}


def at_the_end(table: dict) -> None:
    table["sensors"][0] |= {"quantity": "strain", "unit": "um/m", "height_m": 0.9, "x_m": 0.0}
    table["records"][0]["unit"] = "um/m"


def elsewhere(table: dict) -> None:
    table["conditions"][0]["axles"]["body"] = "rail"


def strain_of_spectra(table: dict) -> None:
    table["sensors"][0] |= {"quantity": "strain", "unit": "um/m", "height_m": 0.9}
    table["conditions"].append({"name": "still", "kind": "hammer"})
    table["forces"] = [{"name": "hit", "body": "deck", "x_m": 12.0}]
    table["records"][0] = {
        "name": "run",
        "file": "run.csv",
        "condition": "still",
        "statistic": "frf",
        "averages": 4,
        "responses": {"w": "w"},
        "references": {"w": "hit"},
    }


@pytest.mark.parametrize(
    ("amend", "words"),
    [
        (late_entry, "nothing states the noise"),
        (no_band, "predicted up to the end of its band"),
        (high_band, "reaches beyond 80 Hz"),
        (short_window, "is shorter than record and passage"),
        (past, "the record is over"),
        (unequal, "1 loads for 4 axles"),
        (no_axles, 'goes with kind = "passage"'),
        (no_speed, "axles need speed"),
        (hammer, 'goes with kind = "passage"'),
        (no_height, 'goes with quantity = "strain"'),
        (at_the_end, "read 0.024 m and more from its ends"),
        (elsewhere, "wheels run on a beam"),
        (strain_of_spectra, "a sensor of strain goes with"),
    ],
)
def test_what_is_refused(tmp_path: Path, amend, words: str) -> None:
    table = passages.campaign("w")
    amend(table)
    values = noisy(passages.history("w", passages.time_s(), 0.02))
    with pytest.raises(InputError, match=words):
        read_campaign(passages.write(tmp_path, {"w": values}, table=table)).load()


def test_a_window_in_which_the_line_does_not_rest_is_refused(tmp_path: Path) -> None:
    values = noisy(passages.history("a", passages.time_s(), 0.001))
    table = passages.campaign("a")
    table["records"][0]["window_s"] = 20.0
    campaign = read_campaign(passages.write(tmp_path, {"a": values}, table=table, loss_factor=0.002))
    with pytest.raises(InputError, match="still moves where the window"):
        predict(campaign, campaign.load(), threads=1)


def test_strain_of_a_timoshenko_beam_is_refused(tmp_path: Path) -> None:
    values = noisy(passages.history("e", passages.time_s(), 0.02))
    shear = {"theory": "timoshenko", "shear_modulus_Pa": 1.4e10, "shear_coefficient": 0.8}
    campaign = read_campaign(passages.write(tmp_path, {"e": values}, **shear))
    with pytest.raises(InputError, match="of Euler beams"):
        predict(campaign, campaign.load(), threads=1)


def sprung(folder: Path, eta: float, direction: str) -> tuple[np.ndarray, np.ndarray]:
    """Predicted less marched in time, and how much the springs do, over the largest of the spectrum.

    A sixth of the beam's mass, whose bounce is near the beam's own frequency.
    """
    mass, unsprung, entry = 4e4, 4e3, passages.ENTRY_S
    spring = {"stiffness_N_per_m": 2.5e7, "damping_Ns_per_m": 4e5}
    contact, window_s = 4e8, 1.2 / eta
    x = 8.0 if direction == "forward" else passages.LENGTH_M - 8.0
    data = couple(
        Line.model_validate(passages.model(eta)["line"]),
        SprungMass(mass_kg=mass, wheel_mass_kg=unsprung, **spring),
        speed_m_per_s=passages.SPEED,
        contact_N_per_m=contact,
        step_s=0.0015,
        sensors=[Place(body="deck", x_m=x)],
        body="deck",
        after_s=3.0,
        window_s=window_s,
    )
    time = passages.time_s()
    spline = CubicSpline(data["time"].values + entry, data["displacement"].values[0])
    read = np.where(time < entry, 0.0, spline(np.maximum(time, entry)))
    table = passages.campaign("w")
    table["sensors"][0]["x_m"] = 8.0
    axles = {"loads_N": [(mass + unsprung) * STANDARD_GRAVITY], "lags_m": [0.0], "direction": direction}
    table["conditions"][0]["axles"] |= axles
    table["parameters"] = []
    table["records"][0]["window_s"] = window_s
    found = []
    for name, more in (
        ("springs", {"suspension": spring | {"unsprung_kg": unsprung, "contact_N_per_m": contact}}),
        ("none", {}),
    ):
        table["conditions"][0]["axles"] |= more
        place = folder / f"{name}-{eta}"
        campaign = read_campaign(passages.write(place, {"w": noisy(1e3 * read)}, table=table, loss_factor=eta))
        (dataset,) = campaign.load()
        found.append(predict(campaign, [dataset], threads=1)[0]["spectrum"].values[0])
        table["conditions"][0]["axles"].pop("suspension", None)
    measured = dataset.data["spectrum"].values[0]
    size = np.abs(measured).max()
    return (found[0] - measured) / size, (found[1] - found[0]) / size


@pytest.mark.parametrize("direction", ["forward", "backward"])
def test_an_axle_on_springs_is_what_is_marched_in_time(direction: str, tmp_path: Path) -> None:
    (coarse, change), (fine, _) = (sprung(tmp_path, eta, direction) for eta in (0.04, 0.02))
    assert np.abs(coarse).max() < 1.5 * 0.04
    assert np.abs(2.0 * fine - coarse).max() < 3e-4
    assert np.abs(change).max() > 0.1


def test_an_axle_heavier_than_its_load_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"suspension\.unsprung_kg"):
        changed(tmp_path, suspension={"stiffness_N_per_m": 1e6, "damping_Ns_per_m": 1e4, "unsprung_kg": 2e5})


def test_axles_that_bounce_on_beyond_the_window_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"suspension\.damping_Ns_per_m.*window_s = [0-9.]+"):
        changed(tmp_path, suspension={"stiffness_N_per_m": 1e6, "damping_Ns_per_m": 1e3})


def test_a_window_holds_the_bounce_of_axles_unless_it_is_stated(tmp_path: Path) -> None:
    mass = passages.LOADS_N[0] / STANDARD_GRAVITY
    time = passages.time_s()
    seconds = []
    for rate in (0.2, 0.4):
        table = passages.campaign("w")
        spring = {"stiffness_N_per_m": 1e6, "damping_Ns_per_m": 2.0 * mass * rate}
        table["conditions"][0]["axles"] |= {
            "loads_N": [passages.LOADS_N[0]],
            "lags_m": [0.0],
            "suspension": spring,
        }
        table["parameters"] = []
        columns = {"w": noisy(passages.history("w", time, 0.02))}
        campaign = read_campaign(passages.write(tmp_path / str(rate), columns, table=table))
        (dataset,) = campaign.load()
        assert np.isfinite(predict(campaign, [dataset], threads=1)[0]["spectrum"].values).all()
        seconds.append(dataset.data.attrs["window_samples"] / passages.RATE_HZ)
    assert seconds[0] > 6.0 / 0.2 > seconds[1] > 6.0 / 0.4
