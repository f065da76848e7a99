from collections.abc import Callable, Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

__all__ = ["TablesError", "__version__", "solve_line", "vectors"]

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
