"""Predictions of what sensors saw, against closed forms and against the solver asked another way."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from campaigns import small, tables, write
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.load import Dataset, log_variance
from permway.campaign.predict import plan, predict, request_of
from permway.campaign.predictions.run import solved_lines
from permway.campaign.predictions.sweeps import Request, Result
from permway.errors import InputError
from permway.model.place import Place
from permway.recordings.estimates.decay_rate import grid_positions, track_decay_rate
from permway.response.receptance import receptance
from permway.response.train import train_response

FREQUENCY = np.arange(10.0, 121.0, 2.0)


def blank(campaign: Campaign, name: str, variable: str, **coordinates: Any) -> Dataset:
    """A dataset of zeros with the coordinates of a record."""
    record = next(r for r in campaign.stated.records if r.name == name)
    shape = [len(c) for c in coordinates.values()]
    data = xr.Dataset({variable: (list(coordinates), np.zeros(shape, dtype=complex))}, coords=coordinates)
    return Dataset(record, campaign.condition(record.condition), data)


def blows(campaign: Campaign) -> Dataset:
    return blank(
        campaign, "blows", "frf", sensor=["rail@12", "deck@6"], force=["hit", "hit far"], frequency=FREQUENCY
    )


def run(campaign: Campaign, frequency: np.ndarray = FREQUENCY) -> Dataset:
    names = ["axle", "floor"]
    dataset = blank(campaign, "run", "csd", channel=names, channel2=names, frequency=frequency)
    dataset.data["psd"] = (("channel", "frequency"), np.zeros((2, frequency.size)))
    return dataset


def test_a_hammer_test_is_receptance_through_the_chains(tmp_path: Path) -> None:
    campaign, model = tables()
    chain = {"gain": 1.1, "delay_s": 1e-3, "polarity": -1, "mount_Hz": 900.0, "mount_loss_factor": 0.1}
    campaign["sensors"][0]["chain"] = chain
    campaign["sensors"][1]["direction"] = "up"
    campaign["forces"][1]["chain"] = {"gain": 0.5}
    read = read_campaign(write(tmp_path, campaign, model))
    predicted = predict(read, [blows(read)], threads=1)[0]["frf"]
    points = [Place(body="rail", x_m=12.0, name="a"), Place(body="rail", x_m=15.3, name="b")]
    sensors = [Place(body="rail", x_m=12.0, name="c"), Place(body="deck", x_m=6.0, name="d")]
    # Asked the direct way: forces where the hammer strikes.
    h = receptance(read.model.line, FREQUENCY, forces=points, sensors=sensors, threads=1)["receptance"].values
    omega = 2.0 * np.pi * FREQUENCY
    mount = (1 + 0.1j) / (1 + 0.1j - (FREQUENCY / 900.0) ** 2)
    first = -(omega**2) * h[:, 0, 0] * -1.1 * np.exp(-1j * omega * 1e-3) * mount
    last = -1j * omega * h[:, 1, 1] / 0.5
    assert predicted.sel(sensor="rail@12", force="hit").values == pytest.approx(first, rel=1e-9)
    assert predicted.sel(sensor="deck@6", force="hit far").values == pytest.approx(last, rel=1e-9)
    assert predicted.dims == ("sensor", "force", "frequency")


def test_records_of_one_temperature_and_of_the_same_lines_share_one_solve(tmp_path: Path) -> None:
    campaign = small(tmp_path)
    hammer, train = (request_of(campaign, d) for d in (blows(campaign), run(campaign)))
    assert hammer is not None
    assert train is not None
    mine = Request(hammer.temperature_C, hammer.frequency_Hz.copy(), (("rail", 1.0),), (("rail", 2.0),))
    shared, wheels = plan([hammer, mine, train])
    # Two sensors, and one place of another record; four wheels push at lines of their own.
    assert len(shared.forces) == 3
    assert len(wheels.forces) == 4
    cold = Request(-10.0, hammer.frequency_Hz, (("rail", 1.0),), (("rail", 2.0),))
    assert len(plan([cold, hammer, mine])) == 2
    answer = Result(shared, np.zeros((shared.frequency_Hz.size, len(shared.sensors), 3), dtype=complex))
    with pytest.raises(InputError, match="pair is not in the sweep"):
        answer.of(Request(hammer.temperature_C, FREQUENCY, (("deck", 1.0),), (("rail", 2.0),)))
    with pytest.raises(InputError, match="of another temperature, factor or frequency"):
        answer.of(Request(hammer.temperature_C, np.array([0.123]), (("rail", 12.0),), (("rail", 12.0),)))


def test_a_run_is_the_trains_response(tmp_path: Path) -> None:
    """With a long segment the window is narrow, and the density that of the train's response."""
    campaign, model = tables()
    campaign["records"][1]["segment_s"] = 100.0
    read = read_campaign(write(tmp_path, campaign, model))
    frequency = np.array([8.0, 20.0, 33.0])
    predicted = predict(read, [run(read, frequency)], threads=1)[0]
    assert read.model.train is not None
    assert read.model.irregularity is not None
    known = train_response(
        read.model.line, read.model.train, read.model.irregularity, frequency, temperature_C=12.0, threads=1
    )
    wheel = known["vehicle_acceleration_psd"].sel(degree="car1.wheelset1").values + 1e-6
    body = known["vehicle_acceleration_psd"].sel(degree="car1.body.bounce").values
    assert predicted["psd"].values[0] == pytest.approx(wheel, rel=0.02)
    assert predicted["psd"].values[1] == pytest.approx(body, rel=0.02)
    # One profile drives all: fully coherent, with the phase of the pseudo-response; the floor looks up.
    matrix = predicted["csd"].values
    coherence = np.abs(matrix[0, 1]) ** 2 / (wheel * matrix[1, 1].real)
    assert coherence == pytest.approx(1.0, abs=0.01)
    assert matrix[0, 1] == pytest.approx(matrix[1, 0].conj())


