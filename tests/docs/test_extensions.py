"""What the site's extensions make of an equation, of a parameter's line, and of a link of the README."""

from __future__ import annotations

import re
import sys
from importlib import import_module
from pathlib import Path
from xml.etree import ElementTree as Xml

import pytest

DOCS = Path(__file__).parents[2] / "docs"
MATHML = "{http://www.w3.org/1998/Math/MathML}"


@pytest.fixture(scope="module", autouse=True)
def beside():
    before = list(sys.path)
    sys.path.insert(0, str(DOCS / "_extensions"))
    yield
    sys.path[:] = before


def drawn(latex: str) -> Xml.Element:
    return Xml.fromstring(import_module("mathml")._mathml(latex, None, as_block=True))


def test_a_subscript_stands_beside_a_letter_with_a_hat() -> None:
    """As `S_{oo}` without the hat; docutils alone puts it below the letter."""
    plain, hat = drawn("S_{oo}"), drawn(r"\hat S_{oo}")
    assert plain[0].tag == hat[0].tag == f"{MATHML}msub"
    assert [one.text for one in hat[0][0]] == ["S", "\u02c6"]
    assert "".join(hat[0][1].itertext()).split() == "".join(plain[0][1].itertext()).split() == ["o", "o"]


@pytest.mark.parametrize(
    ("latex", "words"),
    [
        (r"i \sin \arg z", "i sin arg z"),
        (r"\cos b \cosh b", "cos b cosh b"),
        (r"\ln(z)", "ln(z)"),
        ("a + b", "a+b"),
    ],
)
def test_names_of_functions_do_not_run_together(latex: str, words: str) -> None:
    parts = [" " if one.tag == f"{MATHML}mspace" else (one.text or "").strip() for one in drawn(latex).iter()]
    assert "".join(parts) == words


@pytest.mark.parametrize(
    ("text", "cell"),
    [
        ("1, 0 to 1: what is left", "0 to 1: what is left"),
        ("Hz, 4 to 1000: f1", "4 to 1000 Hz: f1"),
        ("1, -5e-4 to 5e-4: e", "-5e-4 to 5e-4: e"),
        ("N m/rad, 0.0003 to 3000 times E I / L: against rotation",) * 2,
        ("m: from the start",) * 2,
    ],
)
def test_a_unit_stands_behind_its_range(text: str, cell: str) -> None:
    assert import_module("effects_page")._ranged(text) == cell


def test_a_link_to_a_heading_of_a_file_outside_stays_one() -> None:
    outside = import_module("outside")
    found = outside._LINK.sub(outside._turned, "[a](CONTRIBUTING.md#add-an-effect) [b](LICENSE) [c](docs/x.md#y)")
    assert re.findall(r"\((.*?)\)", found) == ["contributing.md#add-an-effect", "#file", "x.md#y"]


def test_long_names_break_in_tables_and_nowhere_else() -> None:
    broken = import_module("breaks").broken
    name = '<span class="pre">mass_damping_per_s</span>'
    assert broken(f"<td>{name}</td>") == '<td><span class="pre">mass_<wbr>damping_<wbr>per_s</span></td>'
    assert broken(f"<p>{name}</p>") == f"<p>{name}</p>"
    assert broken('<td><span class="pre">x_m</span></td>') == '<td><span class="pre">x_m</span></td>'
