"""Wrong model files: each gives one clear error with its place, the value met and what would be right."""

import copy
import datetime
import tomllib
import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from permway.errors import InputError, SolveError
from permway.formats.model_file import model_from_dict, read_model
from permway.model.irregularity import RangeWarning
from permway.problem.model import Frequencies, Model
from permway.problem.solve import solve

LAYOUT = """\
[line.bodies.slab]
type = "beam"
youngs_modulus_Pa = 3.6e10
second_moment_m4 = 1.7e-3
density_kg_per_m3 = 2500.0
area_m2 = 0.5
intervals_m = [[0.0, 5.0], [5.0, 10.0], [10.1, 15.0]]
changes = [
    { from_m = 1.0, to_m = 2.0, bending_factor = 0.5 },
    { from_m = 11.0, to_m = 15.0, bending_factor = 0.8, mass_factor = 0.9 },
]

[line.bodies.axle]
type = "shaft"
shear_modulus_Pa = 1.5e10
torsion_constant_m4 = 0.02
density_kg_per_m3 = 2500.0
polar_moment_m4 = 0.4
arm_m = 0.75
intervals_m = [[20.0, 26.0]]
changes = [{ from_m = 21.0, to_m = 22.0, torsion_factor = 0.5 }]

[line.laws.soil]
type = "measured"
quantity = "impedance"
frequency_Hz = [1.0, 500.0]
real = [2.0e6, 1.0e6]
imaginary = [-3.0e8, -3.0e5]

[roll]
gauge_m = 1.5

[roll.bodies]
cap = { type = "mass", radius_m = 1.2 }

[roll.bodies.slab]
type = "beam"
shear_modulus_Pa = 1.5e10
torsion_constant_m4 = 0.02
polar_moment_m4 = 0.4
changes = [{ from_m = 1.0, to_m = 2.0, torsion_factor = 0.6 }]

[roll.laws]
bearing = { arm_m = 1.0 }

[line.bodies.plate]
type = "mass"
mass_kg = 20.0
at = [{ from_m = 20.0, to_m = 23.0, spacing_m = 0.6 }, { from_m = 30.0, to_m = 33.0, spacing_m = 0.6 }]

[line.bodies.cap]
type = "mass"
mass_kg = 4.0e4
at = { of = "slab", inset_m = 0.5, within_m = 1.2 }

[[line.joints]]
between = ["slab", "slab"]
law = "bearing"
at = "meetings"

[[line.joints]]
between = ["slab", "cap"]
law = "bearing"
at = { of = "slab", inset_m = 0.5, within_m = 1.2 }
changes = [
    { from_m = 0.0, to_m = 6.0, factor = 0.5 },
    { from_m = 5.0, to_m = 15.0, factor_from = 1.0, factor_to = 0.2 },
]

[[line.joints]]
between = ["rail", "plate"]
law = "pad"
at = { of = "plate" }
scatter = { seed = 3, relative_std = 0.2 }

[[line.joints]]
between = ["cap", "ground"]
law = "bearing"
at = { of = "cap" }

[[line.joints]]
between = ["plate", "ground"]
law = "ballast"
at = [20.0, 20.6, 21.2, 21.8, 22.4, 23.0, 30.0, 30.6, 31.2, 31.8, 32.4, 33.0]
stiffness_is = "per_metre"
layer_m = [19.0, 34.0]

[[line.joints]]
between = ["axle", "ground"]
law = "soil"
at = [20.5, 25.5]

"""

GOOD = """\
format = 1
title = "A sleeper before a bridge of two spans"
temperature_C = 20.0
formulation = "chain"

[frequencies]
values_Hz = [10.0, 50.0, 200.0]

[line.bodies.rail]
type = "beam"
theory = "timoshenko"
youngs_modulus_Pa = 2.1e11
second_moment_m4 = 3.038e-5
density_kg_per_m3 = 7850.0
area_m2 = 7.67e-3
shear_modulus_Pa = 8.1e10
shear_coefficient = 0.4
loss_factor = 0.01

[line.bodies.girder]
type = "beam"
theory = "euler"
youngs_modulus_Pa = 3.6e10
second_moment_m4 = 5.5
density_kg_per_m3 = 2650.0
area_m2 = 4.5
loss_factor = 0.1
intervals_m = [[0.0, 32.0], [32.0, 64.0]]
ends = "free"

[line.bodies.sleeper]
type = "mass"
mass_kg = 150.0

[line.laws.pad]
type = "tfdv"
reference_temperature_C = 20.0
law = { type = "zener", relaxed = 6.0e7, unrelaxed = 3.0e8, relaxation_time_s = 1.0e-4 }
shift = { type = "free", temperatures_C = [-30.0, 20.0, 50.0], log10_shift = [2.0, 0.0, -1.0] }

[line.laws.ballast]
type = "tabulated"
frequency_Hz = [5.0, 500.0]
storage = [4.0e7, 5.0e7]
loss_factor = [0.3, 0.3]

[line.laws.bearing]
type = "hysteretic"
stiffness = 6.0e9
loss_factor = 0.25

[[line.joints]]
between = ["rail", "girder"]
law = "pad"
at = { from_m = 0.5, to_m = 63.5, spacing_m = 0.6 }

[[line.joints]]
between = ["rail", "sleeper"]
law = "pad"
at = [-5.0]

[[line.joints]]
between = ["sleeper", "ground"]
law = "ballast"
at = [-5.0]

[[line.joints]]
between = ["girder", "ground"]
law = "bearing"
at = { of = "girder", inset_m = 0.5 }

[[forces]]
body = "rail"
x_m = 16.0
name = "hammer"

[[sensors]]
body = "rail"
x_m = 16.0
name = "rail"

[[sensors]]
body = "girder"
x_m = 48.0
name = "girder"

[train]
centre_m = 16.0
speed_m_per_s = 60.0

[train.vehicle]
preset = "crh380a"
share = 0.5

[train.contact]
type = "given"
stiffness_N_per_m = 1.3e9

[irregularity]
type = "german_sato"
"""

