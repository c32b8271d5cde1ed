"""Kratos model parts (.mdpa): nodes, shell elements, conditions and sub model parts as groups.

Conditions are loads on nodes, edges and faces of elements: they make groups, but no elements of their own.

Source: Kratos Multiphysics documentation, "Input data".
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from kshell.errors import InputError
from kshell.mesh.formats.found import SOLID, Found
from kshell.mesh.formats.numbering import Numbering
from kshell.mesh.formats.text import real, text_of, whole
from kshell.mesh.pieces import require_one_model_part
from kshell.mesh.raw import RawMesh
from kshell.mesh.words import count

_SURFACE = re.compile(r"shell|membrane|surface|plate|face|triangle|quadrilateral|2D\dN", re.IGNORECASE)
_NODES = re.compile(r"(\d+)N$")

Rows = list[tuple[str, list[str]]]


class _Part:
    """A sub model part: its name with those above it, and the numbers in it by what they number."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.numbers: dict[str, list[int]] = {"Nodes": [], "Elements": [], "Conditions": [], "Geometries": []}


def read_mdpa(path: Path) -> RawMesh:
    """Mesh and sub model parts.

    Raises
    ------
    InputError
        If a block is not ended, or elements name nodes that are missing.
    """
    tables: list[tuple[str, str, Rows]] = []  # Nodes, Elements, Conditions, Geometries; name; rows
    parts: list[_Part] = []
    open_parts: list[_Part] = []
    block: list[str] = []
    for number, line in enumerate(text_of(path).splitlines(), 1):
        words = line.partition("//")[0].split()
        where = f"{path.name}, line {number}"
        if not words:
            continue
        if words[0] == "Begin" and len(words) > 1:
            block.append(words[1])
            require_one_model_part(words[1], path.name)
            if words[1] == "SubModelPart":
                name = words[2] if len(words) > 2 else ""
                open_parts.append(_Part(f"{open_parts[-1].name}.{name}" if open_parts else name))
                parts.append(open_parts[-1])
            elif words[1] in ("Nodes", "Elements", "Conditions", "Geometries"):
                tables.append((words[1], words[2] if len(words) > 2 else "", []))
        elif words[0] == "End" and len(words) > 1:
            if not block or block.pop() != words[1]:
                raise InputError(f"{where}: End {words[1]} ends nothing")
            if words[1] == "SubModelPart":
                open_parts.pop()
        elif block and block[-1] in ("Nodes", "Elements", "Conditions", "Geometries"):
            tables[-1][2].append((where, words))
        elif block and open_parts and block[-1][12:] in open_parts[-1].numbers:
            open_parts[-1].numbers[block[-1][12:]] += [whole(word, where) for word in words]
    if block:
        raise InputError(f"{path.name}: {block[-1]} is not ended. The file is cut off")
    return _found(path.name, tables, parts).raw()


def _found(source: str, tables: list[tuple[str, str, Rows]], parts: list[_Part]) -> Found:
    nodes = [row for what, _, rows in tables if what == "Nodes" for row in rows]
    numbering = Numbering([whole(words[0], where) for where, words in nodes], "node", source)
    if any(len(words) != 4 for _, words in nodes):
        raise InputError(f"{source}: a node has not a number and three coordinates. The file is damaged")
    found = Found(
        np.array([[real(w, where) for w in words[1:]] for where, words in nodes]).reshape(-1, 3), source
    )
    has_elements = any(what == "Elements" for what, _, _ in tables)
    cell_of: dict[str, dict[int, int]] = {"Elements": {}, "Conditions": {}, "Geometries": {}}
    at: dict[tuple[int, ...], int] = {}  # surface cells by their corners
    properties: dict[int, list[int]] = {}
    beams = 0
    for wanted in ("Elements", "Geometries", "Conditions"):
        for what, name, rows in tables:
            if what != wanted or not rows:
                continue
            skip = 1 if what == "Geometries" else 2  # number and properties before the nodes
            widths = {len(words) - skip for _, words in rows}
            match = _NODES.search(name)
            if len(widths) != 1 or (match and int(match[1]) not in widths):
                raise InputError(f"{source}: {what} {name} have {sorted(widths)} nodes. The file is damaged")
            numbers = np.array([[whole(word, where) for word in words] for where, words in rows])
            cells = numbering.rows(numbers[:, skip:])
            kind = _kind(name, cells.shape[1])
            surface = kind in ("triangle", "quadrilateral")
            if surface and what != "Elements" and has_elements:
                corners = 3 if kind == "triangle" else 4
                made = np.array([at.get(tuple(sorted(row)), -1) for row in cells[:, :corners].tolist()])
            else:
                made = found.add(kind, cells)
                beams += len(cells) if kind == "line" and what == "Elements" else 0
                if surface:
                    corners = 3 if kind == "triangle" else 4
                    at |= {
                        tuple(sorted(row)): k
                        for row, k in zip(cells[:, :corners].tolist(), made.tolist(), strict=True)
                    }
                    for tag in np.unique(numbers[:, 1]).tolist() if what == "Elements" else ():
                        properties.setdefault(tag, []).extend(made[numbers[:, 1] == tag].tolist())
            cell_of[what] |= dict(zip(numbers[:, 0].tolist(), made.tolist(), strict=True))
    if beams:
        found.notes.append(f"{count(beams, 'element')} of lines taken without stiffness")
    for tag, members in properties.items():
        if len(properties) > 1:
            found.put(f"properties {tag}", members)
    for part in parts:
        _groups(found, part, numbering, cell_of)
    return found


def _groups(found: Found, part: _Part, numbering: Numbering, cell_of: dict[str, dict[int, int]]) -> None:
    """The elements and conditions of a part; its nodes where it has neither."""
    numbers = [cell_of[what].get(n, -1) for what in cell_of for n in part.numbers[what]]
    if numbers:
        found.put(part.name, [cell for cell in numbers if cell >= 0])
        found.lost[part.name] = numbers.count(-1)
    elif part.numbers["Nodes"]:
        rows = numbering.find(part.numbers["Nodes"])
        found.put_nodes(part.name, rows[rows >= 0])
        found.lost_nodes[part.name] = int((rows < 0).sum())


def _kind(name: str, nodes: int) -> str:
    if nodes <= 2:
        return "point" if nodes == 1 else "line"
    if re.search("line|beam|truss|cable", name, re.IGNORECASE):
        return "line"
    if nodes in (3, 6):
        return "triangle"
    return "quadrilateral" if _SURFACE.search(name) and nodes in (4, 8, 9) else SOLID
