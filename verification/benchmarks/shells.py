"""Linear shells against CPU time: Scordelis-Lo, pinched cylinder, hemisphere with a hole; kshell beside its peers.

    python -m verification.benchmarks.shells [--peers-python PYTHON] [--out FOLDER] [--redraw]

Every program in a process of its own, on one thread; peers that are not installed are named and left out. Timed is
processor time from the arrays of the mesh to the solution, without imports and a first small solve, best of up to
three.
"bare" is kshell without energies and the check of equilibrium: what the other programs do.
Grids are the same for all, graded towards the forces. Prints CPU seconds to relative errors of 1e-3 and 1e-5, writes
shells.csv and shells.md, and draws shells.png.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from kshell.result.saving import write_together
from kshell.verify.machine import machine, one_line
from verification.work_precision import table
from verification.work_precision.__main__ import shown
from verification.work_precision.catalogue import COMPARISONS
from verification.work_precision.draw import OURS, style
from verification.work_precision.measure import run_all
from verification.work_precision.methods import METHODS
from verification.work_precision.problems import Comparison
from verification.work_precision.tables import reaching

HERE = Path(__file__).parent
TARGETS = (1e-3, 1e-5)
PLAN = {
    "kshell Argyris": (2, 4, 6, 8, 12, 16, 24),
    "kshell Argyris, bare": (2, 4, 6, 8, 12, 16, 24),
    "kshell Koiter p = 3": (2, 4, 8, 12, 16),
    "kshell Koiter p = 3, bare": (2, 4, 8, 12, 16, 24),
    "NGSolve shell, order 3": (2, 4, 8, 12, 16),
    "NGSolve shell, order 4": (2, 4, 8, 12, 16, 24),
    "Kratos thin triangle": (8, 16, 32, 64),
    "OpenSees DKGQ": (8, 16, 32, 64),
    "CalculiX S8R": (8, 16),
}
SHELLS: tuple[Comparison, ...] = tuple(
    replace(COMPARISONS[name], references={"w": COMPARISONS[name].references["w"]}, plan=PLAN)
    for name in ("scordelis_lo", "pinched_cylinder", "hemisphere_hole")
)
Rows = Sequence[dict[str, Any]]


def quickest(rows: Rows, problem: str, target: float) -> dict[str, dict[str, Any]]:
    """Of each program the row with the least seconds to an error; bare kshell counts as a program of its own."""
    out: dict[str, dict[str, Any]] = {}
    for row in reaching([row for row in rows if row["problem"] == problem], "w", target):
        program = METHODS[row["method"]].program + (", bare" if row["method"].endswith("bare") else "")
        if program not in out or row["seconds"] < out[program]["seconds"]:
            out[program] = row
    return out


def summary(rows: Rows) -> str:
    """Markdown: CPU seconds of each program to each error, and how many times those of bare kshell that is."""
    programs = [OURS, f"{OURS}, bare", "NGSolve", "Kratos", "OpenSees", "CalculiX"]
    lines = [f"| problem | error | {' | '.join(programs)} |", "|---" * (len(programs) + 2) + "|"]
    for problem in SHELLS:
        for target in TARGETS:
            best = quickest(rows, problem.id, target)
            least = best.get(f"{OURS}, bare")
            cells = []
            for program in programs:
                row = best.get(program)
                ratio = f" ({row['seconds'] / least['seconds']:.1f})" if row and least else ""
                cells.append(
                    f"{row['seconds']:.3f} s{ratio}, {int(row['unknowns'])}" if row else "not reached"
                )
            lines.append(f"| {problem.id} | {target:.0e} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def draw(rows: Rows, facts: dict[str, str]) -> Any:
    """Error against CPU seconds, one panel a problem."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(14, 5.6), layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(1, 3, sharey=True)
    lines: dict[str, Any] = {}
    for panel, problem in zip(panels, SHELLS, strict=True):
        for method in PLAN:
            own = [row for row in rows if (row["problem"], row["method"]) == (problem.id, method)]
            own = [row for row in own if row["unknowns"]]
            if own:
                errors = [max(row["w error"], 1e-10) for row in own]
                (lines[method],) = panel.loglog([row["seconds"] for row in own], errors, **style(method))
        panel.set_title(problem.title.split(" (")[0])
        panel.set_xlabel("CPU seconds on one thread")
        panel.grid(alpha=0.3)
        for target in TARGETS:
            panel.axhline(target, color="0.6", linewidth=0.8)
    panels[0].set_ylabel("relative error of the deflection")
    figure.legend(list(lines.values()), list(lines), loc="outside right upper", fontsize=8)
    figure.supxlabel(
        "Seconds: from the arrays of the mesh to the solution, best of up to three; bare: without energies and the "
        "check of equilibrium, as the other programs\n" + one_line(facts),
        fontsize=6.5,
        color="0.3",
        wrap=True,
    )
    return figure


def main() -> None:
    """Measure, print, draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--peers-python", default=None, help="an interpreter that has peers")
    parser.add_argument("--out", type=Path, default=HERE, help="folder of shells.png and shells.csv")
    parser.add_argument("--redraw", action="store_true", help="measure nothing")
    options = parser.parse_args()
    if options.redraw:
        facts, rows = table.read(options.out / "shells.csv")
    else:
        facts, rows = machine(), []
        for row in run_all(SHELLS, options.peers_python):
            rows.append(row)
            print(shown(row), flush=True)
        own = {row["version"] for row in rows if row["unknowns"] and METHODS[row["method"]].program != OURS}
        facts["peers"] = ", ".join(sorted(own))
    print(summary(rows))
    figure = draw(rows, facts)
    write_together(
        options.out,
        {
            "shells.csv": lambda path: table.write(path, facts, rows),
            "shells.md": lambda path: path.write_text(summary(rows), encoding="utf-8"),
            "shells.png": lambda path: figure.savefig(path, dpi=100, format="png"),
        },
    )


if __name__ == "__main__":
    main()
