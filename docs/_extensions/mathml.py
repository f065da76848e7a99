"""Equations as MathML, which browsers draw by themselves: no script, nothing fetched.

docutils turns LaTeX into MathML; what it does not know is a warning, and so stops the build.
"""

from __future__ import annotations

from itertools import zip_longest
from typing import Any
from xml.etree import ElementTree as Xml

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.util.math import get_node_equation_number

_log = logging.getLogger(__name__)

_NAMESPACE = "http://www.w3.org/1998/Math/MathML"
_APPLY = "\u2061"
_HAT = "\u02c6"
_OPENS = {"(", "[", "{"}


def _mathml(text: str, node: nodes.Element, *, as_block: bool) -> str:
    try:
        return _spaced(str(tex2mathml(text, as_block=as_block)))
    except Exception as error:  # noqa: BLE001 - docutils raises several kinds for what it cannot read
        _log.warning("equation not understood: %s", error, location=node)
        return ""


def _spaced(text: str) -> str:
    """Draw as TeX does what docutils leaves to browsers: subscripts of hats, names of functions, bars, slashes."""
    Xml.register_namespace("", _NAMESPACE)
    root = Xml.fromstring(text.replace("&ApplyFunction;", _APPLY))
    for node in list(root.iter()):
        _name(node)
        _split_hat(node)
        if _tag(node) == "mo" and node.text in ("|", "/"):
            node.attrib.update(lspace="0", rspace="0")
        if node.get("class") == "ams-align":
            node.set("displaystyle", "true")
    return Xml.tostring(root, encoding="unicode")


def _tag(node: Xml.Element) -> str:
    return node.tag.rpartition("}")[2]


def _split_hat(node: Xml.Element) -> None:
    """A subscript stands at the side of a letter with a hat, not below it."""
    if _tag(node) != "munderover" or node[2].text != _HAT:
        return
    letter, subscript, hat = node
    over = Xml.Element(f"{{{_NAMESPACE}}}mover", accent="true")
    over.extend((letter, hat))
    node.tag = f"{{{_NAMESPACE}}}msub"
    node[:] = [over, subscript]


def _name(row: Xml.Element) -> None:
    """A thin space between the name of a function and what stands beside it, unless that is a bracket."""
    children: list[Xml.Element] = []
    for child, after in zip_longest(list(row), row[1:]):
        if _tag(child) == "mo" and child.text == _APPLY:
            function = children.pop()
            if children and _tag(children[-1]) != "mo" and _tag(children[-1]) != "mspace":
                children.append(_thin())
            children.append(function)
            child = None if after is None or after.text in _OPENS else _thin()
        if child is not None:
            children.append(child)
    row[:] = children


def _thin() -> Xml.Element:
    return Xml.Element(f"{{{_NAMESPACE}}}mspace", width="0.167em")


def _inline(translator: Any, node: nodes.Element) -> None:
    translator.body.append(_mathml(node.astext(), node, as_block=False))
    raise nodes.SkipNode


def _block(translator: Any, node: nodes.Element) -> None:
    text = node.astext()
    if "\\\\" in text and "\\begin" not in text:
        text = f"\\begin{{aligned}}{text}\\end{{aligned}}"
    translator.body.append(translator.starttag(node, "div", CLASS="math equation"))
    translator.body.append(f'<div class="formula">{_mathml(text, node, as_block=True)}</div>')
    if node["number"]:
        translator.body.append(f'<span class="eqno">({get_node_equation_number(translator, node)})')
        translator.add_permalink_ref(node, "Link to this equation")
        translator.body.append("</span>")
    translator.body.append("</div>")
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
