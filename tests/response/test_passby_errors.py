"""A passage stated wrongly: one clear error each; and the model file, the command line and the pictures."""

import json

import numpy as np
import pytest
import xarray as xr
from lines import supported, uic60
from permway.errors import InputError
from permway.formats.model_file import model_from_dict
from permway.laws import Hysteretic, KelvinVoigt
from permway.model.bodies import Beam
from permway.model.irregularity import Iso3095
from permway.model.line import Line
from permway.model.place import Place
from permway.model.train import Train
from permway.model.vehicle_presets import crh380a
from permway.problem.solve import solve, write_dataset
from permway.report.response import draw_dataset
from permway.response.passby import Axles, MassOnSpring, couple, hslm_a, passby

TRACK = supported(uic60(), count=21, spacing_m=0.6, pad=KelvinVoigt(stiffness=8e7, damping=6e4))
SENSOR = Place(body="rail", x_m=0.3)
ONE = Axles(lags_m=(0.0,), loads_N=(1e5,), speed_m_per_s=30.0)
TRAIN = Train(vehicle=crh380a(share=0.5), centre_m=0.0, speed_m_per_s=30.0)


def spans(*intervals, loss_factor=0.02):
    beam = Beam(
        youngs_modulus_Pa=3e10,
        second_moment_m4=2.0,
        density_kg_per_m3=2500.0,
        area_m2=4.0,
        intervals_m=intervals,
        ends="pinned",
        loss_factor=loss_factor,
    )
    return Line(bodies={"girder": beam}, joints=(), laws={})


def run(line=TRACK, train=ONE, sensors=(SENSOR,), highest_Hz=50.0, **options):
    return passby(line, train, sensors=sensors, highest_Hz=highest_Hz, **options)


def axles(lags_m=(0.0, 2.5), loads_N=(1e5, 1e5), speed_m_per_s=30.0, **options):
    return Axles(lags_m=lags_m, loads_N=loads_N, speed_m_per_s=speed_m_per_s, **options)


def march(**options):
    options = {"speed_m_per_s": 30.0, "contact_N_per_m": 1e6, "step_s": 5e-3, **options}
    return couple(TRACK, options.pop("vehicle", MassOnSpring(mass_kg=1e3)), **options)


