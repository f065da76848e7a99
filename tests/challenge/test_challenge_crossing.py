"""A train that runs, integrated in time: against the solver's pass-by and coupling in time, and mechanics."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import permway
import pytest
from permway.campaign.importers.sheet import import_sheet
from permway.challenge import write
from permway.challenge.assembly import assemble
from permway.challenge.crossing import Consist, Crossing, cross
from permway.challenge.layout import NOMINAL, Layout, Values
from permway.challenge.mesh import Mesh
from permway.challenge.plan import CONTACT_N_PER_M
from permway.challenge.vehicle import wheel_load
from permway.errors import InputError
from permway.laws import Hysteretic, KelvinVoigt
from permway.problem.model import Model
from permway.response.passby import Axles, couple, passby
from scipy.signal import butter, sosfiltfilt
from short_deck import small_case

VISCOUS_HZ = 10.0
FIVE = Layout(spans=5, bays=101, spacing_m=0.64, approach_bays=110)
ONE = Layout(spans=1, bays=26, spacing_m=0.64, approach_bays=70)


def with_loss(concrete: float, pad: float) -> dict[str, dict[str, float]]:
    """What is usual, but for losses."""
    values = {name: dict(table) for name, table in NOMINAL.items()}
    losses = {"slab": concrete, "base": concrete, "girder": concrete, "pad": pad}
    return {**values, **{name: {**values[name], "eta": loss} for name, loss in losses.items()}}


def viscous(layout: Layout, values: Values, folder: Path, at_Hz: float) -> Model:
    """The solver's model of a sheet, with viscous laws that are the sheet's hysteretic ones at a frequency."""
    case = replace(small_case(clean=True, layout=layout), true=values, nominal=values)
    write(case, folder / "sheet")
    model = import_sheet(folder / "sheet", folder / "imported").model
    laws = {}
    for name, law in model.line.laws.items():
        assert isinstance(law, Hysteretic)
        stiffness = complex(law.complex([at_Hz])[0])
        laws[name] = KelvinVoigt(stiffness=stiffness.real, damping=stiffness.imag / (2.0 * np.pi * at_Hz))
    return model.model_copy(update={"line": model.line.model_copy(update={"laws": laws})})


def test_five_spans_under_two_cars_move_as_the_solver_s_do(tmp_path: Path) -> None:
    """Loads are all but constant: light wheels, soft springs. Left are the rail's ends and beams' viscous loss."""
    values = with_loss(0.02, 0.12)
    light = {**values["vehicle"], "Mw": 10.0, "kp": 2e5, "cp": 1e3, "Mc": values["vehicle"]["Mc"] + 4 * 1770.0}
    train = Consist({**values, "vehicle": light}, cars=2, car_m=25.0, speed_m_per_s=60.0)
    locations = [("girder", FIVE.station(10)), ("girder", FIVE.station(50)), ("rail", FIVE.station(50))]
    ours = cross(
        Mesh(assemble(FIVE, values), locations),
        train,
        from_m=-5.0,
        to_m=FIVE.length_m + 5.0,
        leaves=False,
        sensors=locations,
        viscous_at_Hz=VISCOUS_HZ,
    )
    load = wheel_load(train.values)
    assert np.abs(ours.contact_force - load).max() < 0.04 * load
    line = viscous(FIVE, values, tmp_path, VISCOUS_HZ).line
    axles = Axles(lags_m=tuple(train.behind_m), loads_N=(load,) * 8, speed_m_per_s=60.0, body="rail")
    places = [permway.Place(body=body, x_m=x) for body, x in locations]
    data = passby(line, axles, sensors=places, highest_Hz=60.0, quantity="displacement")
    entered_m = data.attrs["path_m"][0]
    for index, allowed in enumerate((0.012, 0.012, 0.03)):
        history = data["history"].values[0, index]
        solved = np.interp((ours.front_m - entered_m) / 60.0, data["time"].values, history)
        off = np.abs(solved - ours.displacement[:, index]).max()
        assert off < allowed * ours.displacement[:, index].max(), locations[index]


def test_a_dip_presses_wheels_as_the_solver_s_coupling_in_time_has_it(tmp_path: Path) -> None:
    """Linear contacts, below 150 Hz: above it the solver's panels show."""
    values = with_loss(0.02, 0.6)

    def dip(x: np.ndarray) -> np.ndarray:
        along = np.clip((x - 6.6) / 0.6, -0.5, 0.5)
        return np.asarray(0.5e-4 * (1.0 + np.cos(2.0 * np.pi * along)))

    ours = cross(
        Mesh(assemble(ONE, values), ()),
        Consist(values, cars=1, car_m=25.0, speed_m_per_s=50.0),
        from_m=-12.0,
        to_m=12.0,
        leaves=False,
        profile=dip,
        viscous_at_Hz=30.0,
    )
    model = viscous(ONE, values, tmp_path, 30.0)
    assert model.train is not None
    x = np.linspace(6.0, 7.2, 301)
    theirs = couple(
        model.line,
        model.train.vehicle,
        speed_m_per_s=50.0,
        contact_N_per_m=CONTACT_N_PER_M,
        step_s=3e-4,
        from_m=3.0,
        to_m=10.0,
        ramp_m=1.5,
        profile=(x, dip(x)),
    )
    both = (ours.front_m > 3.0) & (ours.front_m < 10.0)
    at = ours.front_m[both]
    solved = np.interp(at, theirs["wheel_x"].values[0], theirs["contact_force"].values[0])
    low = butter(4, 150.0, fs=1.0 / (ours.times[1] - ours.times[0]), output="sos")
    first, second = (sosfiltfilt(low, f - f.mean()) for f in (ours.contact_force[both, 0], solved))
    near = (at > 5.2) & (at < 8.2)
    assert np.ptp(first[near]) > 1.5e4
    assert np.linalg.norm((first - second)[near]) < 0.1 * np.linalg.norm(first[near])


