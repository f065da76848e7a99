"""Vehicles of the literature by name."""

from __future__ import annotations

from permway.errors import InputError
from permway.model.vehicle import Vehicle


def crh380a(*, cars: int = 1, share: float = 1.0) -> Vehicle:
    """CRH380A of the paper, Table 2, at rated load.

    Table 2 prints the suspensions without saying of what. They are those of one side (one axle box, one
    side of a bogie): with the masses halved and the suspensions as printed, the half model gives Table 6;
    read as per wheelset and per bogie it gives a seventh of it. The whole vehicle therefore has twice the
    printed values.

    Parameters
    ----------
    cars : int
        Number of cars.
    share : float
        1, or 0.5 for the paper's half model.
    """
    return Vehicle(
        car_body_mass_kg=42934.0,
        bogie_mass_kg=3300.0,
        wheelset_mass_kg=1780.0,
        car_body_inertia_kg_m2=1.712e6,
        bogie_inertia_kg_m2=1807.0,
        primary_stiffness_N_per_m=2.0 * 1.176e6,
        primary_damping_Ns_per_m=2.0 * 1.0e4,
        secondary_stiffness_N_per_m=2.0 * 2.4e5,
        secondary_damping_Ns_per_m=2.0 * 2.0e4,
        bogie_distance_m=17.5,
        wheelbase_m=2.5,
        car_length_m=25.0,
        cars=cars,
        share=share,
    )


def zeng2014_trailer(*, cars: int = 1, share: float = 1.0) -> Vehicle:
    """Trailer of Zeng et al., Shock and Vibration 2014, 304219; suspensions per wheelset and per bogie.

    With its wheelsets held fast: 0.753, 0.835, 6.00 and 7.10 Hz (printed: 0.75, 0.84, 6.00, 7.10). The car's
    length is this library's choice and has no effect on one car.

    Parameters
    ----------
    cars, share
        As in :func:`crh380a`.
    """
    return Vehicle(
        car_body_mass_kg=44000.0,
        bogie_mass_kg=2400.0,
        wheelset_mass_kg=2400.0,
        car_body_inertia_kg_m2=2.7e6,
        bogie_inertia_kg_m2=2.2e3,
        primary_stiffness_N_per_m=1.4e6,
        primary_damping_Ns_per_m=8.0e4,
        secondary_stiffness_N_per_m=6.0e5,
        secondary_damping_Ns_per_m=8.0e4,
        bogie_distance_m=2.0 * 8.6875,
        wheelbase_m=2.5,
        car_length_m=25.0,
        cars=cars,
        share=share,
    )


def manchester_vehicle_1(*, cars: int = 1, share: float = 1.0) -> Vehicle:
    """Vehicle 1 of the Manchester benchmarks, in its vertical plane.

    Iwnicki, Vehicle System Dynamics 30 (1998) 295-313, as reduced to the plane in TTB-2D (Cantero, SoftwareX
    20 (2022) 101253): springs of one side doubled, primary 1.2 MN/m and 4 kN s/m an axle box, secondary 430
    kN/m and 20 kN s/m a side. Wheelsets held fast: 1.0725, 1.2973, 7.4187, 7.4255, 11.6174 Hz. With the
    primary of 1.22 MN/m also found quoted the last three are 0.7 to 0.8 % higher. The car's length is this
    library's choice and has no effect on one car.

    Parameters
    ----------
    cars, share
        As in :func:`crh380a`.
    """
    return Vehicle(
        car_body_mass_kg=32000.0,
        bogie_mass_kg=2615.0,
        wheelset_mass_kg=1813.0,
        car_body_inertia_kg_m2=1.97e6,
        bogie_inertia_kg_m2=1476.0,
        primary_stiffness_N_per_m=2.0 * 1.2e6,
        primary_damping_Ns_per_m=2.0 * 4.0e3,
        secondary_stiffness_N_per_m=2.0 * 4.3e5,
        secondary_damping_Ns_per_m=2.0 * 2.0e4,
        bogie_distance_m=19.0,
        wheelbase_m=2.56,
        car_length_m=26.0,
        cars=cars,
        share=share,
    )


VEHICLES: dict[str, Vehicle] = {
    "crh380a": crh380a(),
    "zeng2014_trailer": zeng2014_trailer(),
    "manchester_vehicle_1": manchester_vehicle_1(),
}
"""Whole single cars by name; `model_copy(update={"share": 0.5})` gives the half model."""


def vehicle(name: str) -> Vehicle:
    """Return the vehicle of that name from :data:`VEHICLES`.

    Raises
    ------
    InputError
        For a name that is not there.
    """
    try:
        return VEHICLES[name]
    except KeyError:
        known = ", ".join(sorted(VEHICLES))
        raise InputError(
            "no vehicle of that name", where="vehicle", value=name, remedy=f"known: {known}"
        ) from None
