"""On what something was measured: machine, versions, commit. It stands on every chart and in every table."""

from __future__ import annotations

import os
import platform
import subprocess
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from kshell.solvers.kernels import which

PACKAGES = ("kshell", "numpy", "scipy", "scikit-fem", "pyamg", "cvxopt", "rslab", "pypardiso")
REPOSITORY = Path(__file__).parents[2]


def machine(packages: Sequence[str] = PACKAGES) -> dict[str, str]:
    """Processor, system, versions of the packages that are installed, and the commit."""
    out = {
        "processor": f"{processor()}, {os.cpu_count()} cores",
        "system": f"{platform.system()} {platform.machine()}",
        "Python": platform.python_version(),
        "loops": which(),
    }
    for name in packages:
        try:
            out[name] = version(name)
        except PackageNotFoundError:
            continue
    return {**out, "commit": commit()}


def processor() -> str:
    """The name of the processor, as the system tells it."""
    names = Path("/proc/cpuinfo")
    if names.exists():
        for line in names.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def commit() -> str:
    """The commit of the repository this runs from, or where there is none a word that says so."""
    if not (REPOSITORY / ".git").exists():
        return "installed, no repository"
    command = ["git", "-C", str(REPOSITORY), "describe", "--always", "--dirty", "--abbrev=10"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return done.stdout.strip()


def one_line(facts: dict[str, str]) -> str:
    """For the foot of a chart."""
    return "; ".join(
        value if key in ("processor", "system") else f"{key} {value}" for key, value in facts.items()
    )