@pytest.mark.parametrize(
    ("act", "where", "message"),
    [
        (lambda: axles(loads_N=(1e5, -1e5)), "loads_N[1]", "positive is down"),
        (lambda: axles(loads_N=(1e5, 0.0)), "loads_N[1]", "above 0 N"),
        (lambda: axles(loads_N=(1e5,)), "loads_N", "1 loads for 2 axles"),
        (lambda: axles(loads_N=(1e5, np.nan)), "loads_N", "finite"),
        (lambda: axles(lags_m=(0.0, -2.5)), "lags_m[1]", "sort them"),
        (lambda: axles(lags_m=(1.0, 2.5)), "lags_m[0]", "0 m behind itself"),
        (lambda: axles(lags_m=()), "lags_m", "at least 1"),
        (lambda: axles(speed_m_per_s=300.0), "speed_m_per_s", "looks like km/h"),
        (lambda: axles(speed_m_per_s=0.0), "speed_m_per_s", "above 0 m/s"),
        (lambda: axles(speed_m_per_s=np.nan), "speed_m_per_s", "finite"),
        (lambda: hslm_a(11, speed_m_per_s=80.0), "number", "1 to 10"),
        (lambda: hslm_a(1, speed_m_per_s=80.0, share=2.0), "share", "at most 1"),
        (lambda: run(train=TRAIN.vehicle), "train", "must be a Train or Axles"),
        (lambda: run(sensors=()), "sensors", "none given"),
        (lambda: run(sensors=(Place(body="slab", x_m=0.0),)), "sensors[0]", "slab"),
        (lambda: run(sensors=(SENSOR, SENSOR)), "sensors[1]", "stands twice"),
        (lambda: run(highest_Hz=0.0), "highest_Hz", "above 0"),
        (lambda: run(highest_Hz=np.nan), "highest_Hz", "above 0"),
        (lambda: run(highest_Hz="50"), "highest_Hz", "above 0"),
        (lambda: run(window_s=0.2), "window_s", "shorter than the passage of 0.4 s"),
        (lambda: run(window_s=-1.0), "window_s", "above 0"),
        (lambda: run(quantity="jerk"), "quantity", "displacement"),
        (lambda: run(order=2), "order", "from 3 to 16"),
        (lambda: run(averaging_s=0.0), "averaging_s", "above 0"),
        (lambda: run(irregularity=Iso3095(), seed=1), "irregularity", "needs a Train"),
        (lambda: run(train=TRAIN, irregularity=Iso3095()), "seed", "go together"),
        (lambda: run(seed=1), "seed", "go together"),
        (lambda: run(train=TRAIN, irregularity=Iso3095(), seed=-1), "seed", "from 0 on"),
        (lambda: run(train=TRAIN, irregularity=Iso3095(), seed=1), "irregularity", "none of them"),
        (lambda: run(train=axles(body="slab")), "body", "use one of ['rail']"),
        (lambda: run(from_m=3.0, to_m=-3.0), "from_m, to_m", "must lie before"),
        (lambda: run(from_m=np.inf), "from_m", "finite"),
        (lambda: run(ramp_m=8.0), "ramp_m", "half the stretch"),
        (lambda: run(line=Line(bodies={"rail": uic60()}, joints=(), laws={})), "from_m", "needs a stretch"),
        (lambda: run(highest_Hz=1e7), "highest_Hz, from_m, to_m", "lower highest frequency"),
        (lambda: run(window_s=1e6), "highest_Hz, window_s", "frequencies"),
        (lambda: march(speed_m_per_s=300.0), "speed_m_per_s", "looks like km/h"),
        (lambda: march(vehicle=crh380a, contact_N_per_m=1e9), "vehicle", "must be a Vehicle"),
        (lambda: march(contact_N_per_m=-1.0), "contact_N_per_m", "above 0"),
        (lambda: march(step_s=np.nan), "step_s", "above 0"),
        (lambda: march(contact_N_per_m=1e9), "step_s", "too fast for the step"),
        (lambda: march(step_s=1e-7), "step_s", "are allowed"),
        (lambda: march(window_s=0.5), "window_s", "twice the run"),
        (lambda: march(profile=([0.0, 0.0], [0.0, 1.0])), "profile", "must ascend"),
        (lambda: march(profile=([0.0, 1.0], [0.0])), "profile", "same length"),
        (lambda: march(step_s=2e-5, order=16), "step_s, from_m, to_m", "GiB"),
        (lambda: march(sensors=[Place(body="slab", x_m=0.0)]), "sensors[0]", "slab"),
    ],
)
def test_one_clear_error(act, where, message):
    with pytest.raises(InputError) as caught:
        act()
    assert where in caught.value.where
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_window_too_short_for_the_decay_is_refused_with_the_length_it_takes():
    line = spans((0.0, 20.0), loss_factor=0.01)
    options = {"train": axles(body="girder"), "sensors": [Place(body="girder", x_m=10.0)], "quantity": "velocity"}
    with pytest.raises(InputError, match=r"wraps around in 2 s.*give about [\d.]+ s") as caught:
        run(line, window_s=2.0, **options)
    assert caught.value.where == "window_s"
    # And the kernels of a march.
    with pytest.raises(InputError, match="wraps around"):
        couple(
            line, MassOnSpring(mass_kg=1e3), speed_m_per_s=30.0, contact_N_per_m=1e6, step_s=5e-3, body="girder"
        )


def test_wheels_do_not_run_over_a_gap():
    line = spans((0.0, 20.0), (21.0, 41.0))
    sensors = [Place(body="girder[1]", x_m=10.0)]
    with pytest.raises(InputError, match="gap where the wheels run") as caught:
        run(line, train=axles(body="girder"), sensors=sensors)
    assert caught.value.value == "20 m"
    data = run(line, train=axles(body="girder"), sensors=sensors, to_m=20.0, ramp_m=0.0, quantity="velocity")
    assert data.attrs["path_m"] == [0.0, 20.0]