TRAIN = GOOD[GOOD.index("[train]") :]
EXCITATION = GOOD[GOOD.index("[irregularity]") :]
FORCES = GOOD[GOOD.index("[[forces]]") : GOOD.index("[[sensors]]")]
SENSORS = GOOD[GOOD.index("[[sensors]]") : GOOD.index("[train]")]
LINE = GOOD[GOOD.index("[line.bodies.rail]") : GOOD.index("[[forces]]")]
PAD_AT = "at = { from_m = 0.5, to_m = 63.5, spacing_m = 0.6 }"
VALUES = "values_Hz = [10.0, 50.0, 200.0]"
SPANS = "intervals_m = [[0.0, 32.0], [32.0, 64.0]]"
TABLE = tomllib.loads(GOOD)
ROWS = GOOD.replace("[[line.joints]]", LAYOUT + "[[line.joints]]", 1)
ROWS_TABLE = tomllib.loads(ROWS)
PRESET = '[line]\npreset = "slab_track_viaduct_32m"\n'
SHORT = PRESET + "[line.options]\n"

# What is wrong; text of the good file and what replaces it; place; words of the message.
EDITS = [
    # Keys
    ("top-level key", 'title = "A', 'titel = "A', "titel", ["unknown key", "did you mean 'title'?"]),
    ("deep key", "area_m2 = 4.5", "area_m2 = 4.5\nlos_factor = 0.1",
     "line.bodies.girder.los_factor", ["'loss_factor'"]),
    ("key of a law", "stiffness = 6.0e9", "stifness = 6.0e9",
     "line.laws.bearing.stiffness", ["missing", "1 further"]),
    ("missing key", "area_m2 = 7.67e-3\n", "", "line.bodies.rail.area_m2", ["missing"]),
    ("missing table", "[frequencies]\n" + VALUES, "", "frequencies", ["missing"]),
    ("missing type of body", 'type = "mass"\n', "", "line.bodies.sleeper", ["type is missing"]),
    ("missing law of joint", 'law = "bearing"\n', "", "line.joints[3].law", ["missing"]),
    ("format of the future", "format = 1", "format = 2", "format", ["should be 1", "got 2"]),
    # Types
    ("text for a number", "youngs_modulus_Pa = 2.1e11", 'youngs_modulus_Pa = "2.1e11"',
     "line.bodies.rail.youngs_modulus_Pa", ["must be a number", "got '2.1e11'", "without quotes"]),
    ("truth for a number", "mass_kg = 150.0", "mass_kg = true",
     "line.bodies.sleeper.mass_kg", ["must be a number", "got True"]),
    ("words for a number", "mass_kg = 150.0", 'mass_kg = "150 kg"',
     "line.bodies.sleeper.mass_kg", ["must be a number", "'150 kg'"]),
    ("number for a table", LINE, "[[line]]\n", "line", ["must be a table"]),
    ("number for a list", VALUES, "values_Hz = 10.0", "frequencies.values_Hz", ["must be a list", "got 10.0"]),
    ("name for a table", '[line.laws.bearing]\ntype = "hysteretic"\n',
     '[line.laws]\nbearing = "stiff"\n[ignored]\n',
     "line.laws.bearing", ["must be a table", "got 'stiff'"]),
    ("key of another table", "mass_kg = 150.0", "mass_kg = 150.0\narea_m2 = 0.1",
     "line.bodies.sleeper.area_m2", ["does not belong in this table"]),
    ("number for a name", 'law = "bearing"', "law = 4", "line.joints[3].law", ["string", "got 4"]),
    ("one body in a joint", 'between = ["girder", "ground"]', 'between = ["girder"]',
     "line.joints[3].between", ["two bodies", "ground", "['girder']"]),
    ("place as a number", "at = [-5.0]", "at = -5.0",
     "line.joints[1].at", ["list of stations", "spacing_m", "got -5.0"]),
    ("place in words", "at = [-5.0]", 'at = [-5.0, "here"]',
     "line.joints[1].at[1]", ["must be a number", "'here'"]),
    ("interval of three", SPANS, "intervals_m = [[0.0, 32.0, 64.0]]",
     "line.bodies.girder.intervals_m[0]", ["[from, to]", "64.0"]),
    ("kind of end", 'ends = "free"', 'ends = "welded"',
     "line.bodies.girder.ends", ['"free", "pinned" or "clamped"', "'welded'"]),
    ("third end", 'ends = "free"', 'ends = ["free", "free", "free"]', "line.bodies.girder.ends", ["for each end"]),
    ("kind of body", 'type = "mass"', 'type = "sprung"',
     "line.bodies.sleeper", ["'sprung'", "'beam', 'shaft', 'mass'"]),
    ("kind of law", 'type = "hysteretic"', 'type = "spring"', "line.laws.bearing", ["'spring'", "'hysteretic'"]),
    # Numbers
    ("nan", "youngs_modulus_Pa = 3.6e10", "youngs_modulus_Pa = nan",
     "line.bodies.girder.youngs_modulus_Pa", ["finite", "got nan"]),
    ("infinity", "speed_m_per_s = 60.0", "speed_m_per_s = inf", "train.speed_m_per_s", ["finite", "got inf"]),
    ("negative modulus", "youngs_modulus_Pa = 3.6e10", "youngs_modulus_Pa = -3.6e10",
     "line.bodies.girder.youngs_modulus_Pa", ["greater than 0", "got -36000000000.0"]),
    ("no mass", "mass_kg = 150.0", "mass_kg = 0.0", "line.bodies.sleeper.mass_kg", ["greater than 0", "got 0.0"]),
    ("negative density", "density_kg_per_m3 = 2650.0", "density_kg_per_m3 = -1.0",
     "line.bodies.girder.density_kg_per_m3", ["greater than 0", "got -1.0"]),
    ("negative stiffness", "stiffness = 6.0e9", "stiffness = -6.0e9",
     "line.laws.bearing.stiffness", ["negative", "got -6000000000.0"]),
    ("no contact", "stiffness_N_per_m = 1.3e9", "stiffness_N_per_m = 0",
     "train.contact.stiffness_N_per_m", ["greater than 0", "got 0"]),
    ("negative scale", 'at = [-5.0]', "at = [-5.0]\nscale = -1.0",
     "line.joints[1].scale", ["greater than or equal to 0"]),
    ("negative loss", "loss_factor = 0.25", "loss_factor = -0.25",
     "line.laws.bearing", ["creates energy at 10 Hz", "loss is positive"]),
    # Units
    ("GPa", "youngs_modulus_Pa = 2.1e11", "youngs_modulus_Pa = 210.0",
     "line.bodies.rail.youngs_modulus_Pa", ["= 210 ", "in Pa, not GPa"]),
    ("GPa in shear", "shear_modulus_Pa = 8.1e10", "shear_modulus_Pa = 81.0",
     "line.bodies.rail.shear_modulus_Pa", ["= 81 ", "in Pa, not GPa"]),
    ("cm4", "second_moment_m4 = 3.038e-5", "second_moment_m4 = 3038.0",
     "line.bodies.rail.second_moment_m4", ["= 3038 ", "not cm4"]),
    ("cm2", "area_m2 = 7.67e-3", "area_m2 = 76.7", "line.bodies.rail.area_m2", ["= 76.7 ", "not cm2"]),
    ("t/m3", "density_kg_per_m3 = 7850.0", "density_kg_per_m3 = 7.85",
     "line.bodies.rail.density_kg_per_m3", ["= 7.85 ", "not t/m3"]),
    ("loss in percent", "loss_factor = 0.1", "loss_factor = 10.0",
     "line.bodies.girder.loss_factor", ["= 10 ", "not in percent"]),
    ("loss of a law in percent", "loss_factor = 0.25", "loss_factor = 25.0",
     "line.laws.bearing.loss_factor", ["got 25.0", "not in percent"]),
    ("km/h", "speed_m_per_s = 60.0", "speed_m_per_s = 350.0", "train.speed_m_per_s", ["got 350.0", "97.22 m/s"]),
    ("kelvin", "temperature_C = 20.0\nform", "temperature_C = 293.15\nform",
     "temperature_C", ["got 293.15", "not kelvin"]),
    ("millimetres along the line", "x_m = 48.0", "x_m = 48e6",
     "sensors[1].x_m", ["less than or equal to 1000000"]),
    ("spacing in kilometres", "spacing_m = 0.6 }", "spacing_m = 0.6e-6 }",
     "line.joints[0].at.spacing_m", ["1.05e+08 stations", "in metres?"]),
    # Names
    ("law unknown", 'law = "bearing"', 'law = "beering"', "line.joints[3].law", ["'beering'", "'bearing'"]),
    ("body unknown", 'between = ["rail", "sleeper"]', 'between = ["rail", "slepper"]',
     "line.joints[1].at[0]", ["no such body", "'slepper'", "'sleeper'"]),
    ("body of a sensor", 'body = "girder"\nx_m', 'body = "slab"\nx_m', "sensors[1]", ["no such body", "'slab'"]),
    ("third of two spans", 'body = "girder"\nx_m', 'body = "girder[3]"\nx_m',
     "sensors[1]", ["no such body", "[2]"]),
    ("body of the train", "centre_m = 16.0", 'centre_m = 16.0\nbody = "rayl"',
     "train.wheels[0]", ["'rayl'", "'rail'"]),
    ("ends of nothing", '{ of = "girder", inset_m = 0.5 }', '{ of = "bridge" }',
     "line.joints[3].at.of", ["'bridge'", "'girder'"]),
    ("name not for a body", "[line.bodies.sleeper]", '[line.bodies."3 sleepers"]',
     "line.bodies.3 sleepers", ["cannot name a body", "letters"]),
    ("ground as a body", "[line.bodies.sleeper]", "[line.bodies.ground]",
     "line.bodies.ground", ["cannot name a body"]),
    ("sensors of one name", 'name = "girder"\n\n[train]', 'name = "rail"\n\n[train]',
     "sensors[1]", ["stands twice", "'rail'"]),
    ("preset of a line", LINE, PRESET.replace("32m", "40m"),
     "line.preset", ["no such preset", "slab_track_viaduct_32m"]),
    ("preset of a vehicle", 'preset = "crh380a"', 'preset = "tgv"',
     "train.vehicle.preset", ["'tgv'", "'crh380a'"]),
    ("preset of a law", LINE, PRESET + '[line.laws.pad]\npreset = "wj8"\n',
     "line.laws.pad.preset", ["'wj8'", "'wj7b'"]),
    ("temperature of a preset", LINE, PRESET + '[line.laws.pad]\npreset = "wj7b_constant"\ntemperature_C = 10\n',
     "line.laws.pad.temperature_C", ["got 10", "20, -20 or -30"]),
    ("law that a preset has not", LINE, PRESET + '[line.laws.ballast]\ntype = "hysteretic"\nstiffness = 1e8\n',
     "line.laws.ballast", ["no such law", "'mortar'"]),
    ("option unknown", LINE, SHORT + "spanz = 2\n", "line.options.spanz", ["unknown key", "'spans'"]),
    ("option in words", LINE, SHORT + 'spans = "2"\n', "line.options.spans", ["integer", "got '2'"]),
    ("too many fasteners", LINE, SHORT + "fasteners = 90\n", "line.options.fasteners", ["do not fit", "got 90"]),
    ("body beside a preset", LINE, PRESET + "[line.bodies.slab]\n", "line.bodies", ["does not go with a preset"]),
    ("options without a preset", "[line.bodies.rail]", "[line.options]\nspans = 2\n[line.bodies.rail]",
     "line.options", ["unknown key"]),
    ("irregularity unknown", 'type = "german_sato"', 'type = "german"',
     "irregularity", ["'german'", "'german_low'"]),
    # Places
    ("joint off a body", "to_m = 63.5", "to_m = 65.9",
     "line.joints[0].at[106]", ["off the girder", "32 to 64 m", "got 64.1"]),
    ("sensor off a body", "x_m = 48.0", "x_m = 70.0", "sensors[1]", ["off the girder", "got 70.0"]),
    ("sensor where spans meet", "x_m = 48.0", "x_m = 32.0",
     "sensors[1]", ["['girder[1]', 'girder[2]']", "name the one"]),
    ("wheels off a body", "centre_m = 16.0", 'centre_m = 9.0\nbody = "girder[1]"',
     "train.wheels[3]", ["off the girder[1]"]),
    ("interval reversed", SPANS, "intervals_m = [[32.0, 0.0]]",
     "line.bodies.girder.intervals_m[0]", ["(32, 0)", "left to right"]),
    ("spans overlap", SPANS, "intervals_m = [[0.0, 32.0], [31.0, 64.0]]",
     "line.bodies.girder.intervals_m[1]", ["(31, 64)", "before 32 m"]),
    ("spacings not whole", "to_m = 63.5", "to_m = 63.7",
     "line.joints[0].at.to_m", ["105.333 spacings", "nearest to_m is 63.5"]),
    ("spread reversed", "to_m = 63.5", "to_m = -63.5", "line.joints[0].at.to_m", ["-63.5 lies left of"]),
    ("station twice", "at = [-5.0]", "at = [-5.0, -4.4, -5.0]",
     "line.joints[1].at", ["share a station", "got -5.0"]),
    ("no station", "at = [-5.0]", "at = []", "line.joints[1].at", ["empty", "at least one"]),
    ("ends of an endless body", '{ of = "girder", inset_m = 0.5 }', '{ of = "rail" }',
     "line.joints[3].at.of", ["rail has no ends", "intervals_m"]),
    ("ends of a mass", '{ of = "girder", inset_m = 0.5 }', '{ of = "sleeper" }',
     "line.joints[3].at.of", ["sleeper has no ends"]),
    ("inset past the middle", "inset_m = 0.5", "inset_m = 16.0",
     "line.joints[3].at.inset_m", ["32 m long", "got 16.0"]),
    ("ground above", 'between = ["girder", "ground"]', 'between = ["ground", "girder"]',
     "line.joints[3].between", ["the ground can only be the lower"]),
    ("body to itself", 'between = ["girder", "ground"]', 'between = ["girder", "girder"]',
     "line.joints[3].between", ["both bodies are 'girder'"]),
    ("span to itself", 'between = ["girder", "ground"]\nlaw = "bearing"\nat = { of = "girder", inset_m = 0.5 }',
     'between = ["girder[1]", "girder"]\nlaw = "bearing"\nat = [5.0]',
     "line.joints[3].between", ["girder[1] to itself"]),
    ("layer of single springs", "at = [-5.0]", "at = [-5.0]\nlayer_m = [-6.0, -4.0]",
     "line.joints[1].layer_m", ['stiffness_is = "total"']),
    ("layer that ends before", PAD_AT, PAD_AT + '\nstiffness_is = "total"\nlayer_m = [0.0, 32.0]',
     "line.joints[0].layer_m", ["does not hold all stations"]),
    ("total at ends", 'at = { of = "girder", inset_m = 0.5 }', 'at = { of = "girder" }\nstiffness_is = "total"',
     "line.joints[3].stiffness_is", ["not its ends"]),
    # Beams
    ("modes of timoshenko", 'ends = "free"',
     'ends = "free"\nmodes = 20\nshear_modulus_Pa = 1e10\nshear_coefficient = 0.8',
     "line.bodies.girder", ["an euler beam has no shear_modulus_Pa"]),
    ("shear forgotten", 'theory = "euler"', 'theory = "timoshenko"',
     "line.bodies.girder", ["needs shear_modulus_Pa"]),
    ("modes of an endless beam", "shear_coefficient = 0.4\n", "shear_coefficient = 0.4\nmodes = 20\n",
     "line.bodies.rail.modes", ["a beam with ends"]),
    ("modes of a timoshenko girder", 'theory = "euler"',
     'theory = "timoshenko"\nmodes = 20\nshear_modulus_Pa = 1e10\nshear_coefficient = 0.8',
     "line.bodies.girder.modes", ["for euler beams"]),
    ("half a mode", 'ends = "free"', "modes = 2.5", "line.bodies.girder.modes", ["integer", "got 2.5"]),
    # Frequencies
    ("0 Hz", VALUES, "values_Hz = [0.0, 50.0]",
     "frequencies.values_Hz[0]", ["above 0 Hz", "got 0.0", "leave 0 Hz out"]),
    ("negative frequency", VALUES, "values_Hz = [10.0, -50.0]",
     "frequencies.values_Hz[1]", ["above 0 Hz", "got -50.0"]),
    ("unsorted", VALUES, "values_Hz = [10.0, 200.0, 50.0]",
     "frequencies.values_Hz[2]", ["ascend", "got 50.0", "follows 200 Hz"]),
    ("repeated", VALUES, "values_Hz = [10.0, 10.0]", "frequencies.values_Hz[1]", ["ascend", "drop repetitions"]),
    ("none", VALUES, "values_Hz = []", "frequencies.values_Hz", ["at least 1"]),
    ("both forms", VALUES, VALUES + "\nfrom_Hz = 1.0\nto_Hz = 2.0\npoints = 2", "frequencies", ["not both"]),
    ("neither form", VALUES, "points = 10", "frequencies", ["give values_Hz, or from_Hz and to_Hz"]),
    ("no step", VALUES, "from_Hz = 1.0\nto_Hz = 2.0", "frequencies", ["step_Hz (equal steps)", "points"]),
    ("two steps", VALUES, "from_Hz = 1.0\nto_Hz = 2.0\nstep_Hz = 1.0\npoints = 3", "frequencies", ["give one of"]),
    ("from above to", VALUES, "from_Hz = 20.0\nto_Hz = 10.0\npoints = 5",
     "frequencies.to_Hz", ["10 Hz lies below", "20"]),
    ("too many", VALUES, "from_Hz = 10.0\nto_Hz = 500.0\nstep_Hz = 1e-9",
     "frequencies.step_Hz", ["more than 10000000"]),
    ("points between nothing", VALUES, "from_Hz = 10.0\nto_Hz = 10.0\npoints = 5",
     "frequencies.points", ["5 points do not fit"]),
    # The parts together
    ("train alone", EXCITATION, "", "the file", ["a train needs an irregularity"]),
    ("irregularity alone", TRAIN, EXCITATION, "the file", ["an irregularity a train"]),
    ("nothing asked", FORCES + SENSORS + TRAIN, "", "the file", ["nothing to compute", "[[forces]]"]),
    ("forces without sensors", SENSORS, "", "the file", ["forces without [[sensors]]"]),
    ("speed twice", "speed_m_per_s = 60.0", "speed_m_per_s = 60.0\nspeed_km_per_h = 216.0",
     "train", ["given twice"]),
    ("speed of light", "speed_m_per_s = 60.0", "speed_km_per_h = 1.08e9", "train.speed_km_per_h", ["at most 540"]),
    ("bogies overlap", "share = 0.5", "share = 0.5\nwheelbase_m = 20.0",
     "train.vehicle", ["the bogies would overlap"]),
    ("share of two", "share = 0.5", "share = 2.0", "train.vehicle.share", ["less than or equal to 1", "got 2.0"]),
    ("no temperature", "temperature_C = 20.0\nform", "form",
     "line.laws.pad", ["depends on temperature", "degrees Celsius"]),
    ("temperature beyond the shift", "temperature_C = 20.0\nform", "temperature_C = 60.0\nform",
     "line.laws.pad", ["-30 to 50 degC", "got 60.0"]),
    ("frequency beyond the table", VALUES, "values_Hz = [10.0, 800.0]",
     "line.laws.ballast", ["5 to 500 Hz", "got 800.0"]),
    ("columns of a table", "storage = [4.0e7, 5.0e7]", "storage = [4.0e7]",
     "line.laws.ballast", ["storage has 1 rows"]),
    ("formulation unknown", 'formulation = "chain"', 'formulation = "fem"',
     "formulation", ["'chain' or 'receptance'", "'fem'"]),
]  # fmt: skip


