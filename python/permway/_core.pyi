from collections.abc import Callable, Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

__all__ = ["TablesError", "__version__", "cross_spectra", "solve_line", "spread", "vectors"]

__version__: Final[str]
vectors: Final[str]

class TablesError(ValueError): ...

def solve_line(
    *,
    formulation: str,
    frequencies: NDArray[np.float64],
    names: list[str],
    beams: Mapping[str, NDArray[Any]],
    masses: NDArray[np.float64],
    joints: Mapping[str, NDArray[Any]],
    laws: NDArray[np.complex128],
    forces: Mapping[str, NDArray[Any]],
    sensors: Mapping[str, NDArray[Any]],
    extensions: bool,
    threads: int,
    progress: Callable[[int, int], object] | None,
    derived: Mapping[str, Any] | None = None,
) -> tuple[
    NDArray[np.complex128],
    NDArray[np.complex128] | None,
    NDArray[np.complex128] | None,
    NDArray[np.complex128] | None,
    list[tuple[int, str, str]],
]: ...

_Rows = tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]

def spread(
    rows: _Rows, values: NDArray[np.complex128], late: NDArray[np.complex128]
) -> NDArray[np.complex128]: ...
def cross_spectra(smear: _Rows, fine: NDArray[np.complex128]) -> NDArray[np.complex128]: ...
