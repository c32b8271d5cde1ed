"""Which cross-section each triangle has, where some of what makes it is given by surface group.

A key is given once for all, or as a dict of surface group to value; ELSE in it stands for all other triangles. A
triangle has layers, a section given by its stiffness, or thickness and material: what its group names goes before
what is given for all.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.material.given import Section as GivenSection
from kshell.material.laminate import laminate
from kshell.material.part import Given, Homogeneous, Layered, Part
from kshell.mesh.mesh import Mesh
from kshell.mesh.select import select
from kshell.mesh.words import place
from kshell.values.naming import listing

Ints = NDArray[np.integer]

ELSE = "*"  # in a dict by group: triangles of no group in it
NOTHING = -1


class Key:
    """A key and who has which of its values.

    Attributes
    ----------
    values : list of (name of the group or "", value)
    everywhere : int or None
        Place in `values` of what is given once for all, NOTHING if it is not given; None of values by group.
    number : (triangle,)
        Place in `values`, NOTHING where there is none.
    """

    def __init__(self, name: str, given: Any, mesh: Mesh) -> None:
        self.name = name
        self._count = len(mesh.triangles)
        self.everywhere: int | None = NOTHING if given is None else 0
        self.values: list[tuple[str, Any]] = [] if given is None else [("", given)]
        if isinstance(given, Mapping):
            self.everywhere, self.values = None, []
            self._by_group(given, mesh)

    @cached_property
    def number(self) -> Ints:
        return np.full(self._count, NOTHING if self.everywhere is None else self.everywhere, dtype=np.int32)

    def _by_group(self, given: Mapping[str, Any], mesh: Mesh) -> None:
        for group, value in given.items():
            if group == ELSE:
                continue
            members = select(mesh, group, dimensions=(2,), what=self.name).members
            taken = members[self.number[members] != NOTHING]
            if len(taken):
                other = self.values[self.number[taken[0]]][0]
                raise InputError(
                    f'{self.name}: the groups "{other}" and "{group}" overlap ({len(taken)} triangles, one at '
                    f"{place(mesh.points[mesh.triangles[taken[0]]].mean(axis=0))}): each place needs one {self.name}"
                )
            self.number[members] = len(self.values)
            self.values.append((group, value))
        if ELSE in given:
            self.number[self.number == NOTHING] = len(self.values)
            self.values.append(("", given[ELSE]))

    def of(self, number: int) -> tuple[bool, Any]:
        """Whether a value was given for a group by name, and the value; (False, None) where there is none."""
        if number == NOTHING:
            return False, None
        group, value = self.values[number]
        return bool(group), value


def parts_of(mesh: Mesh, thickness: Any, material: Any, layers: Any, section: Any) -> tuple[list[Part], Ints]:
    """All cross-sections, and which of them each triangle has.

    Raises
    ------
    InputError
        If groups do not exist or overlap, or a triangle has none, or more than one.
    """
    keys = [
        Key(name, given, mesh)
        for name, given in (
            ("thickness", thickness),
            ("material", material),
            ("layers", layers),
            ("section", section),
        )
    ]
    for_all = tuple(key.everywhere for key in keys if key.everywhere is not None)
    if len(for_all) == len(keys):
        one = np.zeros(len(mesh.triangles), dtype=np.int32)
        return [_part(keys, for_all, mesh, one)], one
    rows = np.stack([key.number for key in keys], axis=1)
    combinations, number = np.unique(rows, axis=0, return_inverse=True)
    number = number.reshape(-1).astype(np.int32)
    parts = [
        _part(keys, tuple(row.tolist()), mesh, np.flatnonzero(number == k))
        for k, row in enumerate(combinations)
    ]
    return parts, number


def _part(keys: Sequence[Key], numbers: tuple[int, ...], mesh: Mesh, triangles: Ints) -> Part:
    """The cross-section of triangles that have these values."""
    named, values = zip(*(key.of(number) for key, number in zip(keys, numbers, strict=True)), strict=True)
    thickness, material, layers, section = values
    plain = thickness is not None or material is not None
    given = {"layers": layers is not None, "section": section is not None, "thickness": plain}
    by_name = {"layers": named[2], "section": named[3], "thickness": named[0] or named[1]}
    chosen = [kind for kind, there in given.items() if there]
    if len(chosen) > 1:
        chosen = [kind for kind in chosen if by_name[kind]] or chosen
    if len(chosen) > 1:
        raise InputError(
            f"{len(triangles)} triangles (one at {_at(mesh, triangles)}) have both {chosen[0]} and {chosen[1]}: "
            "leave one of them out there"
        )
    if chosen == ["layers"]:
        return Layered(_called("layers", keys[2], numbers[2]), laminate(layers))
    if chosen == ["section"]:
        assert isinstance(section, GivenSection)
        return Given(_called("section", keys[3], numbers[3]), section)
    for key, value in zip(keys[:2], (thickness, material), strict=True):
        if value is None:
            names = [group for group, _ in key.values]
            of = f"belong to none of the groups {listing(names)}" if names else f"have no {key.name}"
            raise InputError(
                f"{key.name}: {len(triangles)} triangles {of} (one at {_at(mesh, triangles)}): give the {key.name} of "
                "the rest; the surface groups are "
                f"{listing(name for name, group in mesh.groups.items() if group.dimension == 2)}"
            )
    return Homogeneous(_called("thickness", keys[0], numbers[0]), thickness, material)


def _called(what: str, key: Key, number: int) -> str:
    group = key.values[number][0]
    return f'{what} of "{group}"' if group else what


def _at(mesh: Mesh, triangles: Ints) -> str:
    return place(mesh.points[mesh.triangles[triangles[0]]].mean(axis=0))


def per_triangle(mesh: Mesh, name: str, given: Any, absent: Any) -> NDArray[np.float64]:
    """(triangle, ...) values of a key of numbers or vectors, `absent` where it has none."""
    if given is None:
        return np.full((len(mesh.triangles), *np.shape(absent)), absent, dtype=float)
    key = Key(name, given, mesh)
    values = np.array([value for _, value in key.values] + [absent], dtype=float)
    return values[key.number]
