"""The processes that work on one scene.

Processes of a team run the same program. Where one waits for others, as in every sum, an error of one would leave the
others waiting for ever: so each says first whether it has what the others wait for, and an error of one is raised by
all, the same everywhere.
"""

from __future__ import annotations

import importlib.util
import math
import pickle
from collections.abc import Callable
from functools import cache, partial
from typing import Any, NoReturn, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from kshell.distributed.calls import Calls
from kshell.distributed.launch import launched
from kshell.errors import InputError, Interrupted, SolveError

Floats = NDArray[np.float64]
T = TypeVar("T")

DEALT = 12  # tag of the messages with what the first process deals out
EXTRA = 'pip install "kshell[distributed]" (Linux, Python 3.12 or later), or install petsc4py and mpi4py otherwise'


class Team:
    """Processes that meet in sums and exchanges.

    Parameters
    ----------
    communicator : mpi4py.MPI.Intracomm

    Attributes
    ----------
    rank, size : int
    calls : Calls
        Those of the first process to the others.
    agreed : exception or None
        The last error that all had alike.
    """

    def __init__(self, communicator: Any) -> None:
        self.communicator = communicator
        self.rank, self.size = int(communicator.rank), int(communicator.size)
        self.calls = Calls(self)
        self.agreed: BaseException | None = None

    def agree(self, error: BaseException | None) -> None:
        """Raise the error of the first process that has one, on all.

        Parameters
        ----------
        error : exception or None
            What went wrong on this one.
        """
        self.sum((), lambda: np.zeros(()), error)

    def together(self, work: Callable[[], T]) -> T:
        """What a function gives on this process, once it has ended well on all of them."""
        value, error = _tried(work)
        self.agree(error)
        return cast(T, value)

    def once(self, work: Callable[[], T]) -> T:
        """What a function gives that the first process alone runs, on all: files are read so."""
        value = self.together(work if self.rank == 0 else _nothing)
        return cast(T, self.communicator.bcast(value))

    def sum(
        self, shape: tuple[int, ...], work: Callable[[], Floats], error: BaseException | None = None
    ) -> Floats:
        """Sum of the arrays of all processes; the same to the last digit on all.

        Parameters
        ----------
        shape : tuple of int
            Of the arrays.
        work : function
            Gives that of this process.
        error : exception, optional
            What went wrong on this process before; nothing is worked then.
        """
        value: Any = None
        if error is None:
            value, error = _tried(work)
        # one message: the numbers, and behind them whether this process has them
        mine = np.zeros(math.prod(shape) + 1)
        if error is None:
            mine[:-1] = np.ravel(value)
        else:
            mine[-1] = 1.0
        total = np.empty_like(mine)
        self.communicator.Allreduce(mine, total)
        if total[-1]:
            self._raise_first(error)
        return total[:-1].reshape(shape)

    def number(self, work: Callable[[], float]) -> float:
        """Sum of the numbers of all processes."""
        return float(self.sum((), lambda: np.array(work())))

    def largest(self, value: float) -> float:
        """The largest of the numbers of all processes, at least 0."""

        def mine() -> Floats:
            found = np.zeros(self.size)
            found[self.rank] = value
            return found

        return float(self.sum((self.size,), mine).max())

    def send(self, value: Any, rank: int, tag: int) -> None:
        """Send something to a process."""
        self.communicator.send(value, rank, tag)

    def receive(self, rank: int, tag: int) -> Any:
        """What a process sends to this one."""
        return self.communicator.recv(source=rank, tag=tag)

    def deal(self, work: Callable[[int], T]) -> T:
        """What a function gives on the first process for the rank of this one; one after the other."""
        error: BaseException | None = None
        if self.rank:
            return cast(T, self._dealt(self.receive(0, DEALT)))
        for rank in range(1, self.size):
            value: Any = None
            if error is None:
                value, error = _tried(partial(work, rank))
            self.send(value, rank, DEALT)
        own: Any = None
        if error is None:
            own, error = _tried(partial(work, 0))
        return cast(T, self._dealt(own, error))

    def _dealt(self, value: Any, error: BaseException | None = None) -> Any:
        self.agree(error)
        return value

    def alike(self, error: BaseException) -> BaseException:
        """An error that all processes raise by themselves, because all know the same."""
        self.agreed = error
        return error

    def _raise_first(self, error: BaseException | None) -> NoReturn:
        every = self.communicator.allgather(None if error is None else sendable(error))
        first = next(rank for rank, found in enumerate(every) if found is not None)
        raise self.alike(error if error is not None and first == self.rank else every[first])


def _tried(work: Callable[[], Any]) -> tuple[Any, BaseException | None]:
    """What a function gives, or its error."""
    try:
        return work(), None
    except (Exception, KeyboardInterrupt) as error:
        return None, error


def _nothing() -> Any:
    return None


def sendable(error: BaseException) -> BaseException:
    """The error as others can get it: without the state that it may carry."""
    if isinstance(error, SolveError | Interrupted):
        return type(error)(str(error))
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error


def require_installed() -> None:
    """Raise InputError where MPI or PETSc is missing; loads both, in the order that they need.

    The wheel dolfinx-solver-real brings both and loads its MPI first.
    """
    missing = [name for name in ("mpi4py", "petsc4py") if importlib.util.find_spec(name) is None]
    if missing:
        start = launched()
        why = "solver = petsc" if start is None else f"mpiexec started {start.size} processes, which"
        raise InputError(f"{why} needs {' and '.join(missing)}: {EXTRA}".replace("which needs", "which need"))
    try:
        if importlib.util.find_spec("dolfinx_solver") is not None:
            import dolfinx_solver  # noqa: F401
        from mpi4py import MPI  # noqa: F401
        from petsc4py import PETSc  # noqa: F401
    except (ImportError, OSError) as error:
        raise InputError(f"petsc4py and mpi4py are there but cannot be loaded ({error}): {EXTRA}") from None


@cache
def world() -> Team:
    """All processes that were started together.

    Raises
    ------
    InputError
        If MPI or PETSc is missing.
    """
    require_installed()
    from mpi4py import MPI

    return Team(MPI.COMM_WORLD)


def team_of(solver: str) -> Team | None:
    """The processes that work with a solver: all under mpiexec, or this one with "petsc"; None for kshell alone."""
    return world() if launched() is not None or solver == "petsc" else None
