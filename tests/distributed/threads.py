"""Several processes played by threads, and what each of them holds."""

import pickle
import threading
import weakref
from collections.abc import Callable
from queue import SimpleQueue
from typing import Any

import numpy as np

from kshell.distributed.team import Team

HANGS = 120.0  # seconds after which what has not come never does, however busy the machine is


class Threads:
    """What a team needs of a communicator, among threads."""

    def __init__(self, rank: int, slots: list[Any], barrier: threading.Barrier, mail: dict[Any, Any]) -> None:
        self.rank, self.size, self.slots, self.barrier = rank, len(slots), slots, barrier
        self.mail = mail

    def _box(self, source: int, dest: int, tag: int) -> SimpleQueue[Any]:
        box: SimpleQueue[Any] = self.mail.setdefault((source, dest, tag), SimpleQueue())
        return box

    def send(self, value: Any, dest: int, tag: int) -> None:
        self._box(self.rank, dest, tag).put(pickle.dumps(value))

    def iprobe(self, source: int, tag: int) -> bool:
        return not self._box(source, self.rank, tag).empty()

    def recv(self, source: int, tag: int) -> Any:
        return pickle.loads(self._box(source, self.rank, tag).get(timeout=HANGS))

    def allgather(self, value: Any) -> list[Any]:
        self.slots[self.rank] = value
        self.barrier.wait()
        found = list(self.slots)
        self.barrier.wait()
        return found

    def alltoall(self, values: list[Any]) -> list[Any]:
        return [row[self.rank] for row in self.allgather(values)]

    def bcast(self, value: Any) -> Any:
        return self.allgather(value)[0]

    def Allreduce(self, mine: np.ndarray, out: np.ndarray) -> None:
        out[...] = np.sum(self.allgather(mine), axis=0)


def played(size: int, work: Callable[[Team], Any]) -> list[Any]:
    """What each of several threads gives, or its error."""
    slots, barrier, found = [None] * size, threading.Barrier(size, timeout=HANGS), [None] * size
    mail: dict[Any, Any] = {}

    def one(rank: int) -> None:
        try:
            found[rank] = work(Team(Threads(rank, slots, barrier, mail)))
        except BaseException as error:
            found[rank] = error

    threads = [threading.Thread(target=one, args=(rank,), daemon=True) for rank in range(size)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(2 * HANGS)
    return found


def led(size: int, work: Callable[[Team], Any]) -> Any:
    """What the first of several threads gives while the others do what it calls for."""

    def one(team: Team) -> Any:
        if team.rank:
            return team.calls.follow()
        team.calls.lead()
        try:
            return work(team)
        finally:
            team.calls.end(lambda rank: rank)

    first, *others = played(size, one)
    assert others == list(range(1, size))
    return first


def arrays_in(thing: Any, seen: set[int]) -> list[np.ndarray]:
    """All arrays that an object holds, but for those of its team."""
    if id(thing) in seen or isinstance(thing, Team | type | str):
        return []
    seen.add(id(thing))
    if isinstance(thing, np.ndarray):
        return [thing]
    if isinstance(thing, list | tuple | dict):
        inside = list(thing.values()) if isinstance(thing, dict) else list(thing)
    else:
        inside = list(getattr(thing, "__dict__", {}).values())
    return [array for part in inside for array in arrays_in(part, seen)]


def held(team: Team) -> float:
    """Bytes of the arrays in what each process shares, of the one after the first that has most; of one its own."""
    of = team.calls._objects.values()
    seen: set[int] = set()
    arrays = arrays_in([thing() if isinstance(thing, weakref.ref) else thing for thing in of], seen)
    mine = float(sum({id(array): array.nbytes for array in arrays}.values()))
    return team.largest(mine if team.rank or team.size == 1 else 0.0)
