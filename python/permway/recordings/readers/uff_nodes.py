"""Where the nodes of a universal file are: datasets 15 and 2411.

Source: University of Cincinnati, SDRL, "Universal File Formats for Modal Analysis Testing": dataset 15 is
(4I10, 1P3E13.5) for each node; dataset 2411 (4I10) and (1P3D25.16).
"""

from __future__ import annotations

from pathlib import Path

from permway.recordings.readers.uff import Block, Text, next_block, open_text, skip_block
from permway.recordings.readers.uff58_units import System, system_of

_METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": 0.0254, "ft": 0.3048}


def read_nodes(source: Path) -> dict[int, tuple[float, float, float]]:
    """Places of the nodes, m, in the file's own axes; without a dataset 164 lengths are in metres.

    Raises
    ------
    InputError
        For a dataset that is cut short or holds no numbers, with its line.
    """
    nodes: dict[int, tuple[float, float, float]] = {}
    system: System | None = None
    with open_text(source) as text:
        at = 0
        while (block := next_block(text, at)) is not None:
            end = skip_block(text, block)
            if block.kind == 164:
                system = system_of(text, block)
            elif block.kind in (15, 2411):
                scale = 1.0 if system is None or system.length is None else _METRES[system.length]
                for node, place in _places(text, block):
                    nodes[node] = (place[0] * scale, place[1] * scale, place[2] * scale)
            at = end
    return nodes


def _places(text: Text, block: Block) -> list[tuple[int, tuple[float, float, float]]]:
    found = []
    at = block.body
    while text.fence(at) is None:
        here = at
        line, at = text.line(at)
        node = text.field(line, here, 0, 10, "node")
        if block.kind == 15:
            first, width = 40, 13
        else:
            here = at
            line, at = text.line(at)
            first, width = 0, 25
        x, y, z = (text.real(line, here, first + i * width, width, "place of a node") for i in range(3))
        found.append((node, (x, y, z)))
    return found
