"""Runs of several processes under mpiexec, for tests."""

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent.parent
BESIDE = Path(sys.executable).parent / "mpiexec"
MPIEXEC = str(BESIDE) if BESIDE.exists() else shutil.which("mpiexec")
MISSING = [name for name in ("mpi4py", "petsc4py") if importlib.util.find_spec(name) is None]
if MPIEXEC is None:
    MISSING.append("mpiexec")

ENVIRONMENT = {
    **os.environ,
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MPLBACKEND": "Agg",
    "PYTHONPATH": str(ROOT),
}
# of an earlier launcher, by which a test that runs under one would be taken for a part of it
for word in ("PMI_SIZE", "PMI_RANK", "PMI_FD"):
    ENVIRONMENT.pop(word, None)


def command_of(ranks: int, code: str, *arguments: object) -> list[str]:
    """The command line that runs some code on several processes."""
    return [str(MPIEXEC), "-n", str(ranks), sys.executable, "-c", code, *map(str, arguments)]


def run_code(
    ranks: int, code: str, *arguments: object, timeout: float = 240.0
) -> subprocess.CompletedProcess[str]:
    """Run some code on several processes."""
    return subprocess.run(
        command_of(ranks, code, *arguments),
        env=ENVIRONMENT,
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=timeout,
        check=False,
    )
