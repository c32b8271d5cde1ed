"""Measure, draw, write the table.

python -m verification.work_precision                          what is installed here
python -m verification.work_precision --peers-python PYTHON    with NGSolve of that interpreter
python -m verification.work_precision --redraw                 charts from the table that is there
"""

from __future__ import annotations

import argparse
import csv
import json
import sys
from pathlib import Path
from typing import Any

from kshell.saving import write_together
from verification.suite.machine import machine
from verification.work_precision.draw import chart, winners
from verification.work_precision.measure import one, run_all
from verification.work_precision.problems import PROBLEMS

FOLDER = Path(__file__).parents[1] / "pictures" / "work_precision"
TEXT = ("problem", "method", "version")


def read(path: Path) -> tuple[dict[str, str], list[dict[str, Any]]]:
    """Facts and rows of a table."""
    lines = path.read_text(encoding="utf-8").splitlines()
    facts = dict(line[2:].split(": ", 1) for line in lines if line.startswith("# "))
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    return facts, [{k: v if k in TEXT else float(v) for k, v in row.items()} for row in rows]


def _write_table(path: Path, facts: dict[str, str], rows: list[dict[str, Any]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as stream:
        stream.writelines(f"# {key}: {value}\n" for key, value in facts.items())
        writer = csv.DictWriter(stream, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(
            {k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows
        )


def main() -> int:
    """See the module."""
    parser = argparse.ArgumentParser(prog="python -m verification.work_precision", description=__doc__)
    parser.add_argument("--peers-python", help="an interpreter that has ngsolve")
    parser.add_argument("--most", type=float, default=1.2e5, help="largest number of unknowns")
    parser.add_argument("--out", type=Path, default=FOLDER, help="folder of table and charts")
    parser.add_argument("--redraw", action="store_true", help="measure nothing")
    parser.add_argument("--one", nargs=3, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        print(json.dumps(one(options.one[0], options.one[1], int(options.one[2]))))
        return 0
    if options.redraw:
        facts, rows = read(options.out / "work_precision.csv")
    else:
        facts, rows = machine(), []
        for row in run_all(options.peers_python, options.most):
            rows.append(row)
            print(
                f"{row['problem']:9}{row['method']:26}{row['cells']:5}{row['unknowns']:9}{row['seconds']:9.3f} s"
                + "".join(f"{row[f'{name} error']:10.1e}" for name in ("compliance", "w", "M")),
                flush=True,
            )
        others = ("kshell", "no answer")
        peers = {row["version"] for row in rows if not row["version"].startswith(others)}
        facts["peers"] = ", ".join(sorted(peers))
    for problem in PROBLEMS.values():
        for quantity, target, ours, s, peer, t in winners(rows, problem):
            print(
                f"{problem.id:9}{quantity:12} to {target:.0e}: {ours} {s:.3f} s, {peer} {t:.3f} s, ratio {t / s:.2g}"
            )
    writers: dict[str, Any] = {"work_precision.csv": lambda path: _write_table(path, facts, rows)}
    for problem in PROBLEMS.values():
        figure = chart(problem, rows, facts)
        writers[f"{problem.id}.png"] = lambda path, figure=figure: figure.savefig(path, format="png")
    write_together(options.out, writers)
    return 0


if __name__ == "__main__":
    sys.exit(main())
