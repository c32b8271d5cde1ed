"""Seconds per stage of a solve, announced as they begin, and the memory it took."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from kshell.solvers.memory import peak_bytes

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
    peak_memory_mb : float
        Largest memory of this process up to the end of the last stage, in megabytes. Where the system does not keep
        it (macOS): the largest of what was used at the end of each stage.
    """

    def __init__(self, progress: Stage | None, read_seconds: float = 0.0) -> None:
        self.seconds: dict[str, float] = {"read": read_seconds}
        self.peak_memory_mb = 0.0
        self._progress = progress

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time a block under a name, and announce it."""
        if self._progress is not None:
            self._progress(name)
        begin = time.perf_counter()
        yield
        self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - begin
        self.peak_memory_mb = max(self.peak_memory_mb, peak_bytes() / 2**20)
