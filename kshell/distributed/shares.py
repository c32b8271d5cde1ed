"""Which rows of something whole each process has, and how they get them and give them back."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kshell.distributed.calls import Shared
from kshell.distributed.team import Team

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

ROWS = 13  # tag of the messages with rows


class Share(Shared):
    """Rows of something whole that each process has; several may have the same row.

    Parameters
    ----------
    team : Team
    of_all : sequence of int arrays
        The rows of each process, ascending; looked at by the first process alone.
    count : int
        How many rows there are; the same way.

    Attributes
    ----------
    mine : (n,) int array
        The rows of this process.
    """

    def __init__(self, team: Team, of_all: Sequence[Ints], count: int) -> None:
        super().__init__(team)
        self.of_all, self.count = of_all, count
        self.mine: Ints = team.deal(lambda rank: of_all[rank])

    @cached_property
    def owner(self) -> Ints:
        """(count,) the first process that has each row, 0 where none has; empty on all processes but the first."""
        if self.team.rank:
            return np.zeros(0, dtype=np.int32)
        out = np.zeros(self.count, dtype=np.int32)
        for rank in range(self.team.size - 1, -1, -1):
            out[self.of_all[rank]] = rank
        return out

    def spread(self, whole: Floats) -> Floats:
        """The rows of this process, (n, ...) of (count, ...)."""
        if not self.team.calls.led:
            return np.asarray(whole)[self.mine]
        rows: Floats = self.team.deal(lambda rank: np.asarray(whole)[self.of_all[rank]])
        return rows

    def collect(self, work: Callable[[], Floats]) -> Floats:
        """(count, ...) the sum of what the processes have of each row.

        On the first process; on all where they work alongside. The same to the last digit however long each takes.

        Parameters
        ----------
        work : function
            Gives the rows of this process.
        """
        team = self.team
        mine = team.together(work)
        if team.rank:
            team.send(mine, 0, ROWS)
            out = mine
        else:
            out = np.zeros((self.count, *np.shape(mine)[1:]))
            out[self.mine] = mine
            for rank in range(1, team.size):
                out[self.of_all[rank]] += team.receive(rank, ROWS)
        return out if team.calls.led else np.asarray(team.communicator.bcast(out))
