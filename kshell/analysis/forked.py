"""Calls of a function in processes that are forked from this one, and so find everything imported and made."""

from __future__ import annotations

import ctypes
import multiprocessing
import os
import re
import signal
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, TypeVar, cast

T = TypeVar("T")

TASKS = Path("/proc/self/task")  # the threads of this process
# the libraries of linear algebra that have threads of their own, and what sets how many
BLAS = re.compile(r"\S*/lib\w*(?:openblas|mkl_rt)\S*\.so\S*")
SETTERS = [f"{prefix}openblas_set_num_threads{suffix}" for prefix in ("", "scipy_") for suffix in ("", "64_")]
SETTERS.append("MKL_Set_Num_Threads")


def can_fork() -> bool:
    """Whether a forked process would find nothing of other threads half done.

    None of Python run, no MPI does, and none of a library is left after a fork: BLAS ends its own before it and starts
    them anew, other pools would be waited for in vain.
    """
    if not sys.platform.startswith("linux") or threading.active_count() > 1 or "mpi4py.MPI" in sys.modules:
        return False
    if multiprocessing.current_process().daemon:  # which may have no processes
        return False
    child = os.fork()
    if child == 0:
        os._exit(0)
    os.waitpid(child, 0)
    return len(list(TASKS.iterdir())) == 1


class Forked:
    """Processes that call a function of a number: one thread each, and the interrupt key is left to this one.

    A context, in which they live. What the function gives and raises goes through pickle.

    Parameters
    ----------
    call : function
    processes : int
    """

    def __init__(self, call: Callable[[int], T], processes: int) -> None:
        self._call, self._processes = call, processes
        self._team: dict[Connection, Any] = {}

    def __enter__(self) -> Forked:
        for _ in range(self._processes):
            self._begin()
        return self

    def __exit__(self, *_: object) -> None:
        for pipe, process in self._team.items():
            pipe.close()
            process.kill()
            process.join()
        self._team.clear()

    def _begin(self) -> None:
        context = multiprocessing.get_context("fork")
        ours, theirs = context.Pipe()
        ends = [ours, *self._team]
        process = context.Process(target=_serve, args=(self._call, theirs, ends), daemon=True)
        process.start()
        theirs.close()
        self._team[ours] = process

    def answers(self, count: int, lost: Callable[[str], Any]) -> Iterator[Any]:
        """call(0), call(1), ... call(count - 1), in this order.

        Parameters
        ----------
        lost : function
            What stands for a call whose process died, from words that say how; another process takes its place.
        """
        left, work = deque(range(count)), dict[Connection, int]()
        done: dict[int, Any] = {}
        for following in range(count):
            while following not in done:
                for pipe in self._team:
                    if left and pipe not in work:
                        work[pipe] = left.popleft()
                        with suppress(OSError):  # it died: that is what it answers below
                            pipe.send(work[pipe])
                for pipe in cast("list[Connection]", wait(list(work))):
                    number = work.pop(pipe)
                    try:
                        done[number], error = pipe.recv()
                    except (EOFError, OSError):
                        done[number], error = lost(_death(self._buried(pipe))), None
                        self._begin()
                    if error is not None:
                        raise error
            yield done.pop(following)

    def _buried(self, pipe: Connection) -> int | None:
        """The exit code of a process that ended."""
        process = self._team.pop(pipe)
        pipe.close()
        process.join()
        code: int | None = process.exitcode
        return code


def _serve(call: Callable[[int], Any], pipe: Connection, others: list[Connection]) -> None:
    """Answer until the other end closes, which it does also where its process dies."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for other in others:
        other.close()
    _one_thread()
    with suppress(EOFError, BrokenPipeError, ConnectionResetError):
        while True:
            number = pipe.recv()
            try:
                answer: tuple[Any, BaseException | None] = call(number), None
            except Exception as error:
                answer = None, error
            pipe.send(answer)


def _one_thread() -> None:
    os.environ["OMP_NUM_THREADS"] = "1"
    for path in set(BLAS.findall(Path("/proc/self/maps").read_text(encoding="utf-8", errors="replace"))):
        with suppress(OSError):
            library = ctypes.CDLL(path)
            for name in SETTERS:
                if hasattr(library, name):
                    getattr(library, name)(1)


def _death(code: int | None) -> str:
    if code is not None and code < 0:
        name = signal.Signals(-code).name
        often = ", as the system does when memory runs out" if -code == signal.SIGKILL else ""
        return f"its process was ended by {name}{often}"
    return f"its process ended with the code {code}"
