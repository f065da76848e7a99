"""A model file that is started, a rail on pads or a beam, with what only the user knows left open."""

from __future__ import annotations

from collections.abc import Collection

_TEXT = """\
# Started by `permway new`: a rail on pads. Answer what begins with "question". What else a model can hold, and
# presets of whole lines: docs/model-file.md. [[forces]] and [[sensors]] are for `permway solve` alone
format = 1

[frequencies]
from_Hz = 5.0
to_Hz = 500.0
step_Hz = 5.0

[line.bodies.rail]                   # question: which rail? These are the numbers of 60E1, one rail
type = "beam"
youngs_modulus_Pa = 2.1e11
second_moment_m4 = 3.038e-5
density_kg_per_m3 = 7850.0
area_m2 = 7.67e-3
loss_factor = 0.01
# intervals_m = [[0.0, 36.0]]        # option: has it ends? By default it goes on for ever, free beyond the pads

[line.laws.pad]
type = "hysteretic"                  # with a dashpot: "kelvin_voigt", and damping in N s/m for loss_factor
# stiffness = 30e6                   # question: of one pad, N/m?
# loss_factor = 0.15                 # question: of one pad?

[[line.joints]]
# Sleepers (examples/sleepers.toml), slabs and girders are bodies, too
between = ["rail", "ground"]         # question: what is below the pads?
law = "pad"
# Let the pads reach 6 m beyond all that was struck or read
# at = { from_m = 0.0, to_m = 36.0, spacing_m = 0.6 }    # question: where are the pads?

[[forces]]
body = "rail"
x_m = 18.0

[[sensors]]
body = "rail"
x_m = 18.0

# option: does a train run? Then [train] with its vehicle, and [irregularity]: docs/model-file.md
"""


_BEAM = """\
# Started by `permway new`: a {body} alone, as labels name no rail. Answer what begins with "question". What else a
# model can hold: docs/model-file.md. [[forces]] and [[sensors]] are for `permway solve` alone
format = 1

[frequencies]
from_Hz = 1.0
to_Hz = 100.0
step_Hz = 0.2

[line.bodies.{body}]
type = "beam"
ends = "pinned"                      # option: at both ends; or "free", or "clamped"
# intervals_m = [[0.0, 20.0]]        # question: from where to where, in m as labels count?
# youngs_modulus_Pa = 3.4e10         # question: concrete about 3.4e10, steel 2.1e11
# second_moment_m4 = 0.6             # question: of the whole section?
# density_kg_per_m3 = 2500.0         # question: with what lies on it?
# area_m2 = 4.8                      # question: of the whole section?
loss_factor = 0.02

[[forces]]
body = "{body}"
x_m = 8.0

[[sensors]]
body = "{body}"
x_m = 9.0

# option: does it stand on bearings? Then ends = "free", a law, and [[line.joints]] between it and "ground"
"""

BARE = ("beam", "girder", "deck")
"""Bodies that may be a model by themselves."""


def first_body(named: Collection[str]) -> str:
    """What the model begins with: a rail, or a bare beam where labels name such and nothing else."""
    bare = [one for one in BARE if one in named]
    return bare[0] if bare and set(named) <= set(BARE) else "rail"


def model_text(body: str) -> str:
    """The model file that begins with this body."""
    return _TEXT if body == "rail" else _BEAM.format(body=body)


def parameter_lines(body: str) -> tuple[str, str]:
    """Name and path of a parameter that the model has, as an example."""
    if body == "rail":
        return '# name = "pad.k"', '# paths = "line.laws.pad.stiffness"'
    return f'# name = "{body}.E"', f'# paths = "line.bodies.{body}.youngs_modulus_Pa"'
