"""Waves along a track and its critical speed, against closed forms of beams on beds."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from permway.cli import app
from permway.errors import InputError
from permway.laws import FractionalKelvinVoigt, Hysteretic, Law
from permway.model.bodies import AnyBody, Beam, Mass
from permway.model.joints import Joints, Spread
from permway.model.line import Line
from permway.model.place import Place
from permway.response.dispersion import dispersion
from permway.response.receptance import receptance
from permway.tables import to_frame

EI, RHO_A, S, D = 6.4e6, 60.0, 3.0e7, 0.6
RAIL = {
    "youngs_modulus_Pa": 2.1e11,
    "second_moment_m4": EI / 2.1e11,
    "density_kg_per_m3": 7800.0,
    "area_m2": RHO_A / 7800.0,
}
ALONG = Spread(from_m=0.0, to_m=60.0, spacing_m=D)


def track(*layers: tuple[str, str, Law], bodies: dict[str, AnyBody] | None = None, **rail: object) -> Line:
    return Line(
        bodies={"rail": Beam.model_validate({**RAIL, **rail}), **(bodies or {})},
        joints=tuple(
            Joints(between=(one, other), law=f"k{i}", at=ALONG) for i, (one, other, _) in enumerate(layers)
        ),
        laws={f"k{i}": law for i, (_, _, law) in enumerate(layers)},
    )


def test_a_beam_on_a_bed_has_fryba_s_critical_speed() -> None:
    found = dispersion(track(("rail", "ground", Hysteretic(stiffness=S * D, loss_factor=0.3))))
    assert found.critical_speed_m_per_s == pytest.approx((4.0 * S * EI / RHO_A**2) ** 0.25, rel=1e-9)
    assert found.critical_wavenumber_rad_per_m == pytest.approx((S / EI) ** 0.25, rel=1e-4)
    kappa = found.wavenumber_rad_per_m
    exact = np.sqrt((EI * kappa**4 + S) / RHO_A) / (2.0 * np.pi)
    np.testing.assert_allclose(found.frequency_Hz[:, 0], exact, rtol=1e-12)
    # Waves of two spacings are the shortest.
    assert kappa[-1] == pytest.approx(np.pi / D)
    assert found.notes == ()
    data = found.to_dataset()
    np.testing.assert_allclose(data.frequency.sel(branch=1), exact, rtol=1e-12)
    np.testing.assert_allclose(data.phase_speed * data.wavenumber, 2.0 * np.pi * data.frequency, rtol=1e-12)
    assert data.attrs["critical_speed_m_per_s"] == found.critical_speed_m_per_s
    assert list(to_frame(data).columns) == ["wavenumber [rad/m]", "branch", "frequency [Hz]", "phase_speed [m/s]"]


def test_waves_of_the_discrete_track_are_nearly_those_of_the_continuous_one() -> None:
    """Far from a force the phase falls by kappa a metre; supports 0.6 m apart change waves of 4 m by little."""
    spring, frequency = S * D, 250.0
    along = Spread(from_m=-120.0, to_m=120.0, spacing_m=D)
    line = Line(
        bodies={"rail": Beam.model_validate(RAIL)},
        joints=(Joints(between=("rail", "ground"), law="pad", at=along),),
        laws={"pad": Hysteretic(stiffness=spring, loss_factor=0.05)},
    )
    sensors = [Place(body="rail", x_m=x, name=f"{x:g}") for x in 12.0 + D * np.arange(51)]
    data = receptance(line, [frequency], forces=[Place(body="rail", x_m=0.0)], sensors=sensors, threads=1)
    answer = data.receptance.values[0, :, 0]
    falls = -float(np.angle(answer[1:] / answer[:-1]).sum()) / (50 * D)
    found = dispersion(line)
    kappa = np.interp(frequency, found.frequency_Hz[:, 0], found.wavenumber_rad_per_m)
    assert falls == pytest.approx(kappa, rel=0.005)


def test_rail_and_sleepers_have_two_branches() -> None:
    pad, bed, mass = 1.2e8, 2.4e7, 150.0
    line = track(
        ("rail", "sleeper", Hysteretic(stiffness=pad)), ("sleeper", "ground", Hysteretic(stiffness=bed)),
        bodies={"sleeper": Mass(mass_kg=mass, at=ALONG)},
    )  # fmt: skip
    found = dispersion(line)
    kappa = found.wavenumber_rad_per_m
    # (k1 - m1 w2)(k2 - m2 w2) = p^2 with w2 the square of the circular frequency.
    p, m2 = pad / D, mass / D
    k1, k2 = EI * kappa**4 + p, (pad + bed) / D
    half = 0.5 * (k1 / RHO_A + k2 / m2)
    root = np.sqrt(half**2 - (k1 * k2 - p**2) / (RHO_A * m2))
    exact = np.sqrt(np.stack([half - root, half + root], axis=1)) / (2.0 * np.pi)
    np.testing.assert_allclose(found.frequency_Hz, exact, rtol=1e-10)
    speed = found.phase_speed_m_per_s
    inner = speed[1:-1]
    lowest = inner[(inner < speed[:-2]) & (inner < speed[2:])].min()
    assert found.critical_speed_m_per_s == pytest.approx(lowest, rel=1e-4)
    assert (found.critical_speed_m_per_s or np.inf) <= lowest


def test_shear_and_rotary_inertia_of_a_timoshenko_rail() -> None:
    shear = 0.4 * 8.1e10 * RAIL["area_m2"]
    line = track(
        ("rail", "ground", Hysteretic(stiffness=S * D)),
        theory="timoshenko", shear_modulus_Pa=8.1e10, shear_coefficient=0.4,
    )  # fmt: skip
    found = dispersion(line)
    rotary = 7800.0 * RAIL["second_moment_m4"]
    for kappa, f in zip(found.wavenumber_rad_per_m[::40], found.frequency_Hz[::40, 0], strict=True):
        w2 = (2.0 * np.pi * f) ** 2
        determinant = (shear * kappa**2 + S - RHO_A * w2) * (EI * kappa**2 + shear - rotary * w2) - (
            shear * kappa
        ) ** 2
        scale = (shear * kappa**2 + S) * (EI * kappa**2 + shear)
        assert abs(determinant) < 1e-10 * scale
    euler = (4.0 * S * EI / RHO_A**2) ** 0.25
    assert 0.9 * euler < (found.critical_speed_m_per_s or 0.0) < euler


def test_a_law_is_taken_at_the_wave_s_own_frequency() -> None:
    law = FractionalKelvinVoigt(stiffness=1e7, coefficient=4e5, order=0.4)
    found = dispersion(track(("rail", "ground", law)))
    for kappa, f in zip(found.wavenumber_rad_per_m[::50], found.frequency_Hz[::50, 0], strict=True):
        s = float(law.storage(f)) / D
        assert f == pytest.approx(np.sqrt((EI * kappa**4 + s) / RHO_A) / (2.0 * np.pi), rel=1e-7)


def test_what_is_no_bed_is_held_and_reported() -> None:
    slab = Beam(
        youngs_modulus_Pa=3e10,
        second_moment_m4=1e-3,
        density_kg_per_m3=2500.0,
        area_m2=0.3,
        intervals_m=((-1.0, 61.0),),
    )
    line = Line(
        bodies={"rail": Beam.model_validate(RAIL), "slab": slab},
        joints=(
            Joints(between=("rail", "slab"), law="pad", at=ALONG),
            Joints(between=("slab", "ground"), law="bearing", at=(0.0, 30.0, 60.0)),
        ),
        laws={"pad": Hysteretic(stiffness=S * D), "bearing": Hysteretic(stiffness=1e8)},
    )
    found = dispersion(line)
    assert found.bed.bodies == ("rail",)
    assert found.critical_speed_m_per_s == pytest.approx((4.0 * S * EI / RHO_A**2) ** 0.25, rel=1e-6)
    assert any("slab is taken as rigid" in note for note in found.notes)
    reported = dispersion(line, held=("slab",))
    assert reported.critical_speed_m_per_s == pytest.approx(found.critical_speed_m_per_s)
    for options, message in (
        ({"body": "deck"}, "is no beam"),
        ({"held": ("rail",)}, "cannot be held|can be held"),
        ({"from_m": 5.0, "to_m": 1.0}, "left to right"),
        ({"from_m": 500.0, "to_m": 600.0}, "nothing bears"),
    ):
        with pytest.raises(InputError, match=message):
            dispersion(line, **options)


def test_without_a_bed_there_is_no_critical_speed() -> None:
    line = track(("rail", "slab", Hysteretic(stiffness=S * D)), bodies={"slab": Mass(mass_kg=90.0, at=ALONG)})
    found = dispersion(line)
    assert any("no critical speed" in note for note in found.notes) or found.critical_speed_m_per_s is not None
    # The first branch starts from rest: nothing holds the track.
    assert found.frequency_Hz[0, 0] < 1.0


def test_the_command_draws_and_writes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = tmp_path / "model.toml"
    model.write_text(
        '[frequencies]\nvalues_Hz = [10.0]\n[line]\npreset = "ballasted_b91_60e1"\n'
        '[[forces]]\nbody = "rail"\nx_m = 30.0\n[[sensors]]\nbody = "rail"\nx_m = 30.0\n'
    )
    table = tmp_path / "waves.csv"
    with pytest.raises(SystemExit) as end:
        app(["dispersion", str(model), "--plot", str(tmp_path / "p"), "-o", str(table), "--json"])
    assert end.value.code == 0
    stated = json.loads(capsys.readouterr().out)
    # By rail and sleepers together on the ballast, Fryba's speed is 307 m/s.
    assert 250.0 < stated["critical_speed_m_per_s"] < 307.0
    assert stated["critical_speed_km_per_h"] == pytest.approx(3.6 * stated["critical_speed_m_per_s"])
    assert stated["bodies"] == ["rail", "sleeper"]
    waves = np.loadtxt(table, delimiter=",", skiprows=1)
    assert waves.shape == (400, 3)
    assert Path(stated["picture"]).name == "dispersion.png"
    assert Path(stated["picture"]).stat().st_size > 3000
