"""What the page on the architecture says of imports and threads, by the code."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import permway
import pytest

ROOT = Path(permway.__file__).parent
PAGE = (Path(__file__).parents[2] / "docs" / "architecture.md").read_text("utf-8")
CHAIN = ("laws", "model", "response", "recordings", "checking", "diagnosis", "posterior", "report")
"""In the order of the page: each may import those before it."""

EXCEPTIONS = {
    ("model/file.py", "response"),
    ("model/file.py", "report"),
    ("model/line.py", "report"),
    ("recordings/campaign.py", "report"),
}
"""Module, and the package further on from which it imports; the page names them."""

SMALL = "challenge/small"
"""The one part of the challenge that uses the tool's own model: to make half of its campaigns by it."""

BESIDE = {
    "challenge": set(),
    SMALL: {"laws", "model", "recordings", "diagnosis"},
    "study": {"model", "response"},
    "paper": {"laws", "model", "response"},
}
"""Of the chain, what the packages beside it import."""


def imported(package: str) -> Iterator[tuple[str, str]]:
    """Module by module, the packages of permway that it imports anywhere, but for type checkers.

    The challenge is without its small campaigns, which are asked for by themselves.
    """
    for path in sorted((ROOT / package).rglob("*.py")):
        name = path.relative_to(ROOT).as_posix()
        if package == "challenge" and name.startswith(SMALL + "/"):
            continue
        tree = ast.parse(path.read_text("utf-8"))
        typing = [n for n in ast.walk(tree) if isinstance(n, ast.If) and ast.unparse(n.test) == "TYPE_CHECKING"]
        left_out = {id(inner) for block in typing for inner in ast.walk(block)}
        for node in ast.walk(tree):
            if id(node) in left_out:
                continue
            if isinstance(node, ast.ImportFrom) and node.module:
                found = [node.module] if node.module != "permway" else [f"permway.{a.name}" for a in node.names]
            elif isinstance(node, ast.Import):
                found = [alias.name for alias in node.names]
            else:
                continue
            for module in found:
                if module.startswith("permway."):
                    yield name, module.split(".")[1]


def test_the_order_is_that_of_the_page() -> None:
    assert "`" + "`, `".join(CHAIN) + "`" in PAGE


@pytest.mark.parametrize("package", CHAIN)
def test_nothing_else_is_imported_of_what_is_further_on(package: str) -> None:
    later = CHAIN[CHAIN.index(package) + 1 :]
    found = {(module, of) for module, of in imported(package) if of in later}
    assert found == {pair for pair in EXCEPTIONS if pair[0].startswith(package + "/")}


@pytest.mark.parametrize("package", BESIDE)
def test_packages_beside_import_what_the_page_says(package: str) -> None:
    found = {of for _, of in imported(package)}
    assert found & {*CHAIN, *BESIDE} - {package.partition("/")[0]} == BESIDE[package]


def test_the_challenge_imports_errors_only() -> None:
    assert {of for _, of in imported("challenge")} == {"challenge", "errors"}


THREADS = """
import os
import numpy as np
import permway
from permway.model.presets import slab_track_viaduct_32m, wj7b_constant
from permway.response.receptance import Place, receptance

def count():
    return len(os.listdir("/proc/self/task"))

before = count()
at = [Place(body="rail", x_m=16.0)]
line = slab_track_viaduct_32m(pad=wj7b_constant())
receptance(line, np.linspace(1.0, 100.0, 100), forces=at, sensors=at, threads=7)
print(before, count())
"""


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="threads are counted by Linux")
def test_no_thread_is_left_of_an_import_or_a_sweep() -> None:
    # Threads that other packages start at import are theirs: of NumPy, and of numexpr where it is installed.
    env = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "NUMEXPR_NUM_THREADS": "1"}
    done = subprocess.run([sys.executable, "-c", THREADS], capture_output=True, text=True, check=True, env=env)
    assert done.stdout.split() == ["1", "1"]


def test_the_core_knows_no_python() -> None:
    manifest = Path(__file__).parents[2] / "rust" / "core" / "Cargo.toml"
    assert "pyo3" not in manifest.read_text("utf-8")