@cache
def over_a_weld(*, leaves: bool) -> Crossing:
    def weld(x: np.ndarray) -> np.ndarray:
        along = np.clip((x - 6.5) / 0.4, -0.5, 0.5)
        return np.asarray(1e-3 * (1.0 + np.cos(2.0 * np.pi * along)))

    train = Consist(NOMINAL, cars=1, car_m=25.0, speed_m_per_s=70.0)
    return cross(Mesh(assemble(ONE, NOMINAL), ()), train, from_m=0.0, to_m=13.0, leaves=leaves, profile=weld)


def test_wheels_leave_a_deep_weld_and_land_harder() -> None:
    free, held = over_a_weld(leaves=True), over_a_weld(leaves=False)
    assert held.contact_force.min() < 0.0
    assert free.contact_force.min() == 0.0
    gone = (free.contact_force[:, 0] == 0.0).sum() * (free.times[1] - free.times[0])
    assert 5e-4 < gone < 0.02
    # In flight nothing but its springs moves a wheelset: down, by what the primary suspension carries.
    v = NOMINAL["vehicle"]
    flying = free.contact_force[:, 0] == 0.0
    carried = 0.5 * 9.81 * (0.25 * v["Mc"] + 0.5 * v["Mt"] + v["Mw"])
    assert np.median(free.axlebox[flying, 0]) == pytest.approx(carried / (0.5 * v["Mw"]), rel=0.1)


def test_a_train_at_rest_stays_at_rest_but_for_the_supports_it_passes() -> None:
    """Forces begin at the load, and keep its mean."""
    run = over_a_weld(leaves=True)
    load = wheel_load(NOMINAL)
    before = run.front_m < 6.0
    assert run.contact_force[0] == pytest.approx(np.full(4, load), rel=0.01)
    assert run.contact_force[before].mean(axis=0) == pytest.approx(np.full(4, load), rel=0.01)
    assert np.abs(run.contact_force[before] - load).max() < 0.15 * load


@pytest.mark.parametrize(
    ("wrong", "where"),
    [
        ({"step_s": 0.0}, "step_s"),
        ({"viscous_at_Hz": np.nan}, "viscous_at_Hz"),
        ({"to_m": -1.0}, "from_m"),
        ({"speed_m_per_s": -70.0}, "speed_m_per_s"),
        ({"cars": 0}, "cars"),
    ],
)
def test_a_train_that_does_not_run_is_refused(wrong: dict[str, float], where: str) -> None:
    train = {"cars": 1, "car_m": 25.0, "speed_m_per_s": 70.0, **wrong}
    of_train = {key: train.pop(key) for key in ("cars", "car_m", "speed_m_per_s")}
    run = {"from_m": 0.0, "to_m": 10.0, **{key: wrong[key] for key in wrong if key not in of_train}}
    with pytest.raises(InputError, match=where):
        cross(Mesh(assemble(ONE, NOMINAL), ()), Consist(NOMINAL, **of_train), **run)


@pytest.mark.parametrize(("key", "value"), [("from_m", -40.0), ("to_m", 80.0)])
def test_a_wheel_off_the_rail_is_refused(key: str, value: float) -> None:
    train = Consist(NOMINAL, cars=1, car_m=25.0, speed_m_per_s=70.0)
    with pytest.raises(InputError, match=f"{key}.*the rail goes from"):
        cross(Mesh(assemble(ONE, NOMINAL), ()), train, **{"from_m": 0.0, "to_m": 10.0, key: value})
