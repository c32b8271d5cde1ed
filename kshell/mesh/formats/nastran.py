"""Nastran bulk data (.bdf, .nas, .fem, .dat): grid points in all systems, shell elements, properties as groups.

Elements of one property are a surface group, called by the number of the property, "2:5", or by the name that
comments of HyperMesh, Femap and Patran give it. The grid points of SPC, SPC1 and SET1 entries are groups "SPC 1" and
"SET 1". Thicknesses, layers and materials are told in the notes of the mesh, as is what is not read.

Source: MSC Nastran Quick Reference Guide, "Bulk Data Entries".
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.formats.found import SOLID, Found
from kshell.mesh.formats.nastran_cards import Entry, bulk
from kshell.mesh.formats.nastran_notes import Notes
from kshell.mesh.formats.nastran_systems import Systems
from kshell.mesh.raw import RawMesh
from kshell.mesh.words import count

Floats = NDArray[np.float64]

# kind, nodes that must be there, nodes in all, field of the offset (0: none)
FLAT = {
    "CTRIA3": ("triangle", 3, 3, 6),
    "CTRIAR": ("triangle", 3, 3, 6),
    "CTRIA6": ("triangle", 3, 6, 9),
    "CQUAD4": ("quadrilateral", 4, 4, 7),
    "CQUADR": ("quadrilateral", 4, 4, 7),
    "CQUAD8": ("quadrilateral", 4, 8, 15),
    "CQUAD": ("quadrilateral", 4, 9, 0),
    "CPLSTN3": ("triangle", 3, 3, 0),
    "CPLSTS3": ("triangle", 3, 3, 0),
    "CPLSTN4": ("quadrilateral", 4, 4, 0),
    "CPLSTS4": ("quadrilateral", 4, 4, 0),
}
BEAMS = ("CBAR", "CBEAM", "CROD", "CTUBE", "CBEND", "CBEAM3", "CONROD")
SOLIDS = ("CTETRA", "CHEXA", "CPENTA", "CPYRAM", "CHEXCZ", "CPENTCZ", "CTETRAH")
AXISYMMETRIC = ("CTRIAX", "CTRIAX6", "CTRAX3", "CTRAX6", "CQUADX", "CQUADX4", "CQUADX8", "CCONEAX", "CAXISYM")
REFUSED = ("GRIDB", "GRIDF", "CORD3G", "CORD1RX", "CORD2RX", "GMCURV", "GMSURF", "GMCORD", "AXIC", "RINGAX")


class _Deck:
    """Entries sorted by what they are."""

    def __init__(self, path: Path) -> None:
        self.source = path.name
        self.grids: dict[int, Entry] = {}
        self.places: dict[int, Floats] = {}
        self.systems = Systems(self._place)
        self.elements: dict[int, Entry] = {}
        self.node_sets: dict[str, list[int]] = {}
        self.held: dict[int, dict[str, list[int]]] = {}  # grid points by set of SPC and components
        self.default = Entry("GRDSET", [], path.name)
        self.notes = Notes()
        self._open: set[int] = set()
        found = bulk(path)
        self.names = found.names
        for entry in found.entries:
            self._take(entry)

    def _take(self, entry: Entry) -> None:
        name = entry.name
        if name in REFUSED:
            raise InputError(
                f"{entry.where}: {name} is not read. Write the model with GRID, CORD1 and CORD2 entries"
            )
        if name == "GRID":
            self._once(self.grids, entry, "grid point")
        elif name == "GRDSET":
            self.default = entry
        elif name[:5] in ("CORD1", "CORD2"):
            self.systems.take(entry)
        elif name in FLAT or name in BEAMS or name in SOLIDS or name in AXISYMMETRIC:
            self._once(self.elements, entry, "element")
        elif name == "SPC1":
            self._hold(entry.whole(0), entry.word(1), entry.numbers(2))
        elif name == "SPC":
            for first in (1, 4):
                if entry.word(first):
                    self._hold(entry.whole(0), entry.word(first + 1), [entry.whole(first)])
        elif name == "SET1" and not any(word.upper() == "SKIN" for word in entry.fields):
            self.node_sets.setdefault(f"SET {entry.whole(0)}", []).extend(entry.numbers(1))
        else:
            self.notes.take(entry)

    def _once(self, of: dict[int, Entry], entry: Entry, what: str) -> None:
        number = entry.whole(0)
        same = of.setdefault(number, entry)
        if same is not entry and (same.name != entry.name or _bare(same) != _bare(entry)):
            raise InputError(f"{entry.where}: {what} {number} is defined twice, differently. Number it anew")

    def _hold(self, number: int, components: str, nodes: list[int]) -> None:
        self.held.setdefault(number, {}).setdefault(components or "0", []).extend(nodes)

    def _place(self, number: int, where: str) -> Floats:
        if number in self.places:
            return self.places[number]
        if number not in self.grids:
            raise InputError(f"{where}: names grid point {number}, which the file does not hold")
        if number in self._open:
            raise InputError(f"{where}: grid point {number} is placed by a system that it defines")
        self._open.add(number)
        grid = self.grids[number]
        system = grid.whole(1, self.default.whole(1, 0))
        place = self.systems.to_basic(system, np.array([grid.real(k) for k in (2, 3, 4)]), grid.where)
        self._open.discard(number)
        self.places[number] = place
        return place

    def found(self) -> Found:
        """Points, cells and sets."""
        for number, grid in self.grids.items():
            self._place(number, grid.where)
        row = {number: k for k, number in enumerate(self.grids)}
        found = Found(np.array([self.places[k] for k in self.grids], dtype=float).reshape(-1, 3), self.source)
        self._cells(found, row)
        sets = {name: nodes for name, nodes in self.node_sets.items() if all(n in row for n in nodes)}
        for number, by_components in self.held.items():
            for components, nodes in by_components.items():
                name = f"SPC {number}" if len(by_components) == 1 else f"SPC {number}:{components}"
                sets[name] = nodes
                self.notes.held(name, components)
        for components in {grid.word(6) for grid in self.grids.values()} - {"", "0"}:
            sets[f"PS {components}"] = [n for n, grid in self.grids.items() if grid.word(6) == components]
            self.notes.held(f"PS {components}", components)
        for name, nodes in sets.items():
            found.put_nodes(name, [row[n] for n in nodes if n in row])
            found.lost_nodes[name] = sum(n not in row for n in set(nodes))
        turned = sum(grid.word(5) not in ("", "0", "-1") for grid in self.grids.values())
        if turned:
            self.notes.said.append(
                f"{count(turned, 'grid point')} with displacements in own systems (CD), not read"
            )
        found.notes = self.notes.words()
        return found

    def _cells(self, found: Found, row: dict[int, int]) -> None:
        by_form: dict[tuple[str, int], tuple[list[list[int]], list[int]]] = {}
        extra: list[Floats] = []
        offsets = thicknesses = 0
        for number, entry in self.elements.items():
            kind, nodes = self._nodes(entry)
            rows = []
            for node in nodes:
                if node and node not in row:
                    raise InputError(
                        f"{entry.where}: element {number} names grid point {node}, which is not there"
                    )
                rows.append(row[node] if node else -1)
            if kind == "quadrilateral" and -1 in rows:  # straight sides where mid-side nodes are left out
                for side in range(4):
                    if rows[4 + side] < 0:
                        a, b = found.points[rows[side]], found.points[rows[(side + 1) % 4]]
                        extra.append((0.5 * (a + b))[None])
                        rows[4 + side] = len(found.points) + len(extra) - 1
                rows = rows[:8]
            if entry.name in FLAT and FLAT[entry.name][3]:
                offset = FLAT[entry.name][3]
                offsets += bool(entry.word(offset)) and entry.real(offset) != 0
                own = (
                    entry.fields[10:14]
                    if kind == "quadrilateral" and offset > 10
                    else entry.fields[offset + 1 :]
                )
                thicknesses += any(own)
            of_form = by_form.setdefault((kind, len(rows)), ([], []))
            of_form[0].append(rows)
            of_form[1].append(0 if entry.name == "CONROD" else entry.whole(1, number))
        found.points = np.concatenate([found.points, *extra])
        dimension = {"line": 1, "triangle": 2, "quadrilateral": 2}
        for (kind, _), (rows_of, properties) in by_form.items():
            cells = found.add(kind, rows_of)
            for number in np.unique(properties).tolist():
                if kind in dimension and number:
                    label = self.names.get(number) or f"{dimension[kind]}:{number}"
                    found.put(label, cells[np.asarray(properties) == number])
                    found.tags[label] = number
        beams = [entry.name for entry in self.elements.values() if entry.name in BEAMS]
        for name in dict.fromkeys(beams):
            self.notes.said.append(
                f"{count(beams.count(name), 'element')} {name} taken as lines without stiffness"
            )
        if offsets:
            self.notes.said.append(f"{count(offsets, 'element')} with an offset (ZOFFS), not read")
        if thicknesses:
            self.notes.said.append(
                f"{count(thicknesses, 'element')} with own thicknesses at corners, not read"
            )

    def _nodes(self, entry: Entry) -> tuple[str, list[int]]:
        """Kind and grid points of an element, 0 for mid-side nodes that are left out."""
        if entry.name in SOLIDS:
            return SOLID, []
        if entry.name in AXISYMMETRIC:
            return "axisymmetric cells", []
        if entry.name in BEAMS:
            first = 1 if entry.name == "CONROD" else 2
            return "line", [entry.whole(first), entry.whole(first + 1)]
        kind, needed, number, _ = FLAT[entry.name]
        nodes = [entry.whole(2 + k) for k in range(needed)]
        middles = [entry.whole(2 + k, 0) for k in range(needed, number)]
        if entry.name == "CQUAD" and not middles[-1]:
            middles = middles[:4]
        return kind, nodes + middles if any(middles) else nodes


def _bare(entry: Entry) -> list[str]:
    """Fields up to the last one that is not empty."""
    fields = list(entry.fields)
    while fields and not fields[-1]:
        fields.pop()
    return fields


def read_nastran(path: Path) -> RawMesh:
    """Mesh, properties and sets of grid points of a bulk data file.

    Raises
    ------
    InputError
        If the file cannot be read whole; the message names the line.
    """
    return _Deck(path).found().raw()
