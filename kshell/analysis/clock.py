"""Seconds per stage of a solve, announced as they begin, and the memory it took."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from kshell.solvers.memory import KEEPS_PEAK, peak_bytes

Stage = Callable[[str], None]


class Clock:
    """Seconds per stage of a solve.

    Parameters
    ----------
    progress : function or None
        Called with the name of each stage as it begins.
    read_seconds : float
        Time already spent on reading.

    Attributes
    ----------
    seconds : dict of str to float

    Where the system does not keep the largest memory of a process (macOS), `peak_memory_mb` is the largest of what was
    used at the end of each stage.
    """

    def __init__(self, progress: Stage | None, read_seconds: float = 0.0) -> None:
        self.seconds: dict[str, float] = {"read": read_seconds}
        self._most = 0.0
        self._progress = progress

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time a block under a name, and announce it."""
        if self._progress is not None:
            self._progress(name)
        begin = time.perf_counter()
        yield
        self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - begin
        if not KEEPS_PEAK:
            self._most = max(self._most, peak_bytes() / 2**20)

    @property
    def peak_memory_mb(self) -> float:
        """Largest memory of this process so far, in megabytes; where the system does not keep it, see `Clock`."""
        return max(self._most, peak_bytes() / 2**20) if KEEPS_PEAK else self._most
