"""Universal files of I-DEAS (.unv), as Salome and gmsh write them: nodes, elements and groups.

Source: SDRC I-DEAS, "Universal Dataset Number" 2411 (nodes), 2412 (elements), 2435, 2452, 2467, 2477 (groups).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from kshell.errors import InputError
from kshell.mesh.formats.found import SOLID, Found
from kshell.mesh.formats.numbering import Numbering
from kshell.mesh.formats.text import real, text_of, whole
from kshell.mesh.raw import RawMesh
from kshell.mesh.words import count

# descriptor of an element: kind; plane stress and strain, plates, membranes, thin shells
TRIANGLES, QUADRILATERALS = (41, 42, 51, 52, 61, 62, 71, 72, 91, 92), (44, 45, 54, 55, 64, 65, 74, 75, 94, 95)
BEAMS = (11, 21, 22, 23, 24)
WITH_SECTION = (21, 22, 23, 24)  # a line about their section stands before the nodes
SOLIDS, AXISYMMETRIC = range(101, 120), range(81, 86)
LEFT_OUT = (121, 122, 136, 137, 138, 139, 141, 142, 151, 152, 161)  # rigid links, springs, masses
# nodes go round: corner, mid-side node, corner; here corners come first
ROUND = {6: [0, 2, 4, 1, 3, 5], 8: [0, 2, 4, 6, 1, 3, 5, 7], 3: [0, 2, 1]}
PER_ENTITY = {2435: 4, 2452: 4, 2467: 4, 2477: 4, 2417: 2, 2429: 2, 2430: 2, 2432: 2}


class _Lines:
    """Lines of one dataset, front to back."""

    def __init__(self, lines: list[tuple[int, str]], source: str) -> None:
        self._lines, self._source, self._at = lines, source, 0

    def more(self) -> bool:
        return self._at < len(self._lines)

    @property
    def where(self) -> str:
        number = self._lines[min(self._at, len(self._lines) - 1)][0] if self._lines else 0
        return f"{self._source}, line {number}"

    def text(self) -> str:
        if not self.more():
            raise InputError(f"{self.where}: the dataset ends too early. The file is cut off")
        self._at += 1
        return self._lines[self._at - 1][1]

    def integers(self) -> list[int]:
        where = self.where
        return [whole(word, where) for word in self.text().split()]


def read_unv(path: Path) -> RawMesh:
    """Mesh and groups of a universal file.

    Raises
    ------
    InputError
        If it is cut off, or holds elements that are not read.
    """
    datasets = _datasets(path)
    points: dict[int, list[float]] = {}
    elements: dict[int, tuple[int, list[int]]] = {}
    groups: list[tuple[str, list[int], list[int]]] = []
    for number, lines in datasets:
        if number == 2411:
            _nodes(lines, points)
        elif number == 2412:
            _elements(lines, elements)
        elif number in PER_ENTITY:
            _groups(lines, PER_ENTITY[number], groups)
    found = Found(np.array(list(points.values()), dtype=float).reshape(-1, 3), path.name)
    numbering = Numbering(list(points), "node", path.name)
    cell_of: dict[int, int] = {}
    by_kind: dict[tuple[str, int], list[int]] = {}
    for number, (descriptor, nodes) in elements.items():
        by_kind.setdefault((_kind(descriptor, path.name), len(nodes)), []).append(number)
    for (kind, width), numbers in by_kind.items():
        if kind == "left out":
            found.notes.append(
                f"{count(len(numbers), 'spring, mass or rigid link', 'springs, masses or rigid links')} left out"
            )
            cell_of |= dict.fromkeys(numbers, -1)
            continue
        rows = numbering.rows([elements[number][1] for number in numbers])
        if (
            kind in ("triangle", "quadrilateral", "line")
            and width in ROUND
            and (kind, width) != ("triangle", 3)
        ):
            rows = rows[:, ROUND[width]]
        cell_of |= dict(zip(numbers, found.add(kind, rows).tolist(), strict=True))
    for name, of_nodes, of_elements in groups:
        if of_elements:
            cells = [cell_of.get(number, -2) for number in of_elements]
            found.put(name, [cell for cell in cells if cell >= 0])
            found.lost[name] = found.lost.get(name, 0) + cells.count(-2)
        if of_nodes:
            there = numbering.find(of_nodes)
            found.put_nodes(name, there[there >= 0])
            found.lost_nodes[name] = int((there < 0).sum())
    return found.raw()


def _datasets(path: Path) -> list[tuple[int, _Lines]]:
    """Datasets between two lines "-1", by number."""
    inside: list[tuple[int, str]] | None = None
    found = []
    for number, line in enumerate(text_of(path).splitlines(), 1):
        if line.strip() == "-1":
            if inside is None:
                inside = []
                continue
            if inside and inside[0][1].split()[0].rstrip("bB").isdigit():
                found.append((int(inside[0][1].split()[0].rstrip("bB")), _Lines(inside[1:], path.name)))
            inside = None
        elif inside is not None and (line.strip() or len(inside) > 1):
            inside.append((number, line))
    if inside is not None:
        raise InputError(f"{path.name}: the last dataset is not ended by -1. The file is cut off")
    return found


def _nodes(lines: _Lines, points: dict[int, list[float]]) -> None:
    while lines.more():
        where = lines.where
        number, *systems = lines.integers()
        if systems and systems[0] not in (0, 1):
            raise InputError(
                f"{where}: node {number} is given in coordinate system {systems[0]}, which is not read"
            )
        x = [real(word, where) for word in lines.text().split()]
        if len(x) != 3 or points.setdefault(number, x) != x:
            raise InputError(f"{where}: node {number} has {len(x)} coordinates, or is stored twice")


def _elements(lines: _Lines, elements: dict[int, tuple[int, list[int]]]) -> None:
    while lines.more():
        where = lines.where
        head = lines.integers()
        if len(head) != 6:
            raise InputError(f"{where}: an element begins with {len(head)} numbers instead of 6")
        if head[1] in WITH_SECTION:
            lines.text()
        nodes: list[int] = []
        while len(nodes) < head[5]:
            nodes += lines.integers()
        if len(nodes) != head[5] or elements.setdefault(head[0], (head[1], nodes)) != (head[1], nodes):
            raise InputError(
                f"{where}: element {head[0]} has {len(nodes)} nodes instead of {head[5]}, or is stored twice"
            )


def _groups(lines: _Lines, width: int, groups: list[tuple[str, list[int], list[int]]]) -> None:
    """Groups: number, six numbers, how many entities; the name; type and number of each (7: node, 8: element)."""
    while lines.more():
        head = lines.integers()
        name = lines.text().strip() or f"group {head[0]}"
        words: list[int] = []
        while len(words) < width * head[-1]:
            words += lines.integers()
        entities = [words[k : k + 2] for k in range(0, width * head[-1], width)]
        groups.append(
            (name, [n for kind, n in entities if kind == 7], [n for kind, n in entities if kind == 8])
        )


def _kind(descriptor: int, source: str) -> str:
    for kind, descriptors in (
        ("triangle", TRIANGLES),
        ("quadrilateral", QUADRILATERALS),
        ("line", BEAMS),
        (SOLID, SOLIDS),
        ("axisymmetric cells", AXISYMMETRIC),
        ("left out", LEFT_OUT),
    ):
        if descriptor in descriptors:
            return kind
    raise InputError(f"{source}: elements of the descriptor {descriptor} are not known. Remove them")
