"""Measure, draw, write the tables.

python -m verification.work_precision                          with the peers that are installed
python -m verification.work_precision --peers-python PYTHON    those of that interpreter first
python -m verification.work_precision --only square strip      some problems; the others keep their rows
python -m verification.work_precision --redraw                 charts and tables from the measurements that are there
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from kshell.result.saving import write_together
from kshell.verify.machine import machine
from verification.work_precision import table
from verification.work_precision.catalogue import COMPARISONS
from verification.work_precision.draw import OURS, chart
from verification.work_precision.measure import run_all
from verification.work_precision.methods import METHODS
from verification.work_precision.problems import QUANTITIES
from verification.work_precision.tables import first, not_first


def shown(row: dict[str, Any]) -> str:
    """A measurement, or why there is none, on one line."""
    head = f"{row['problem']:17}{row['method']:26}{row['cells']:5}"
    if not row["unknowns"]:
        return f"{head}  skipped: {row['version']}"
    errors = "".join(f"{row[f'{name} error']:10.1e}" for name in QUANTITIES)
    return f"{head}{row['unknowns']:9}{row['seconds']:10.4f} s{errors}"


def main() -> int:
    """See the module."""
    parser = argparse.ArgumentParser(
        prog="python -m verification.work_precision",
        description=__doc__,
        formatter_class=argparse.RawTextHelpFormatter,
    )
    parser.add_argument("--peers-python", help="an interpreter that has peers")
    parser.add_argument("--only", nargs="+", choices=list(COMPARISONS), help="these problems")
    parser.add_argument("--out", type=Path, default=table.FOLDER, help="folder of tables and charts")
    parser.add_argument("--redraw", action="store_true", help="measure nothing")
    options = parser.parse_args()
    file = options.out / table.NAME
    facts, rows = table.read(file) if file.exists() and (options.redraw or options.only) else ({}, [])
    if not options.redraw:
        chosen = options.only or list(COMPARISONS)
        rows = [row for row in rows if row["problem"] not in chosen]
        facts = machine()
        for row in run_all([COMPARISONS[name] for name in chosen], options.peers_python):
            rows.append(table.rounded(row))
            print(shown(row), flush=True)
        rows.sort(key=lambda row: list(COMPARISONS).index(row["problem"]))
    own = {row["version"] for row in rows if row["unknowns"] and METHODS[row["method"]].program != OURS}
    facts["peers"] = ", ".join(sorted(own))
    measured = {row["problem"] for row in rows}
    comparisons = [one for name, one in COMPARISONS.items() if name in measured]
    print(first(comparisons, rows))
    writers: dict[str, Any] = {
        table.NAME: lambda path: table.write(path, facts, rows),
        "first.md": lambda path: path.write_text(first(comparisons, rows), encoding="utf-8"),
        "not_first.md": lambda path: path.write_text(not_first(comparisons, rows), encoding="utf-8"),
    }
    for one in comparisons:
        figure = chart(one, rows, facts)
        writers[f"{one.id}.png"] = lambda path, figure=figure: figure.savefig(path, format="png")
    write_together(options.out, writers)
    return 0


if __name__ == "__main__":
    sys.exit(main())
