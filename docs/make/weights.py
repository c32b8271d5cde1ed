"""What every library weighs that kshell needs: `python -m docs.make.weights`, run where kshell is installed.

Megabytes on the disk, and processor seconds of its first import, with what it imports itself, in a process of its own.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from packaging.requirements import Requirement

TIMES = 5
MODULES = {"scikit-fem": "skfem", "Jinja2": "jinja2"}
# what one process measures: its own seconds, without those of starting Python
IMPORT = "import time; a = time.process_time(); import {}; print(time.process_time() - a)"


def needed(name: str) -> Iterator[str]:
    """What a distribution requires without any extra."""
    for text in distribution(name).requires or []:
        requirement = Requirement(text)
        if requirement.marker is None or requirement.marker.evaluate({"extra": ""}):
            yield requirement.name


def size(name: str) -> float:
    """Megabytes of the files of a distribution."""
    places = {Path(str(file.locate())) for file in distribution(name).files or []}
    return sum(path.stat().st_size for path in places if path.is_file() and path.suffix != ".pyc") / 1e6


def seconds(module: str) -> float:
    """Processor seconds of an import, the median of some."""
    runs = [
        subprocess.run([sys.executable, "-c", IMPORT.format(module)], capture_output=True, text=True)
        for _ in range(TIMES)
    ]
    return statistics.median(float(run.stdout) for run in runs if run.returncode == 0)


def main() -> None:
    """Print the table, the heaviest first."""
    first = list(needed("kshell"))
    names = dict.fromkeys(first)
    todo = list(first)
    while todo:
        for name in needed(todo.pop()):
            if name not in names:
                names[name] = None
                todo.append(name)
    rows = []
    for name in names:
        try:
            weight = size(name)
        except PackageNotFoundError:
            continue
        module = MODULES.get(name, name.replace("-", "_"))
        took = f"{seconds(module):.2f}" if name in first else ""
        rows.append((weight, name, took, "" if name in first else "by others"))
    print("| library | MB | import, s | |\n|---|---|---|---|")
    for weight, name, took, why in sorted(rows, reverse=True):
        print(f"| {name} | {weight:.1f} | {took} | {why} |")
    print(f"| all {len(rows)}, with kshell | {sum(row[0] for row in rows) + size('kshell'):.0f} | | |")


if __name__ == "__main__":
    main()
