"""Decks of Abaqus and CalculiX (.inp): nodes, shell and plane elements, sets, parts and instances.

What else the deck says of the model (sections, materials, supports, loads, ties) is not solved with: it is told in
the notes of the mesh, so that the scene can be written accordingly. What would change the mesh and cannot be read is
an error.

Source: Abaqus Keywords Reference Guide; CalculiX CrunchiX User's Manual, "Input deck format".
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.formats.abaqus_cards import Card, cards
from kshell.mesh.formats.abaqus_notes import Notes
from kshell.mesh.formats.abaqus_scope import NamedSet, Scope, generated, is_left_out
from kshell.mesh.formats.found import Found
from kshell.mesh.formats.text import real
from kshell.mesh.raw import RawMesh

Floats = NDArray[np.float64]

MESH = ("NODE", "ELEMENT", "NSET", "ELSET", "SYSTEM")
# cards that make nodes, elements or numbers out of others
GENERATING = (
    "NGEN",
    "NFILL",
    "NCOPY",
    "NMAP",
    "ELGEN",
    "ELCOPY",
    "PARAMETER",
    "SUBSTRUCTURE GENERATE",
    "SUBMODEL",
)


class _Instance:
    """A part at its place."""

    def __init__(self, card: Card, parts: dict[str, Scope]) -> None:
        self.name = card.name("NAME")
        part = card.parameters.get("PART", "")
        if part.casefold() not in parts:
            raise InputError(
                f"{card.where}: instance '{self.name}' of part '{part}', which is not defined before. Define the part "
                "above, with *PART, NAME=..."
            )
        self.part = parts[part.casefold()]
        self.own = Scope()  # what stands between *INSTANCE and *END INSTANCE
        rows = [[real(word, where) for word in row] for where, row in card.rows]
        self.shift = np.array((rows[0] if rows else []) + 3 * [0.0])[:3]
        self.turn = np.array(rows[1][:7]) if len(rows) > 1 else None
        if self.turn is not None and (
            len(self.turn) < 7 or not np.linalg.norm(self.turn[3:6] - self.turn[:3])
        ):
            raise InputError(
                f"{card.where}: a rotation takes two different points of its axis and an angle in degrees"
            )

    def placed(self, points: Floats) -> Floats:
        """Points (n, 3) of the part where the instance is: shifted, then turned about an axis."""
        x = points + self.shift
        if self.turn is None:
            return x
        a, axis = self.turn[:3], self.turn[3:6] - self.turn[:3]
        axis = axis / np.linalg.norm(axis)
        angle = np.radians(self.turn[6])
        r = x - a
        along = (r @ axis)[:, None] * axis  # Rodrigues
        turned: Floats = a + along + np.cos(angle) * (r - along) + np.sin(angle) * np.cross(axis, r)
        return turned


class _Deck:
    """A deck read card by card."""

    def __init__(self) -> None:
        self.flat = Scope()
        self.parts: dict[str, Scope] = {}
        self.instances: dict[str, _Instance] = {}
        self.node_sets: dict[str, NamedSet] = {}  # of the assembly, members are (instance, number)
        self.element_sets: dict[str, NamedSet] = {}
        self.notes = Notes()
        self._scope = self.flat
        self._in_assembly = False

    def take(self, card: Card) -> None:
        """Read one card."""
        word = card.keyword
        if word in GENERATING:
            raise InputError(
                f"{card.where}: *{word} makes a part of the model out of other numbers, which is not read. Let the "
                "program write the nodes and elements themselves"
            )
        if word == "PART":
            self._scope = self.parts.setdefault(card.name("NAME").casefold(), Scope())
        elif word == "INSTANCE":
            instance = _Instance(card, self.parts)
            self.instances[instance.name.casefold()] = instance
            self._scope = instance.own
        elif word in ("END PART", "END INSTANCE", "END ASSEMBLY"):
            self._scope = self.flat
            self._in_assembly = self._in_assembly and word != "END ASSEMBLY"
        elif word == "ASSEMBLY":
            self._in_assembly = True
        elif word in ("NSET", "ELSET") and self._of_instances(card):
            self._assembly_set(card)
        elif word in MESH:
            self._scope.take(card)
        else:
            self.notes.take(card)

    def _of_instances(self, card: Card) -> bool:
        if not self.instances or self._scope is not self.flat:
            return False
        return (
            "INSTANCE" in card.parameters
            or any("." in word for _, row in card.rows for word in row)
            or (self._named_above(card))
        )

    def _named_above(self, card: Card) -> bool:
        """Whether a set of the assembly takes in another one of the assembly."""
        sets = self.node_sets if card.keyword == "NSET" else self.element_sets
        return any(word.casefold() in sets for _, row in card.rows for word in row)

    def _assembly_set(self, card: Card) -> None:
        """A set of an assembly, of numbers in one instance or of "instance.set" and "instance.number"."""
        of_nodes = card.keyword == "NSET"
        name = card.name(card.keyword)
        sets = self.node_sets if of_nodes else self.element_sets
        target = sets.setdefault(name.casefold(), NamedSet(name))
        default = card.parameters.get("INSTANCE", "")
        for where, row in card.rows:
            if "GENERATE" in card.parameters:
                key, scope = self._instance(default, where)
                known = scope.nodes if of_nodes else scope.elements
                target.members.update({(key, n): None for n in generated(row, where) if n in known})
                continue
            for word in filter(None, row):
                if word.casefold() in sets and not default:
                    target.members.update(sets[word.casefold()].members)
                    continue
                owner, _, inner = word.rpartition(".") if not default else (default, "", word)
                key, scope = self._instance(owner, where)
                self._put(target, key, scope, inner.strip("\"'"), of_nodes, where)

    def _put(self, target: NamedSet, key: str, scope: Scope, word: str, of_nodes: bool, where: str) -> None:
        if word.isdigit():
            known: dict[int, object] = dict(scope.nodes if of_nodes else scope.elements)
            if int(word) in known:
                target.members[key, int(word)] = None
            else:
                target.absent += 1
            return
        inner = (scope.node_sets if of_nodes else scope.element_sets).get(word.casefold())
        if inner is None:
            raise InputError(f"{where}: names a set '{word}' of instance '{key}', which is not defined")
        target.members.update({(key, n): None for n in inner.members if isinstance(n, int)})
        target.absent += inner.absent

    def _instance(self, name: str, where: str) -> tuple[str, Scope]:
        found = self.instances.get(name.strip("\"'").casefold())
        if found is None:
            raise InputError(f"{where}: names instance '{name}', which is not defined before")
        return found.name.casefold(), found.part if found.part.nodes else found.own

    def placed(self) -> list[tuple[str, Scope, _Instance | None]]:
        """Everything that has a place: the flat deck, then the instances by key."""
        found: list[tuple[str, Scope, _Instance | None]] = [("", self.flat, None)]
        for key, instance in self.instances.items():
            found.append((key, instance.part if instance.part.nodes else instance.own, instance))
        return found


def read_abaqus(path: Path) -> RawMesh:
    """Mesh and sets of a deck.

    Raises
    ------
    InputError
        If the deck cannot be read whole; the message names the line.
    """
    deck = _Deck()
    for card in cards(path):
        deck.take(card)
    placed = deck.placed()
    if deck.parts and not deck.instances:  # a part alone stands where it is
        placed += [(name, part, None) for name, part in deck.parts.items()]
    found = Found(np.empty((0, 3)), path.name)
    names = Counter(name for _, scope, _ in placed for name in {*scope.node_sets, *scope.element_sets})
    names.update({*deck.node_sets, *deck.element_sets})
    node_of: dict[str, dict[int, int]] = {}
    cell_of: dict[str, dict[int, int]] = {}
    points: list[Floats] = []
    said: list[str] = []
    for key, scope, instance in placed:
        x = np.array(list(scope.nodes.values()), dtype=float).reshape(-1, 3)
        points.append(x if instance is None else instance.placed(x))
        first = sum(map(len, points[:-1]))
        node_of[key] = {number: first + row for row, number in enumerate(scope.nodes)}
        cell_of[key] = _cells(found, scope, node_of[key], path.name)
        said += [words for words in scope.parts_left_out() if words not in said]
        prefix = instance.name if instance is not None else key
        for sets, put, number_of in (
            (scope.element_sets, _put_cells, cell_of[key]),
            (scope.node_sets, _put_nodes, node_of[key]),
        ):
            for name, inner in sets.items():
                shown = inner.name if names[name] == 1 or not prefix else f"{prefix}.{inner.name}"
                put(
                    found,
                    shown,
                    [number_of.get(n, -1) for n in inner.members if isinstance(n, int)],
                    inner.absent,
                )
    for sets, put, numbers in (
        (deck.element_sets, _put_cells, cell_of),
        (deck.node_sets, _put_nodes, node_of),
    ):
        for inner in sets.values():
            rows = [numbers[n[0]].get(n[1], -1) for n in inner.members if not isinstance(n, int)]
            put(found, inner.name, rows, inner.absent)
    found.points = np.concatenate(points)
    found.notes = said + deck.notes.words()
    return found.raw()


def _put_cells(found: Found, name: str, cells: list[int], absent: int) -> None:
    found.put(name, [cell for cell in cells if cell >= 0])
    if absent:
        found.lost[name] = found.lost.get(name, 0) + absent


def _put_nodes(found: Found, name: str, nodes: list[int], absent: int) -> None:
    found.put_nodes(name, nodes)
    if absent:
        found.lost_nodes[name] = found.lost_nodes.get(name, 0) + absent


def _cells(found: Found, scope: Scope, node_of: dict[int, int], source: str) -> dict[int, int]:
    """Take in the elements of a scope; the cell of each, -1 for those left out."""
    cell_of: dict[int, int] = {}
    by_type: dict[tuple[str, int], list[int]] = {}
    for number, (kind, nodes) in scope.elements.items():
        if is_left_out(kind):
            cell_of[number] = -1
        else:
            by_type.setdefault((kind.kind, len(nodes)), []).append(number)
    for (kind_name, _), numbers in by_type.items():
        rows = []
        for number in numbers:
            nodes = scope.elements[number][1]
            try:
                rows.append([node_of[node] for node in nodes])
            except KeyError as missing:
                raise InputError(
                    f"{source}: element {number} names node {missing.args[0]}, which the deck does not hold"
                ) from None
        cell_of |= dict(zip(numbers, found.add(kind_name, rows).tolist(), strict=True))
    return cell_of