CAP_AT = 'at = { of = "slab", inset_m = 0.5, within_m = 1.2 }'
PLATE_AT = (
    "at = [{ from_m = 20.0, to_m = 23.0, spacing_m = 0.6 }, { from_m = 30.0, to_m = 33.0, spacing_m = 0.6 }]"
)
BED = 'stiffness_is = "per_metre"\nlayer_m = [19.0, 34.0]'
BED_AT = "at = [20.0, 20.6, 21.2, 21.8, 22.4, 23.0, 30.0, 30.6, 31.2, 31.8, 32.4, 33.0]"
GRADED = "    { from_m = 5.0, to_m = 15.0, factor_from = 1.0, factor_to = 0.2 },\n"
THINNED = "from_m = 1.0, to_m = 2.0, bending_factor = 0.5"
LOST = "{ from_m = 0.0, to_m = 6.0, factor = 0.5 }"

# The same of the file with rows of masses, piers, dowels, changes and scatter.
LAYOUT_EDITS = [
    # Rows of masses
    ("row at a number", PLATE_AT, "at = 20.0",
     "line.bodies.plate.at", ["list of stations", "{of = a row}", "20.0"]),
    ("row at nothing", PLATE_AT, "at = []", "line.bodies.plate.at", ["at least one station"]),
    ("row at meetings", PLATE_AT, 'at = "meetings"', "line.bodies.plate.at", ["list of stations", "'meetings'"]),
    ("row in words", PLATE_AT, 'at = [20.0, "21"]', "line.bodies.plate.at[1]", ["must be a number", "'21'"]),
    ("second spread reversed", "from_m = 30.0, to_m = 33.0", "from_m = 33.0, to_m = 30.0",
     "line.bodies.plate.at[1].to_m", ["30 lies left of from_m = 33"]),
    ("key of a spread", "spacing_m = 0.6 }]", "spacing = 0.6 }]",
     "line.bodies.plate.at[1].spacing_m", ["missing", "1 further"]),
    ("spreads overlap", "from_m = 30.0, to_m = 33.0", "from_m = 23.0, to_m = 26.0",
     "line.bodies.plate.at", ["two masses of the row stand at 23 m", "once"]),
    ("row off its layer", "from_m = 30.0, to_m = 33.0", "from_m = 30.1, to_m = 33.1",
     "line.joints[4].at[6]", ["off the plate, which stands at 20, 20.6", "got 30.0"]),
    ("mass that nothing holds", "mass_kg = 150.0", "mass_kg = 150.0\nat = [-5.0, -4.4]",
     "line.bodies.sleeper.at", ["nothing holds sleeper[2] at -4.4 m", "leave the mass out"]),
    ("ends of nothing", CAP_AT, 'at = { of = "pier" }', "line.bodies.cap.at.of", ["no body 'pier'", "'slab'"]),
    ("ends of an endless beam", CAP_AT, 'at = { of = "rail" }', "line.bodies.cap.at.of", ["rail has no ends"]),
    ("at its own places", CAP_AT, 'at = { of = "cap" }', "line.bodies.cap.at.of", ["where it stands itself"]),
    ("places of a single mass", CAP_AT, 'at = { of = "sleeper" }', "line.bodies.cap.at.of", ["give it at"]),
    ("inset of masses", 'at = { of = "plate" }', 'at = { of = "plate", inset_m = 0.1 }',
     "line.joints[2].at.inset_m", ["row of masses"]),
    ("reach below zero", "within_m = 1.2 }\n\n[[", "within_m = -1.2 }\n\n[[",
     "line.bodies.cap.at.within_m", ["greater than or equal to 0", "-1.2"]),
    ("cap out of reach", "within_m = 1.2 }\nchanges", "within_m = 0.1 }\nchanges",
     "line.joints[1].at[1]", ["no cap stands within 0.1 m", "nearest stands at 5 m", "within_m"]),
    ("sensor beside a mass", 'body = "girder"\nx_m = 48.0', 'body = "plate"\nx_m = 20.3',
     "sensors[1]", ["off the plate, which stands at", "got 20.3"]),
    # Dowels
    ("dowels of two bodies", 'between = ["slab", "slab"]', 'between = ["slab", "girder"]',
     "line.joints[0].between", ["ties the beams of one row"]),
    ("a row tied without meetings", 'at = "meetings"', "at = [5.0]",
     "line.joints[0].between", ["both bodies are 'slab'", "meetings"]),
    ("another word", 'at = "meetings"', 'at = "meeting"', "line.joints[0].at", ["list of stations", "'meeting'"]),
    ("slabs apart", "[[0.0, 5.0], [5.0, 10.0], [10.1, 15.0]]", "[[0.0, 4.9], [5.0, 10.0], [10.1, 15.0]]",
     "line.joints[0].at", ["no two beams of slab meet", "start where the other stops"]),
    ("dowels of nothing", 'between = ["slab", "slab"]', 'between = ["slob", "slob"]',
     "line.joints[0].between[0]", ["no such body", "'slob'"]),
    ("dowels of masses", 'between = ["slab", "slab"]', 'between = ["plate", "plate"]',
     "line.joints[0].at", ["no two beams of plate meet"]),
    ("dowels per metre", 'at = "meetings"', 'at = "meetings"\nstiffness_is = "per_metre"',
     "line.joints[0].stiffness_is", ["stations along the layer"]),
    # Layers by length
    ("kind of stiffness", BED, 'stiffness_is = "per_meter"',
     "line.joints[4].stiffness_is", ["'each', 'total' or 'per_metre'"]),
    ("bed too short", BED, 'stiffness_is = "per_metre"\nlayer_m = [20.5, 34.0]',
     "line.joints[4].layer_m", ["does not hold all stations"]),
    ("one station per metre", BED_AT + "\n" + BED, 'at = [20.0]\nstiffness_is = "per_metre"',
     "line.joints[4].at", ["stands for no length", "layer_m"]),
    ("bounds of two stretches", BED_AT, PLATE_AT, "line.joints[4].layer_m", ["bounds one stretch"]),
    # Changes and scatter
    ("change of nothing", LOST, "{ from_m = 5.6, to_m = 9.0, factor = 0.5 }",
     "line.joints[1].changes[0]", ["holds no joint", "(5.6, 9.0)", "from 0.5 to 14.5 m"]),
    ("change reversed", LOST, "{ from_m = 6.0, to_m = 0.0, factor = 0.5 }",
     "line.joints[1].changes[0].to_m", ["0 lies left of from_m = 6"]),
    ("change without a factor", LOST, "{ from_m = 0.0, to_m = 6.0 }",
     "line.joints[1].changes[0].factor", ["give factor, or factor_from and factor_to"]),
    ("change of two kinds", LOST, "{ from_m = 0.0, to_m = 6.0, factor = 0.5, factor_to = 0.1 }",
     "line.joints[1].changes[0].factor", ["give factor, or"]),
    ("half graded", "factor_from = 1.0, factor_to = 0.2", "factor_from = 1.0",
     "line.joints[1].changes[1].factor", ["factor_from and factor_to"]),
    ("graded at a point", "from_m = 5.0, to_m = 15.0, factor_from", "from_m = 5.5, to_m = 5.5, factor_from",
     "line.joints[1].changes[1].to_m", ["needs a length"]),
    ("negative factor", LOST, "{ from_m = 0.0, to_m = 6.0, factor = -0.5 }",
     "line.joints[1].changes[0].factor", ["greater than or equal to 0"]),
    ("changes as a table", "changes = [\n    " + LOST + ",\n" + GRADED + "]", "changes = " + LOST,
     "line.joints[1].changes", ["must be a list"]),
    ("key of a change", "6.0, factor = 0.5", "6.0, faktor = 0.5", "line.joints[1].changes[0]", ["'factor'"]),
    ("scatter in percent", "relative_std = 0.2", "relative_std = 20.0",
     "line.joints[2].scatter.relative_std", ["less than or equal to 10", "20.0"]),
    ("seed in words", "seed = 3", 'seed = "three"', "line.joints[2].scatter.seed", ["integer", "'three'"]),
    ("seed forgotten", "seed = 3, ", "", "line.joints[2].scatter.seed", ["missing"]),
    # Sections that change
    ("change off the slabs", THINNED, "from_m = 16.0, to_m = 17.0, bending_factor = 0.5",
     "line.bodies.slab.changes[0]", ["(16, 17) m does not lie on one body", "10.1 to 15 m"]),
    ("change over two slabs", THINNED, "from_m = 4.0, to_m = 6.0, bending_factor = 0.5",
     "line.bodies.slab.changes[0]", ["(4, 6) m does not lie on one body"]),
    ("changes overlap", THINNED, "from_m = 10.5, to_m = 11.5, bending_factor = 0.5",
     "line.bodies.slab.changes[1]", ["(11, 15) m begins before 11.5 m", "no overlap"]),
    ("nothing left of a beam", THINNED, "from_m = 1.0, to_m = 2.0, bending_factor = 0.0",
     "line.bodies.slab.changes[0].bending_factor", ["greater than 0"]),
    ("negative mass left", "mass_factor = 0.9", "mass_factor = -0.9",
     "line.bodies.slab.changes[1].mass_factor", ["greater than 0", "-0.9"]),
    ("no number left", "bending_factor = 0.8", "bending_factor = nan",
     "line.bodies.slab.changes[1].bending_factor", ["got nan"]),
    ("change to infinity", THINNED, "from_m = 1.0, to_m = inf, bending_factor = 0.5",
     "line.bodies.slab.changes[0].to_m", ["got inf"]),
    ("section change reversed", THINNED, "from_m = 2.0, to_m = 1.0, bending_factor = 0.5",
     "line.bodies.slab.changes[0].to_m", ["1 lies left of from_m = 2"]),
    ("section change at a point", THINNED, "from_m = 1.0, to_m = 1.0, bending_factor = 0.5",
     "line.bodies.slab.changes[0].to_m", ["too near"]),
    ("section change of nothing", THINNED, "from_m = 1.0, to_m = 2.0",
     "line.bodies.slab.changes[0]", ["changes nothing", "'bending_factor', 'mass_factor', 'shear_factor'"]),
    ("shear of an euler beam", THINNED, "from_m = 1.0, to_m = 2.0, shear_factor = 0.5",
     "line.bodies.slab.changes[0].shear_factor", ["no shear stiffness"]),
    ("torsion of a beam", THINNED, "from_m = 1.0, to_m = 2.0, torsion_factor = 0.5",
     "line.bodies.slab.changes[0].torsion_factor", ["does not belong"]),
    ("section of a mass", "mass_kg = 150.0", "mass_kg = 150.0\nchanges = []",
     "line.bodies.sleeper.changes", ["does not belong in this table"]),
    ("modes of a stepped beam", "intervals_m = [[0.0, 5.0]", "modes = 9\nintervals_m = [[0.0, 5.0]",
     "line.bodies.slab.modes", ["uniform beams"]),
    # Shafts
    ("bending of a shaft", "torsion_factor = 0.5", "bending_factor = 0.5",
     "line.bodies.axle.changes[0].bending_factor", ["does not belong"]),
    ("shaft without an arm", "arm_m = 0.75\n", "", "line.bodies.axle.arm_m", ["missing"]),
    ("arm in millimetres", "arm_m = 0.75", "arm_m = 750.0", "line.bodies.axle.arm_m", ["= 750 ", "in metres"]),
    ("shaft in GPa", "shear_modulus_Pa = 1.5e10\ntorsion", "shear_modulus_Pa = 15.0\ntorsion",
     "line.bodies.axle.shear_modulus_Pa", ["not GPa"]),
    ("stiffer than round", "torsion_constant_m4 = 0.02\n", "torsion_constant_m4 = 0.5\n",
     "line.bodies.axle.torsion_constant_m4", ["above polar_moment_m4 = 0.4"]),
    ("shaft off its joints", "intervals_m = [[20.0, 26.0]]", "intervals_m = [[20.0, 25.0]]",
     "line.joints[5].at[1]", ["off the axle", "got 25.5"]),
    # Tables of impedance
    ("kind of table", 'quantity = "impedance"', 'quantity = "mobility"',
     "line.laws.soil.quantity", ["'dynamic_stiffness', 'impedance' or 'apparent_mass'"]),
    ("rows of a table", "real = [2.0e6, 1.0e6]", "real = [2.0e6]", "line.laws.soil", ["real has 1 rows"]),
    ("table that gives power", "real = [2.0e6, 1.0e6]", "real = [-2.0e6, 1.0e6]",
     "line.laws.soil", ["creates energy at 10 Hz"]),
    # Two rails
    ("gauge in millimetres", "gauge_m = 1.5", "gauge_m = 1500.0", "roll.gauge_m", ["less than 10"]),
    ("roll of what is not there", "cap = { type", "pier = { type", "roll.bodies.pier", ["no such name", "'cap'"]),
    ("roll of a law that is not there", "bearing = { arm_m", "baering = { arm_m",
     "roll.laws.baering", ["no such name", "'bearing'"]),
    ("twist of a mass", '{ type = "mass", radius_m = 1.2 }', '{ type = "beam", shear_modulus_Pa = 1e10, '
     "torsion_constant_m4 = 0.1, polar_moment_m4 = 0.2 }", "roll.bodies.cap.type", ["is a mass on the line"]),
    ("law without a lever", "bearing = { arm_m = 1.0 }", "", "roll.laws.bearing", ["joints[0] tie slab to slab"]),
    ("lever of nothing", "{ arm_m = 1.0 }", "{ }", "roll.laws.bearing", ["give width_m or arm_m"]),
    ("two levers", "{ arm_m = 1.0 }", "{ arm_m = 1.0, width_m = 2.0 }", "roll.laws.bearing", ["give width_m or"]),
    ("twist that does not change", "changes = [{ from_m = 1.0, to_m = 2.0, torsion_factor = 0.6 }]", "",
     "roll.bodies.slab.changes", ["the beam's section changes", "torsion_factor"]),
    ("nothing rolls", FORCES + SENSORS, SENSORS, "roll", ["without [[forces]] nothing rolls"]),
    ("negative seed", "seed = 3", "seed = -3", "line.joints[2].scatter.seed", ["greater than or equal to 0"]),
]  # fmt: skip


