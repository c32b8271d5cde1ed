"""What memory there is, and what a factorisation would take: foreseen, not suffered."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

# Entries of the factor = FILL * entries of the matrix * log2(unknowns): 0.25 ... 0.29 for both elements on
# unstructured meshes of 2e5 and 1e6 unknowns, whatever the back end.
FILL = 0.28
# Peak bytes per entry of the factor while it is made, as seen from outside, measured at 1e5 ... 1e6 unknowns
BYTES = {"superlu": 28.0, "cholmod": 18.0, "pardiso": 18.0}
SHARE = 0.8  # of the available memory that may be filled


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
    return have is None or factorisation_bytes(matrix.shape[0], matrix.nnz, backend) <= SHARE * have


def available_bytes() -> float | None:
    """Memory that can still be had, or None where the system does not say (it is asked on Linux only)."""
    candidates = [_meminfo(Path("/proc/meminfo")), _control_group(Path("/sys/fs/cgroup"))]
    known = [value for value in candidates if value is not None]
    return min(known) if known else None


def _meminfo(path: Path) -> float | None:
    if not path.is_file():
        return None
    for line in path.read_text().splitlines():
        name, _, value = line.partition(":")
        if name == "MemAvailable":
            return 1024.0 * float(value.split()[0])
    return None


def _control_group(folder: Path) -> float | None:
    """What the limit of a container leaves."""
    limit, used = folder / "memory.max", folder / "memory.current"
    if not (limit.is_file() and used.is_file()):
        return None
    text = limit.read_text().strip()
    return float(text) - float(used.read_text()) if text.isdigit() else None
