"""What each process has of a model: the triangles of its own, in numbers of their own.

The first process has the whole. It finds what belongs to the triangles of each process, as supports and what depends on
neighbours, and deals it out; vertices, edges and unknowns ascend as in the whole, so that edges run the same way.
`kshell.distributed.surface_piece` has what is dealt out of shells, `kshell.distributed.plate_piece` that of plates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol, TypeVar

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.distributed.calls import Shared
from kshell.distributed.matrix import Terms
from kshell.distributed.partition import partition, share_of_first
from kshell.distributed.shares import Share
from kshell.distributed.team import Team
from kshell.mesh.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
T = TypeVar("T")


class Places(Protocol):
    """The numbers in the whole of what some triangles have, each ascending."""

    @property
    def triangles(self) -> Ints:
        """Their own."""

    @property
    def unknowns(self) -> Ints:
        """Of the unknowns at them."""


class Piece(Shared):
    """Some triangles of each process.

    Parameters
    ----------
    team : Team
    places : sequence of Places
        Of each process; of the first one alone.
    count : int
        How many unknowns the whole has; the same way.

    Attributes
    ----------
    unknowns : Share
    """

    def __init__(self, team: Team, places: Sequence[Any], count: int) -> None:
        super().__init__(team)
        self.places = places
        self.unknowns = self.share(lambda some: some.unknowns, count)

    def share(self, of: Callable[[Any], Ints], count: int) -> Share:
        """Rows of something whole, by places; the count is that of the first process."""
        return Share(self.team, [of(some) for some in self.places], count)

    def dealt(self, data: Callable[[Any], T]) -> T:
        """What the first process makes of the places of this one."""
        return self.team.deal(lambda rank: data(self.places[rank]))

    def terms(self, work: Callable[[], sp.csr_matrix]) -> Terms:
        """What a function gives on each process, its matrix on its unknowns."""
        return Terms(self.team, self.unknowns, self.team.together(work))


def members_of(team: Team, mesh: Mesh) -> list[Ints]:
    """The triangles of each process, ascending."""
    part = partition(mesh, team.size, share_of_first(team.size))
    return [np.flatnonzero(part == rank) for rank in range(team.size)]