def test_level_and_slope_move_the_spectrum(tmp_path: Path) -> None:
    campaign = small(tmp_path)
    quiet = campaign.with_values({"level": 3.0})
    base, louder = (predict(c, [run(c)], threads=1)[0]["csd"].values[0, 1] for c in (campaign, quiet))
    assert louder == pytest.approx(10.0**0.3 * base, rel=1e-9)


def test_interpolation_weakens_what_comes_late(tmp_path: Path) -> None:
    """Wheel 3 meets the profile a lag tau later: halfway between lines only |cos(pi tau df)| is left of it."""
    campaign, model = tables()
    campaign["sensors"][3] = {"name": "floor", "degree": "car1.wheelset3", "unit": "m/s2"}
    campaign["records"][1]["interpolated_Hz"] = [[0.0, 1.0]]
    # Lines of the estimate far closer than those of the interpolation.
    campaign["records"][1]["segment_s"] = 64.0
    late = read_campaign(write(tmp_path, campaign, model))
    del campaign["records"][1]["interpolated_Hz"]
    exact = read_campaign(write(tmp_path, campaign, model))
    frequency = np.array([39.5, 40.0, 40.5])
    ratios = []
    for read in (late, exact):
        psd = predict(read, [run(read, frequency)], threads=1)[0]["psd"].values
        ratios.append(psd[1] / psd[0])
    tau = 17.5 / 50.0
    left = ratios[0] / ratios[1]
    assert left[[0, 2]] == pytest.approx(np.cos(np.pi * tau) ** 2, abs=0.03)
    assert left[1] == pytest.approx(1.0, abs=0.03)


def test_lines_to_solve_at() -> None:
    plain = solved_lines(np.array([10.0, 20.0]), 1.0, None)
    assert plain.tolist() == [*np.arange(6.0, 16.1, 0.25), *range(17, 25)]
    mixed = solved_lines(np.array([28.0, 33.0]), 1.0, [(0.0, 0.5), (30.0, 1.0)])
    assert mixed.tolist() == [*np.arange(24.0, 30.1, 0.5), *np.arange(31.0, 38.0)]
    assert solved_lines(np.array([1.0, 2.0]), 1.0, None)[0] == 0.25


def rig(folder: Path) -> Campaign:
    """Two masses on springs on a shaken ground, and a table of the spring's stiffness."""
    campaign, _ = tables()
    model: dict[str, Any] = {
        "format": 1,
        "frequencies": {"values_Hz": [10.0]},
        "line": {
            "bodies": {"light": {"type": "mass", "mass_kg": 1.0}, "heavy": {"type": "mass", "mass_kg": 4.0}},
            "laws": {"rubber": {"type": "zener", "relaxed": 1e5, "unrelaxed": 3e5, "relaxation_time_s": 1e-3}},
            "joints": [
                {"between": ["light", "ground"], "law": "rubber", "at": [0.0]},
                {"between": ["heavy", "ground"], "law": "rubber", "at": [1.0], "scale": 2.0},
            ],
        },
        "forces": [{"body": "light", "x_m": 0.0}],
        "sensors": [{"body": "light", "x_m": 0.0}],
    }
    campaign["sensors"] = [
        {"name": "light", "body": "light", "x_m": 0.0, "unit": "m/s2"},
        {"name": "heavy", "body": "heavy", "x_m": 1.0, "unit": "m/s2", "chain": {"gain": 2.0}},
    ]
    campaign["conditions"] = campaign["conditions"][2:]
    campaign["forces"], campaign["parameters"], campaign["held_out"] = [], [], []
    del campaign["irregularity"]
    campaign["records"] = [
        {
            "name": "shaken",
            "file": "run.csv",
            "condition": "rig",
            "statistic": "transmissibility",
            "channels": {"a": "light"},
        },
        {
            "name": "dma",
            "file": "frf.csv",
            "condition": "tests",
            "statistic": "material",
            "law": "line.laws.rubber",
        },
    ]
    return read_campaign(write(folder, campaign, model))