def edited(old: str, new: str, good: str = GOOD) -> str:
    assert old in good, f"the good file does not contain {old!r}"
    return good.replace(old, new, 1)


@pytest.mark.parametrize("good", [GOOD, ROWS], ids=["plain", "rows"])
def test_good_file_is_good(good, tmp_path):
    path = tmp_path / "model.toml"
    path.write_text(good, encoding="utf-8")
    data = solve(read_model(path), threads=1)
    assert all(np.isfinite(v.values).all() for v in data.data_vars.values())


WRONG = [(GOOD, *e[1:]) for e in EDITS] + [(ROWS, *e[1:]) for e in LAYOUT_EDITS]


@pytest.mark.parametrize(
    ("good", "old", "new", "place", "words"), WRONG, ids=[e[0] for e in (*EDITS, *LAYOUT_EDITS)]
)
def test_wrong_model_file(good, old, new, place, words, tmp_path):
    path = tmp_path / "model.toml"
    path.write_text(edited(old, new, good), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_model(path)
    text = str(caught.value)
    at = f"{path}: {place}"
    assert text.startswith((at + ": ", at + ".")), text
    assert all(word in text for word in words), text
    assert "\n" not in text


@pytest.mark.parametrize("name", TABLE)
@pytest.mark.parametrize("value", [["x"], {"x": 1}, datetime.date(2024, 1, 1)], ids=repr)
def test_wrong_kind_of_value_at_the_top(name, value):
    """Whatever stands at a place of the top level, the error names that place first."""
    with pytest.raises(InputError) as caught:
        model_from_dict({**TABLE, name: value})
    assert caught.value.where.startswith(name)


def test_missing_file(tmp_path):
    with pytest.raises(InputError, match=r"none\.toml: cannot be read: No such file"):
        read_model(tmp_path / "none.toml")


def test_directory(tmp_path):
    with pytest.raises(InputError, match="cannot be read: Is a directory"):
        read_model(tmp_path)


def test_name_with_a_nul():
    with pytest.raises(InputError, match=r"cannot be read: .*null"):
        read_model("model\0.toml")


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no endless file on this system")
def test_endless_file():
    with pytest.raises(InputError, match="/dev/zero: is larger than 16 MiB"):
        read_model(Path("/dev/zero"))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"title = 'r\xe9sonance'", "byte 10: is not text in UTF-8; save it as UTF-8"),
        (b"\xff\xfet\x00", "byte 0: is not text in UTF-8"),
        (b"format = 1\ntitle = unquoted\n", "is not TOML: Invalid value (at line 2, column 9)"),
        (b"format = 1\nformat = 1\n", "is not TOML: Cannot overwrite a value (at line 2"),
        (b"[line\n", "is not TOML: Expected ']'"),
        (b"x = " + b"[" * 5000, "is not TOML: maximum recursion"),
        (b"x = " + b"9" * 5000, "is not TOML: Exceeds the limit"),
        (b"", "frequencies: missing; 1 further fault"),
        (b"<?xml version='1.0'?>", "is not TOML: Invalid statement (at line 1"),
    ],
)
def test_not_a_model_file(content, message, tmp_path):
    path = tmp_path / "model.toml"
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_model(path)
    assert str(caught.value).startswith(str(path))
    assert message in str(caught.value)


