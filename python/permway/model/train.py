"""A vehicle over a line."""

from __future__ import annotations

from pydantic import Field, field_validator

from permway.errors import InputError
from permway.model.bodies import Metres
from permway.model.contact import ContactStiffness, GivenContact
from permway.model.faults import fault
from permway.model.irregularity_spectra import check_speed
from permway.model.place import Place
from permway.model.vehicle import Vehicle
from permway.records import FrozenModel, Number


class Train(FrozenModel):
    """A vehicle standing over a line, the irregularity drawn through under its wheels.

    Parameters
    ----------
    vehicle : Vehicle
    contact : contact stiffness
        Linearised Hertz contact of one wheel.
    centre_m : float
        Where the middle of the train is.
    speed_m_per_s : float
    body : str
        The body that the wheels run on.
    """

    vehicle: Vehicle
    contact: ContactStiffness = Field(default_factory=lambda: GivenContact(stiffness_N_per_m=1.3e9))
    centre_m: Metres
    speed_m_per_s: Number
    body: str = "rail"

    @field_validator("speed_m_per_s")
    @classmethod
    def _check_speed(cls, speed: float) -> float:
        try:
            return check_speed(speed)
        except InputError as error:
            raise fault(f"{error.what}: {error.remedy}", value=speed) from error

    def wheels(self) -> list[Place]:
        """The contact points, leading wheel first."""
        positions = self.centre_m + self.vehicle.wheel_positions_m()
        return [Place(body=self.body, x_m=float(x), name=f"wheel{i + 1}") for i, x in enumerate(positions)]
