"""Nodes, elements and sets of one part of an Abaqus deck, or of a deck without parts, under their own numbers."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.formats.abaqus_cards import Card
from kshell.mesh.formats.abaqus_elements import LEFT_OUT, ElementType, element_type
from kshell.mesh.formats.text import real, whole

Floats = NDArray[np.float64]


@dataclass
class NamedSet:
    """A set of nodes or elements: its name as first written, its members in order, without repetition.

    Members are numbers in a scope, or (instance, number) in an assembly.
    """

    name: str
    members: dict[int | tuple[str, int], None] = field(default_factory=dict)
    absent: int = 0


@dataclass
class Scope:
    """What a part or a flat deck holds.

    Attributes
    ----------
    nodes : dict of int to (x, y, z)
    elements : dict of int to (type, nodes)
    node_sets, element_sets : dict of str to NamedSet
        By the name in small letters.
    type_counts : dict of str to (ElementType, int)
    """

    nodes: dict[int, tuple[float, float, float]] = field(default_factory=dict)
    elements: dict[int, tuple[ElementType, tuple[int, ...]]] = field(default_factory=dict)
    node_sets: dict[str, NamedSet] = field(default_factory=dict)
    element_sets: dict[str, NamedSet] = field(default_factory=dict)
    type_counts: dict[str, tuple[ElementType, int]] = field(default_factory=dict)
    system: tuple[Floats, Floats] | None = None  # origin and axes (rows) of *SYSTEM

    def take(self, card: Card) -> None:
        """Read a *NODE, *ELEMENT, *NSET, *ELSET or *SYSTEM card."""
        {
            "NODE": self._nodes,
            "ELEMENT": self._elements,
            "NSET": self._set,
            "ELSET": self._set,
            "SYSTEM": self._system,
        }[card.keyword](card)

    def set_of(self, name: str, of_nodes: bool) -> NamedSet:
        """The set of this name, made at need."""
        sets = self.node_sets if of_nodes else self.element_sets
        return sets.setdefault(name.casefold(), NamedSet(name))

    def _nodes(self, card: Card) -> None:
        new = []
        kind = card.parameters.get("SYSTEM", "R")[:1].upper()
        if kind not in "RCS":
            raise InputError(f"{card.where}: SYSTEM={kind} is none of R, C, S")
        for where, row in card.rows:
            number = whole(row[0], where)
            x, y, z = (real(word, where) for word in [*row[1:4], "", "", ""][:3])
            if kind != "R":
                x, y, z = _round(kind, x, y, z)
            if self.system is not None:
                x, y, z = (self.system[0] + np.array([x, y, z]) @ self.system[1]).tolist()
            if self.nodes.setdefault(number, (x, y, z)) != (x, y, z):
                raise InputError(
                    f"{where}: node {number} is defined twice, at different places. Number it anew"
                )
            new.append(number)
        if card.parameters.get("NSET"):
            self.set_of(card.parameters["NSET"], True).members.update(dict.fromkeys(new))

    def _elements(self, card: Card) -> None:
        name = card.name("TYPE").upper()
        kind = element_type(name)
        if kind is None:
            raise InputError(
                f"{card.where}: elements of the type {name} are not known. Remove them, or replace them by S3, S4, S6 "
                "or S8"
            )
        new = []
        words: list[str] = []
        for where, row in card.rows:
            words += row[:-1] if row[-1] == "" else row
            if kind.nodes and len(words) <= kind.nodes:
                continue  # goes on in the next line
            numbers = [whole(word, where) for word in words]
            words = []
            if kind.kind == "line" and len(numbers) == 2 + kind.nodes:
                numbers.pop()  # a node that tells how the section is turned
            if kind.nodes and len(numbers) != 1 + kind.nodes:
                raise InputError(
                    f"{where}: an element {name} has {len(numbers) - 1} nodes instead of {kind.nodes}"
                )
            number, nodes = numbers[0], tuple(numbers[1:])
            if self.elements.setdefault(number, (kind, nodes)) != (kind, nodes):
                raise InputError(f"{where}: element {number} is defined twice, differently. Number it anew")
            new.append(number)
        if words:
            raise InputError(
                f"{card.rows[-1][0]}: the last element {name} ends before its {kind.nodes} nodes"
            )
        self.type_counts[name] = (kind, self.type_counts.get(name, (kind, 0))[1] + len(new))
        if card.parameters.get("ELSET"):
            self.set_of(card.parameters["ELSET"], False).members.update(dict.fromkeys(new))

    def _set(self, card: Card) -> None:
        of_nodes = card.keyword == "NSET"
        target = self.set_of(card.name(card.keyword), of_nodes)
        known: dict[int, object] = dict(self.nodes if of_nodes else self.elements)
        if of_nodes and card.parameters.get("ELSET"):
            for number in self._named(card.parameters["ELSET"], False, card.where).members:
                if isinstance(number, int):
                    target.members.update(dict.fromkeys(self.elements[number][1]))
        if "GENERATE" in card.parameters:
            for where, row in card.rows:
                target.members.update(dict.fromkeys(n for n in generated(row, where) if n in known))
            return
        for where, row in card.rows:
            for word in filter(None, row):
                if not _is_whole(word):
                    other = self._named(word, of_nodes, where)
                    target.members.update(other.members)
                    target.absent += other.absent
                elif int(word) in known:
                    target.members[int(word)] = None
                else:
                    target.absent += 1

    def _named(self, name: str, of_nodes: bool, where: str) -> NamedSet:
        found = (self.node_sets if of_nodes else self.element_sets).get(name.strip("\"'").casefold())
        if found is None:
            what = "nodes" if of_nodes else "elements"
            raise InputError(
                f"{where}: names a set '{name}' of {what}, which is not defined before. Define it above"
            )
        return found

    def _system(self, card: Card) -> None:
        numbers = [real(word, where) for where, row in card.rows for word in row]
        if not any(numbers):
            self.system = None
            return
        a, b, c = np.array((numbers + 9 * [0.0])[:9]).reshape(3, 3)
        if len(numbers) <= 3:
            self.system = (a, np.eye(3))
            return
        if len(numbers) <= 6:  # a turn about z
            c = a + np.cross([0.0, 0.0, 1.0], b - a)
        x = b - a
        z = np.cross(x, c - a)
        if not np.linalg.norm(z):
            raise InputError(f"{card.where}: the three points of *SYSTEM lie on a line")
        axes = np.array([x, np.cross(z, x), z])
        self.system = (a, axes / np.linalg.norm(axes, axis=1, keepdims=True))

    def parts_left_out(self) -> list[str]:
        """Words about elements that are not what they were."""
        return [
            f"{number} element{'s' if number > 1 else ''} {name} {kind.says}"
            for name, (kind, number) in self.type_counts.items()
            if kind.says and number
        ]


def generated(row: list[str], where: str) -> range:
    """Numbers of a GENERATE line: first, last, increment (1 if absent)."""
    first, last, step = (whole(word, where) if word else 0 for word in [*row, "", "", ""][:3])
    last, step = last or first, step or 1
    if step < 0 or last < first:
        raise InputError(f"{where}: GENERATE from {first} to {last} by {step} gives nothing")
    return range(first, last + 1, step)


def is_left_out(kind: ElementType) -> bool:
    """Whether elements of this type have no cells in a mesh."""
    return kind.kind == LEFT_OUT


def _is_whole(word: str) -> bool:
    return word.lstrip("+-").isdigit()


def _round(kind: str, a: float, b: float, c: float) -> tuple[float, float, float]:
    """Cartesian coordinates of radius, angle, z ("C") or radius, angle in the plane, angle above it ("S"); degrees."""
    turn = np.radians(b)
    if kind == "C":
        return float(a * np.cos(turn)), float(a * np.sin(turn)), c
    above = np.radians(c)
    return (
        float(a * np.cos(turn) * np.cos(above)),
        float(a * np.sin(turn) * np.cos(above)),
        float(a * np.sin(above)),
    )
