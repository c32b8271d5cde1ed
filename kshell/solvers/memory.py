"""What memory there is, and what a factorisation would take: foreseen, not suffered."""

from __future__ import annotations

import ctypes
import math
import os
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

# Entries of the factor = FILL * entries of the matrix * log2(unknowns): 0.25 ... 0.29 for both elements on
# unstructured meshes of 2e5 and 1e6 unknowns, whatever the back end.
FILL = 0.28
# Peak bytes per entry of the factor while it is made, as seen from outside, measured at 1e5 ... 1e6 unknowns
BYTES = {"superlu": 28.0, "cholmod": 18.0, "rslab": 20.0, "pardiso": 18.0}
SHARE = 0.8  # of the available memory that may be filled
KEEPS_PEAK = (
    os.name == "nt" or Path("/proc/self/status").exists()
)  # the system keeps the largest memory of a process


def factorisation_bytes(unknowns: int, entries: int, backend: str) -> float:
    """Forecast of the peak memory of a factorisation, beyond the matrix itself.

    Parameters
    ----------
    unknowns, entries : int
        Of the matrix.
    backend : str
        Key of the back end.
    """
    return BYTES[backend] * FILL * entries * float(np.log2(max(unknowns, 2)))


def fits(matrix: Any, backend: str, available: float | None = None) -> bool:
    """Whether a factorisation can be expected to fit. Where the memory is unknown, it is tried."""
    have = available_bytes() if available is None else available
    return factorisation_bytes(matrix.shape[0], matrix.nnz, backend) <= SHARE * have


def give_back() -> None:
    """Give what was freed back to the system; the heap of Linux (glibc) keeps what lies between blocks in use."""
    try:
        ctypes.CDLL(None).malloc_trim(0)
    except (AttributeError, OSError, TypeError):  # another library of C
        return


def available_bytes() -> float:
    """Memory that can still be had: what the machine has left, and in a container what its limit leaves."""
    return min(_left_by_others(), _control_group(Path("/sys/fs/cgroup")))


def _left_by_others() -> float:
    """What the machine has left."""
    left = _from_table("/proc/meminfo", b"MemAvailable")
    if left is not None:
        return left
    import psutil

    return float(psutil.virtual_memory().available)


def _from_table(path: str, key: bytes) -> float | None:
    """Bytes of a line "key:   12345 kB" of Linux; None elsewhere. It is read at every stage of a solve, so quickly."""
    try:
        table = os.open(path, os.O_RDONLY)
    except OSError:
        return None
    try:
        text = os.read(table, 65536)
    finally:
        os.close(table)
    _, _, line = text.partition(b"\n" + key + b":")
    return 1024.0 * float(line.split(None, 1)[0]) if line else None


def _control_group(folder: Path) -> float:
    """What the limit of a container leaves: infinitely much where there is none."""
    limit, used = folder / "memory.max", folder / "memory.current"
    if not (limit.is_file() and used.is_file()):
        return math.inf
    text = limit.read_text(encoding="utf-8").strip()
    return float(text) - float(used.read_text(encoding="utf-8")) if text.isdigit() else math.inf


def _counted() -> float:
    """Largest memory by getrusage, which is asked much sooner than a table; Linux counts in kilobytes."""
    import resource

    return 1024.0 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


@cache
def _counts_itself() -> bool:
    """Whether getrusage tells of this process alone: after execve it keeps what a larger process before it had."""
    most = _from_table("/proc/self/status", b"VmHWM")
    try:
        return most is not None and _counted() <= most
    except ImportError:  # resource is a module of POSIX
        return False


def peak_bytes() -> float:
    """Largest memory of this process so far; where the system does not keep it (macOS) what is used now."""
    if _counts_itself():
        return _counted()
    most = _from_table("/proc/self/status", b"VmHWM")  # the high water mark of Linux
    if most is not None:
        return most
    import psutil

    used = psutil.Process().memory_info()
    if hasattr(used, "peak_wset"):  # Windows
        return float(used.peak_wset)
    return float(used.rss)
