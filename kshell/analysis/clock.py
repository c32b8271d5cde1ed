"""Seconds per stage of a solve, announced as they begin."""

from __future__ import annotations

import resource
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

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
    """

    def __init__(self, progress: Stage | None, read_seconds: float = 0.0) -> None:
        self.seconds: dict[str, float] = {"read": read_seconds}
        self._progress = progress

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time a block under a name, and announce it."""
        if self._progress is not None:
            self._progress(name)
        begin = time.perf_counter()
        yield
        self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - begin


def peak_memory_mb() -> float:
    """Largest memory of this process so far, in megabytes."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
