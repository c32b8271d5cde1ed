"""Whether this process is one of several that mpiexec or a batch system started: told by the environment.

Nothing is imported here that takes time: every command asks.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import NamedTuple

# number of processes and own number: MPICH and Intel MPI, Open MPI, MVAPICH
WORDS = (
    ("PMI_SIZE", "PMI_RANK"),
    ("OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"),
    ("MV2_COMM_WORLD_SIZE", "MV2_COMM_WORLD_RANK"),
)


class Launch(NamedTuple):
    """What the environment says.

    Attributes
    ----------
    rank : int
        Number of this process, from 0.
    size : int
        How many there are.
    """

    rank: int
    size: int


def launched(environment: Mapping[str, str] | None = None) -> Launch | None:
    """What the launcher says of this process; None where it runs alone.

    Parameters
    ----------
    environment : mapping, optional
        That of the process if absent.
    """
    known = os.environ if environment is None else environment
    for size, rank in WORDS:
        try:
            found = Launch(int(known[rank]), int(known[size]))
        except (KeyError, ValueError):
            continue
        return found if found.size > 1 else None
    return None