def test_a_line_that_nothing_holds_is_refused():
    loose = supported(uic60(), count=21, spacing_m=0.6, pad=Hysteretic(stiffness=1e-3))
    with pytest.raises(InputError, match="nothing holds the line at rest"):
        run(loose)


def test_a_generous_limit_is_remarked():
    with pytest.warns(UserWarning, match="half the response"):
        run(wraparound_limit=0.9, window_s=2.0)


def test_progress_is_reported_and_may_stop_the_sweep():
    calls = []
    run(window_s=2.0, progress=lambda done, total: calls.append((done, total)))
    assert calls
    assert all(done <= total == 126 for done, total in calls)

    def stop(*_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(window_s=2.0, progress=stop)


MODEL = {
    "frequencies": {"values_Hz": [20.0, 40.0]},
    "line": {"preset": "ballasted_b91_60e1", "options": {"sleepers": 41}},
    "train": {"vehicle": {"preset": "crh380a", "share": 0.5}, "centre_m": 12.0, "speed_km_per_h": 160.0},
    "irregularity": {"type": "german_low"},
    "sensors": [
        {"body": "rail", "x_m": 12.3, "name": "rail"},
        {"body": "sleeper[21]", "x_m": 12.0, "name": "sleeper"},
    ],
    "passby": {"highest_Hz": 60.0, "window_s": 3.0, "seed": 2},
}


def test_a_model_file_asks_for_a_passage(tmp_path):
    model = model_from_dict(MODEL)
    data = solve(model, threads=1)
    assert data["passby_history"].dims == ("part", "sensor", "time")
    assert data["line_velocity_psd"].sizes["frequency"] == 2
    alone = passby(
        model.line,
        model.train,
        sensors=model.sensors,
        highest_Hz=60.0,
        window_s=3.0,
        irregularity=model.irregularity,
        seed=2,
        threads=1,
    )
    assert np.array_equal(data["passby_spectrum"].values, alone["spectrum"].values)
    assert data.attrs["passby_seed"] == 2
    written = write_dataset(data, tmp_path / "passage.nc")
    with xr.open_dataset(written, engine="h5netcdf") as read:
        assert np.array_equal(read["passby_history"], data["passby_history"])
        assert json.loads(read.attrs["model"])["passby"]["highest_Hz"] == 60.0
    names = [path.name for path in draw_dataset(data, tmp_path / "pictures")]
    assert {"passby-rail.png", "passby-sleeper.png"} <= set(names)
    again = model_from_dict(json.loads(data.attrs["model"]))
    assert again == model


def test_a_passage_needs_no_irregularity(tmp_path):
    model = model_from_dict({key: value for key, value in MODEL.items() if key != "irregularity"})
    data = solve(model, threads=1)
    assert list(data["part"].values) == ["quasi_static"]
    assert "wheel_rail_force" not in data
    assert [path.name for path in draw_dataset(data, tmp_path)] == ["passby-rail.png", "passby-sleeper.png"]


@pytest.mark.parametrize(
    ("change", "where", "message"),
    [
        ({"passby": {}}, "passby.highest_Hz", "missing"),
        ({"passby": {"highest_Hz": -5.0}}, "passby.highest_Hz", "greater than 0"),
        ({"passby": {"highest_Hz": 60.0, "quantity": "speed"}}, "passby.quantity", "displacement"),
        ({"passby": {"highest_Hz": 60.0, "from_m": 5.0, "to_m": 2.0}}, "passby.to_m", "beyond"),
        ({"passby": {"highest_Hz": 60.0, "seed": 1.5}}, "passby.seed", "integer"),
        ({"passby": {"highest_Hz": 60.0, "windows_s": 1.0}}, "passby.windows_s", "did you mean 'window_s'"),
        ({"sensors": []}, "passby", "needs a [train] and [[sensors]]"),
    ],
)
def test_faults_of_the_table(change, where, message):
    with pytest.raises(InputError) as caught:
        model_from_dict({**MODEL, **change})
    assert caught.value.where == where
    assert message.lower() in str(caught.value).lower()
