"""From the numbers by which a file knows nodes or elements to rows."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError

Ints = NDArray[np.int64]


class Numbering:
    """Rows of numbers, any whole ones.

    Raises
    ------
    InputError
        If a number comes twice.
    """

    def __init__(self, numbers: ArrayLike, what: str, source: str) -> None:
        given = np.asarray(numbers, dtype=np.int64).ravel()
        self._order = np.argsort(given, kind="stable")
        self._sorted = given[self._order]
        self._what, self._source = what, source
        twice = np.flatnonzero(self._sorted[1:] == self._sorted[:-1])
        if len(twice):
            raise InputError(f"{source}: {what} {self._sorted[twice[0]]} is stored twice. Number it anew")

    def find(self, numbers: ArrayLike) -> Ints:
        """Rows of these numbers, -1 where there is none; of the same shape."""
        wanted = np.asarray(numbers, dtype=np.int64)
        if not len(self._sorted):
            return np.full(wanted.shape, -1)
        place = np.minimum(np.searchsorted(self._sorted, wanted), len(self._sorted) - 1)
        return np.where(self._sorted[place] == wanted, self._order[place], -1)

    def rows(self, numbers: ArrayLike) -> Ints:
        """Rows of these numbers, which must exist.

        Raises
        ------
        InputError
            If one does not.
        """
        found = self.find(numbers)
        if (found < 0).any():
            first = np.asarray(numbers)[found < 0].ravel()[0]
            raise InputError(
                f"{self._source}: names {self._what} {first}, which the file does not hold. The file is damaged: write "
                "it again"
            )
        return found