def test_byte_order_mark_is_no_fault(tmp_path):
    path = tmp_path / "model.toml"
    path.write_bytes(b"\xef\xbb\xbf" + GOOD.encode())
    assert read_model(path) == model_from_dict(TABLE)


SINGULAR = """
[frequencies]
values_Hz = [0.5, 1.0, 2.0]

[line]
bodies = { block = { type = "mass", mass_kg = 100.0 } }
laws = { spring = { type = "hysteretic", stiffness = 3947.8417604357433 } }
joints = [{ between = ["block", "ground"], law = "spring", at = [0.0] }]

[[forces]]
body = "block"
x_m = 0.0

[[sensors]]
body = "block"
x_m = 0.0
"""


@pytest.mark.parametrize(("formulation", "place"), [("chain", "block"), ("receptance", "joint")])
def test_resonance_without_loss_is_singular(formulation, place):
    """100 kg on (2 pi)^2 100 N/m: nothing resists at 1 Hz exactly."""
    model = model_from_dict({**tomllib.loads(SINGULAR), "formulation": formulation})
    with pytest.raises(SolveError, match=rf"(singular|badly conditioned) at 1 Hz: .*{place}"):
        solve(model, threads=1)


HOSTILE = st.one_of(
    st.none(),
    st.booleans(),
    st.sampled_from([0, -1, 1, 2, 64, 10**9, 10**400, -0.0, 0.5, 32.0, 5e-324, 1e-3, 1e12, 1e200, 1.7e308]),
    st.sampled_from(
        [float("nan"), float("inf"), float("-inf"), "", "rail", "ground", "1e3", "\0", "crh380a", "wj7b"]
    ),
    st.floats(1e-6, 1e6),
    st.lists(st.floats(-10.0, 70.0), max_size=3),
    st.sampled_from([{}, [], [[]], [[0.0, 64.0]], {"of": "girder"}, {"preset": "wj7b"}, {"type": "beam"}]),
)
PRESETS = {
    **TABLE,
    "line": {
        "preset": "slab_track_viaduct_32m",
        "options": {"spans": 1, "model": "half", "girder": "pinned", "fasteners": 51, "modes": 30},
        "laws": {"pad": {"preset": "wj7b_constant", "temperature_C": -20}},
    },
    "sensors": [{"body": "girder", "x_m": 9.0, "name": "girder"}],
    "formulation": "receptance",
}


