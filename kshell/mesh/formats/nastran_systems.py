"""Coordinate systems of Nastran: rectangular, cylindrical and spherical, defined in each other or by grid points.

A system has its origin A, its z axis towards B, and C in its plane of x and z. Coordinates are (x, y, z),
(radius, angle, z) or (radius, angle from z, angle about z), angles in degrees.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.formats.nastran_cards import Entry

Floats = NDArray[np.float64]


class Systems:
    """The systems of a file, resolved at need.

    Parameters
    ----------
    place_of : function from a grid point and words for messages to its (3,) place
        For systems defined by grid points.
    """

    def __init__(self, place_of: Callable[[int, str], Floats]) -> None:
        self._place_of = place_of
        self._entries: dict[int, tuple[Entry, int]] = {}
        self._resolved: dict[int, tuple[str, Floats, Floats]] = {}
        self._open: set[int] = set()

    def take(self, entry: Entry) -> None:
        """Read a CORD1 or CORD2 entry."""
        for first in (0, 4) if entry.name.startswith("CORD1") else (0,):
            if not entry.word(first):
                continue
            number = entry.whole(first)
            if number < 1 or number in self._entries:
                raise InputError(
                    f"{entry.where}: coordinate system {number} is defined twice, or is not positive"
                )
            self._entries[number] = (entry, first)

    def to_basic(self, number: int, coordinates: Floats, where: str) -> Floats:
        """The place (3,) with these coordinates in system `number`.

        Raises
        ------
        InputError
            If the system does not exist, or is defined by itself.
        """
        if number == 0:
            return coordinates
        kind, origin, axes = self._system(number, where)
        a, b, c = coordinates
        if kind == "C":
            turn = np.radians(b)
            local = np.array([a * np.cos(turn), a * np.sin(turn), c])
        elif kind == "S":
            down, turn = np.radians(b), np.radians(c)
            local = a * np.array([np.sin(down) * np.cos(turn), np.sin(down) * np.sin(turn), np.cos(down)])
        else:
            local = coordinates
        return np.asarray(origin + local @ axes)

    def _system(self, number: int, where: str) -> tuple[str, Floats, Floats]:
        """Kind, origin and axes (rows)."""
        if number in self._resolved:
            return self._resolved[number]
        if number not in self._entries:
            raise InputError(f"{where}: names coordinate system {number}, which the file does not hold")
        if number in self._open:
            raise InputError(f"{where}: coordinate system {number} is defined by itself")
        self._open.add(number)
        entry, first = self._entries[number]
        if entry.name.startswith("CORD1"):
            a, b, c = (self._place_of(entry.whole(first + k), entry.where) for k in (1, 2, 3))
        else:
            given = np.array([entry.real(k) for k in range(2, 11)]).reshape(3, 3)
            a, b, c = (self.to_basic(entry.whole(1, 0), x, entry.where) for x in given)
        z, x = b - a, c - a
        y = np.cross(z, x)
        if not np.linalg.norm(y) > 1e-12 * np.linalg.norm(z) * np.linalg.norm(x):
            raise InputError(f"{entry.where}: the three points of coordinate system {number} lie on a line")
        axes = np.array([np.cross(y, z), y, z])
        self._open.discard(number)
        self._resolved[number] = (entry.name[5:6], a, axes / np.linalg.norm(axes, axis=1, keepdims=True))
        return self._resolved[number]
