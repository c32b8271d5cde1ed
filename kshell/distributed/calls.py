"""Calls of the first process to the others, each of which does its part of the same function and waits again.

The first process runs an analysis as one process alone would; only it has the whole mesh and whole vectors. What is
divided are `Shared` objects: every process has one under the same key, with its piece in it. A method marked `on_all`
is run by all of them on their own object. What is whole stays with the first: the others are given `ELSEWHERE` in its
place, and get their rows of it by `kshell.distributed.shares`.

Where no process leads, all of them run the same program with the same whole alongside, and `on_all` does nothing more
than call the method.
"""

from __future__ import annotations

import io
import pickle
import signal
import threading
import time
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from types import BuiltinFunctionType, FunctionType
from typing import Any, TypeVar

import numpy as np

F = TypeVar("F", bound=Callable[..., Any])

CALL = 11  # tag of the messages of the first process to those that wait for it
RUN, END = "run", "end"
# seconds between two looks for a message: short at first, so that calls in a row do not wait, longer in the end, so
# that who waits leaves the processor to others
LOOK, LONGEST = 2e-5, 1e-3
# what a call takes along; everything else stays with the first process
TAKEN = (bool, int, float, complex, str, bytes, type(None), type, FunctionType, BuiltinFunctionType)


class Elsewhere:
    """Stands for what only the first process has."""

    def __repr__(self) -> str:
        return "<of the first process>"


ELSEWHERE: Any = Elsewhere()


class Shared:
    """What every process of a team has under the same key; made by all of them in the same call.

    Parameters
    ----------
    team : Team
    """

    def __init__(self, team: Any) -> None:
        self.team = team
        self.key = team.calls.registered(self)


def on_all(method: F) -> F:
    """A method of `Shared` objects that every process runs on its own one; the value is that of the first."""

    @wraps(method)
    def called(self: Shared, *given: Any) -> Any:
        return self.team.calls.run(called, self, *given)

    called.alone = method  # type: ignore[attr-defined]
    return called  # type: ignore[return-value]


class Calls:
    """The calls of a team.

    Parameters
    ----------
    team : Team

    Attributes
    ----------
    led : bool
        Whether the first process leads; otherwise all run the same alongside.
    """

    def __init__(self, team: Any) -> None:
        self.team, self.led = team, False
        self._running = False
        self._objects: dict[int, Any] = {}
        self._dropped: list[int] = []
        self._count = 0

    def registered(self, thing: Shared) -> int:
        """The key of a new object; the others keep theirs until the first one's is gone."""
        self._count += 1
        if self.led:
            if self.team.rank:
                self._objects[self._count] = thing
            else:
                weakref.finalize(thing, self._dropped.append, self._count)
                self._objects[self._count] = weakref.ref(thing)
        return self._count

    def run(self, function: Callable[..., Any], *given: Any) -> Any:
        """What a function gives, or a method marked `on_all`, that all processes run."""
        work = getattr(function, "alone", function)
        if not self.led or self._running:
            return work(*given)
        self._tell(RUN, self._packed((function, given)))
        self._running = True
        try:
            return work(*given)
        finally:
            self._running = False

    def lead(self) -> None:
        """On the first process: the others wait for calls."""
        self.led = True

    def by_first(self, work: Callable[[], Any]) -> Any:
        """What a function gives on the first process, on all that have what is whole."""
        return work() if self.led else self.team.once(work)

    def end(self, outcome: Callable[[int], Any]) -> None:
        """Let the others end.

        Parameters
        ----------
        outcome : function
            Gives what the process of a rank leaves with.
        """
        if self.led:
            for rank in range(1, self.team.size):
                self._send(rank, END, outcome(rank))
            self._leave()

    def follow(self) -> Any:
        """On the other processes: do what is called for, until it ends; what the first process gives then."""
        self.led = True
        with _uninterrupted():
            while True:
                kind, dropped, content = self._next()
                for key in dropped:
                    self._objects.pop(key, None)
                if kind != RUN:
                    self._leave()
                    return content
                function, given = _Taken(io.BytesIO(content), self.team, self._objects).load()
                self._running = True
                try:
                    getattr(function, "alone", function)(*given)
                except BaseException as error:
                    if error is not self.team.agreed:
                        raise
                    # the first process has it too, and says what follows from it
                finally:
                    self._running = False

    def _leave(self) -> None:
        self.led = False
        self._objects.clear()
        self._dropped.clear()

    def _tell(self, kind: str, content: Any) -> None:
        for rank in range(1, self.team.size):
            self._send(rank, kind, content)
        self._dropped.clear()

    def _send(self, rank: int, kind: str, content: Any) -> None:
        self.team.send((kind, tuple(self._dropped), content), rank, CALL)

    def _next(self) -> Any:
        communicator, pause = self.team.communicator, LOOK
        while not communicator.iprobe(0, CALL):
            time.sleep(pause)
            pause = min(1.2 * pause, LONGEST)
        return self.team.receive(0, CALL)

    def _packed(self, call: Any) -> bytes:
        room = io.BytesIO()
        _Packer(room, self.team).dump(call)
        return room.getvalue()


class _Packer(pickle.Pickler):
    def __init__(self, file: Any, team: Any) -> None:
        super().__init__(file)
        self.team = team

    def persistent_id(self, thing: Any) -> Any:
        if thing is self.team:
            return ("team",)
        if isinstance(thing, Shared):
            return "shared", thing.key
        taken = type(thing) is tuple or isinstance(thing, (*TAKEN, np.generic, np.dtype))
        return None if taken else ("elsewhere",)


class _Taken(pickle.Unpickler):
    def __init__(self, file: Any, team: Any, objects: dict[int, Any]) -> None:
        super().__init__(file)
        self.team, self.objects = team, objects

    def persistent_load(self, identity: Any) -> Any:
        if identity[0] == "team":
            return self.team
        return self.objects[identity[1]] if identity[0] == "shared" else ELSEWHERE


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Ctrl-C reaches all processes: the first one says what comes of it."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