def places(table, above=()):
    """Every place in a nested table, as keys from the root."""
    inside = table.items() if isinstance(table, dict) else enumerate(table) if isinstance(table, list) else ()
    for key, value in inside:
        yield (*above, key)
        yield from places(value, (*above, key))


def parent(table, place):
    for key in place[:-1]:
        table = table[key]
    return table


@st.composite
def mutated(draw):
    """A good model with one to three places deleted, replaced, swapped, or numbers made larger or smaller."""
    table = copy.deepcopy(draw(st.sampled_from([TABLE, ROWS_TABLE, PRESETS])))
    for _ in range(draw(st.integers(1, 3))):
        place = draw(st.sampled_from(list(places(table)) or [None]))
        if place is None:
            break
        change = draw(st.sampled_from(["delete", "replace", "swap", "scale", "scale", "scale"]))
        if change == "delete":
            del parent(table, place)[place[-1]]
        elif change == "replace":
            parent(table, place)[place[-1]] = copy.deepcopy(draw(HOSTILE))
        elif change == "scale":
            numbers = [p for p in places(table) if type(parent(table, p)[p[-1]]) is float]
            place = draw(st.sampled_from(numbers or [place]))
            if numbers:
                parent(table, place)[place[-1]] *= 10.0 ** draw(st.integers(-12, 12))
        else:
            other = draw(st.sampled_from(list(places(table))))
            value = copy.deepcopy(parent(table, other)[other[-1]])
            parent(table, place)[place[-1]] = value
    return table


@settings(max_examples=400, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(mutated())
def test_a_mutated_model_is_read_or_refused_and_a_read_one_solved_or_refused(table):
    """Nothing but an InputError or a SolveError comes out, no warning of an overflow, and no NaN."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RangeWarning)
        try:
            model = model_from_dict(table)
        except InputError:
            return
        assert isinstance(model, Model)
        try:
            data = solve(model.model_copy(update={"frequencies": Frequencies(values_Hz=(20.0, 60.0))}), threads=1)
        except (InputError, SolveError):
            return
    assert data.attrs["failures"] == ""
    for name, values in data.data_vars.items():
        assert np.isfinite(values.values).all(), name
