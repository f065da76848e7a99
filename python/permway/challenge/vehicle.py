"""Half a vehicle on one rail: body and two bogies that bounce and pitch, four wheelsets."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from permway.challenge.beams import Complexes, Reals
from permway.challenge.contact import Hertz, as_profile
from permway.challenge.layout import Values
from permway.challenge.sliders import Slider, settle

Arm = dict[int, float]
"""A combination of degrees of freedom: number to factor."""

Law = Callable[[Reals], Complexes]


@dataclass(frozen=True)
class Force:
    """A random force on a combination of degrees of freedom.

    Parameters
    ----------
    arm : Arm
    spectrum : callable
        Of frequencies (Hz): amplitudes of the two-sided series, N.
    """

    arm: Arm
    spectrum: Callable[[Reals], Complexes]


BODY, PITCH, WHEELS = 0, 1, (6, 7, 8, 9)

GRAVITY = 9.81


@dataclass
class Vehicle:
    """Masses, ties between them, wheels and channels, which effects may alter.

    Attributes
    ----------
    masses : list of float
        One for each degree of freedom, kg or kg m2.
    ties : list of (Arm, str)
        The stretch of a tie and the name of its law.
    laws : dict
    wheels : list of int
        Degrees that touch the rail, the leading one first.
    channels : dict of str to Arm
        What each channel reads.
    contact : float
        Stiffness of a wheel's contact, N/m.
    slider : Slider or None
        A force that no law describes.
    hertz : Hertz or None
        A contact that wheels may leave; linear contacts without it.
    forces : list of Force
        Beside what the profile does; not in a vehicle that slides.
    """

    masses: list[float]
    ties: list[tuple[Arm, str]]
    laws: dict[str, Law]
    wheels: list[int]
    channels: dict[str, Arm]
    contact: float
    slider: Slider | None = None
    hertz: Hertz | None = None
    forces: list[Force] = field(default_factory=list)

    def add(self, mass: float) -> int:
        """Add a degree of freedom; its number."""
        self.masses.append(mass)
        return len(self.masses) - 1

    def influence(self, frequency_Hz: Reals, track: Complexes) -> Complexes:
        """What channels move per profile under each wheel.

        The profile is taken up by wheel, contact and track in series; wheels stay in touch.

        Parameters
        ----------
        frequency_Hz : ndarray, shape (F,)
        track : ndarray of complex128, shape (F, 4, 4)
            m/N under the wheels.

        Returns
        -------
        ndarray of complex128, shape (F, channels, 4)
        """
        return np.asarray(self.rows(self.channels.values()) @ self._moved(frequency_Hz, track))

    def pressed(self, frequency_Hz: Reals, track: Complexes) -> Complexes:
        """Force of each linear contact per profile under each wheel, shape (F, wheels, wheels), N/m."""
        under = np.linalg.inv(track + np.eye(len(self.wheels)) / self.contact)
        displaced = self._moved(frequency_Hz, track)[:, self.wheels]
        return np.asarray(under @ (displaced - np.eye(len(self.wheels))))

    def leaving(
        self,
        frequency_Hz: Reals,
        track: Callable[[Reals], Complexes],
        profiles: Complexes,
        *,
        samples: int,
    ) -> Complexes:
        """Profiles under linear contacts that do what these do under contacts that wheels may leave.

        Parameters
        ----------
        frequency_Hz : ndarray, shape (F,)
        track : callable
            Of frequencies: m/N under the wheels, shape (F, 4, 4).
        profiles : ndarray of complex128, shape (F, 4)
        samples : int
        """
        if self.hertz is None:
            return profiles
        return as_profile(self.hertz, lambda f: self.pressed(f, track(f)), frequency_Hz, profiles, samples=samples)

    def respond(
        self, frequency_Hz: Reals, track: Complexes, profiles: Complexes, *, bins: NDArray[np.int64], samples: int
    ) -> Complexes:
        """What channels move over profiles under the wheels, transforms of a record of so many samples.

        Parameters
        ----------
        frequency_Hz, bins : ndarray, shape (F,)
            The lines, and their numbers in the record's transform.
        track : ndarray of complex128, shape (F, 4, 4)
        profiles : ndarray of complex128, shape (F, 4)
        samples : int

        Returns
        -------
        ndarray of complex128, shape (F, channels)
        """
        read = self.rows(self.channels.values())
        if self.slider is None:
            arms = self.rows([force.arm for force in self.forces])
            parts = read @ self._moved(frequency_Hz, track, arms)
            drives = [samples * force.spectrum(frequency_Hz) for force in self.forces]
            return np.asarray(np.einsum("fcw,fw->fc", parts, np.column_stack([profiles, *drives])))
        along = self.rows([arm for arm, name in self.ties if name == self.slider.tie])
        displaced = self._moved(frequency_Hz, track, along)
        driven = np.einsum("fdw,fw->fd", displaced[:, :, : len(self.wheels)], profiles)
        gives_way = displaced[:, :, len(self.wheels) :]
        force = settle(
            self.slider,
            np.asarray(driven @ along.T),
            np.asarray(along @ gives_way),
            frequency_Hz=frequency_Hz,
            bins=bins,
            samples=samples,
        )
        return np.asarray((driven - np.einsum("fdt,ft->fd", gives_way, force)) @ read.T)

    def rows(self, arms: Iterable[Arm]) -> Reals:
        """What reads arms off the degrees of freedom, shape (arms, degrees)."""
        arms = list(arms)
        rows = np.zeros((len(arms), len(self.masses)))
        for row, arm in zip(rows, arms, strict=True):
            row[list(arm)] = list(arm.values())
        return rows

    def _moved(self, frequency_Hz: Reals, track: Complexes, along: Reals | None = None) -> Complexes:
        """Motion of all degrees per profile under each wheel, then per force along each tie of `along`."""
        size, wheels = len(self.masses), len(self.wheels)
        omega = 2.0 * np.pi * frequency_Hz
        stiffness = np.zeros((frequency_Hz.size, size, size), dtype=np.complex128)
        for number, mass in enumerate(self.masses):
            stiffness[:, number, number] = -mass * omega**2
        laws = {name: law(frequency_Hz) for name, law in self.laws.items()}
        if self.slider is not None:
            laws[self.slider.tie] = np.asarray(laws[self.slider.tie] + 1j * omega * self.slider.dashpot)
        for arm, name in self.ties:
            for i, a in arm.items():
                for j, b in arm.items():
                    stiffness[:, i, j] += a * b * laws[name]
        under = np.linalg.inv(track + np.eye(wheels) / self.contact)
        for column, wheel in enumerate(self.wheels):
            stiffness[:, self.wheels, wheel] += under[:, :, column]
        forces = np.zeros((frequency_Hz.size, size, wheels), dtype=np.complex128)
        forces[:, self.wheels] = under
        if along is not None:
            pulled = np.broadcast_to(along.T, (frequency_Hz.size, *along.T.shape))
            forces = np.concatenate([forces, pulled], axis=2)
        return np.asarray(np.linalg.solve(stiffness, forces))


def vehicle(values: Values, contact: float) -> Vehicle:
    """The vehicle of a sheet: masses times `half`, suspensions of one side, pitch down in front."""
    v = values["vehicle"]
    half = v["half"]
    masses = [half * v["Mc"], half * v["Jc"], *(half * v["Mt"], half * v["Jt"]) * 2, *[half * v["Mw"]] * 4]
    ties: list[tuple[Arm, str]] = []
    for bogie, front in ((2, 1.0), (4, -1.0)):
        ties.append(({BODY: 1.0, PITCH: 0.5 * front * v["lc"], bogie: -1.0}, "secondary"))
        for wheel, ahead in ((0, 1.0), (1, -1.0)):
            ties.append(({bogie: 1.0, bogie + 1: 0.5 * ahead * v["lt"], 4 + bogie + wheel: -1.0}, "primary"))
    channels: dict[str, Arm] = {f"axlebox{i + 1}": {WHEELS[i]: 1.0} for i in range(4)}
    channels |= {"bogie1": {2: 1.0}, "carbody": {BODY: 1.0}}
    return Vehicle(
        masses=masses,
        ties=ties,
        laws={
            "primary": damped_spring(v["kp"], v["cp"]),
            "secondary": damped_spring(v["ks"], v["cs"]),
        },
        wheels=list(WHEELS),
        channels=channels,
        contact=contact,
    )


def wheel_load(values: Values) -> float:
    """Of one wheel at rest, N."""
    v = values["vehicle"]
    return float(GRAVITY * v["half"] * (0.25 * v["Mc"] + 0.5 * v["Mt"] + v["Mw"]))


def damped_spring(stiffness: float, damping: float) -> Law:
    """Spring and damper side by side."""
    return lambda f: np.asarray(stiffness + 2j * np.pi * f * damping)
