"""A train that rolls over supports that repeat: harmonics of their passing, coupled in frequency."""

from permway.response.rolling.harmonics import Rolled as Rolled
from permway.response.rolling.harmonics import rolled as rolled
from permway.response.rolling.kernels import Kernel as Kernel
from permway.response.rolling.kernels import kernel as kernel
from permway.response.rolling.kernels import reach as reach
