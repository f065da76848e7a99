"""A model file that is started: rail, pads and ground, with what only the user knows left open."""

from __future__ import annotations

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


def model_text() -> str:
    """The model file."""
    return _TEXT