def test_masses_on_a_shaken_ground(tmp_path: Path) -> None:
    campaign = rig(tmp_path)
    dataset = blank(campaign, "shaken", "transmissibility", channel=["light", "heavy"], frequency=FREQUENCY)
    predicted = predict(campaign, [dataset], threads=1)[0]["transmissibility"].values
    k, omega = campaign.model.line.laws["rubber"].complex(FREQUENCY), 2.0 * np.pi * FREQUENCY
    assert predicted[0] == pytest.approx(k / (k - omega**2), rel=1e-9)
    assert predicted[1] == pytest.approx(2.0 * 2.0 * k / (2.0 * k - 4.0 * omega**2), rel=1e-9)


def test_a_materials_table_is_its_law(tmp_path: Path) -> None:
    campaign = rig(tmp_path)
    record = campaign.stated.records[1]
    data = xr.Dataset(
        {"modulus": ("point", np.zeros(3, dtype=complex))}, coords={"frequency": ("point", [1.0, 10.0, 5.0])}
    )
    predicted = predict(campaign, [Dataset(record, campaign.condition("tests"), data)])[0]["modulus"].values
    assert predicted == pytest.approx(campaign.model.line.laws["rubber"].complex([1.0, 10.0, 5.0]))


def test_decay_rate_by_the_blows_of_the_standard(tmp_path: Path) -> None:
    campaign, model = tables()
    campaign["records"].append(
        {
            "name": "tdr",
            "file": "run.csv",
            "condition": "still",
            "statistic": "decay",
            "spacing_m": 0.3,
            "channels": {"a": "rail@12"},
        }
    )
    read = read_campaign(write(tmp_path, campaign, model))
    band = [315.0, 400.0]
    predicted = predict(read, [blank(read, "tdr", "decay_rate", band=band)], threads=1)[0]["decay_rate"].values
    # The other way round: one blow, sensors along the rail; many equal steps instead of a few equal ratios.
    places = grid_positions(0.3)
    exact = 1000.0 * 10.0 ** (np.array([-5.0, -4.0]) / 10.0)
    for middle, found in zip(exact, predicted, strict=True):
        frequency = np.linspace(middle * 10**-0.05, middle * 10**0.05, 201)[1::2]
        h = receptance(
            read.model.line,
            frequency,
            forces=[Place(body="rail", x_m=12.0)],
            sensors=[Place(body="rail", x_m=12.0 + float(x)) for x in places],
            threads=1,
        )["receptance"].values[:, :, 0]
        power = np.sqrt(np.mean(np.abs(frequency[:, None] ** 2 * h) ** 2, axis=0))
        rate = track_decay_rate(power, places, warn=False)["decay_rate"].values
        assert found == pytest.approx(rate[0], rel=0.01)


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"direction": "lateral"}, "reads lateral"),
        ({"degree": None, "body": "rail", "x_m": 3.0}, "beside the track"),
    ],
)
def test_what_cannot_be_predicted_is_reported(tmp_path: Path, change: dict[str, Any], what: str) -> None:
    campaign, model = tables()
    campaign["sensors"][3] = {k: v for k, v in {**campaign["sensors"][3], **change}.items() if v is not None}
    read = read_campaign(write(tmp_path, campaign, model))
    with pytest.raises(InputError, match=what):
        predict(read, [run(read)])


def test_variance_of_an_estimated_frequency_response() -> None:
    assert log_variance(np.array([0.5]), 8.0) == pytest.approx([0.5 / 8.0])
    # A coherence that a file has rounded to 1 is no certainty, and one of 0 no infinity.
    rounded = log_variance(np.array([1.0, 0.0]), 8.0)
    assert 0.0 < rounded[0] < 1e-5
    assert np.isfinite(rounded[1])
