"""Charts of the measurements: each error against CPU seconds and against unknowns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from verification.suite.machine import one_line
from verification.work_precision.problems import METHODS, Problem

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STYLES = {
    "kshell": {"linewidth": 2.2, "markersize": 6, "linestyle": "-"},
    "scikit-fem": {"linewidth": 1.1, "markersize": 5, "linestyle": "--"},
    "ngsolve": {"linewidth": 1.1, "markersize": 5, "linestyle": ":"},
}
COLOURS = {
    "kshell": ("#b91c1c", "#f97316", "#1d4ed8", "#38bdf8"),
    "scikit-fem": ("#57534e", "#a8a29e"),
    "ngsolve": ("#bbf7d0", "#86efac", "#22c55e", "#166534"),
}
MARKERS = "os^vDPX*"
NAMES = {"compliance": "energy", "w": "deflection", "M": "moment M_xx"}
TIMED = (
    "Seconds: processor time on one thread from mesh arrays to values, best of up to three, without imports and a "
    "first small solve.\nkshell recovers all moments, shear forces and reactions and checks equilibrium in this time; "
    "the others evaluate what is compared."
)


def chart(problem: Problem, rows: Sequence[Mapping[str, Any]], facts: dict[str, str]) -> Figure:
    """One row of panels per quantity."""
    from matplotlib.figure import Figure

    names = list(problem.references)
    figure = Figure(figsize=(11, 1.7 + 3.1 * len(names)), layout="constrained", dpi=90)
    panels: Any = figure.subplots(len(names), 2, squeeze=False, sharey="row")
    own = [row for row in rows if row["problem"] == problem.id]
    for line, name in zip(panels, names, strict=True):
        for axes, x in zip(line, ("seconds", "unknowns"), strict=True):
            _panel(axes, own, name, x)
            if problem.uncertainty > 1e-12:
                axes.axhspan(1e-14, problem.uncertainty, color="0.92")
                axes.set_ylim(bottom=problem.uncertainty / 30)
        line[0].set_ylabel(f"relative error of the {NAMES[name]}")
    panels[-1, 0].set_xlabel("CPU seconds")
    panels[-1, 1].set_xlabel("unknowns")
    handles, labels = panels[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right upper", fontsize=8)
    figure.suptitle(problem.title)
    shaded = "" if problem.uncertainty < 1e-12 else "\nShaded: below the uncertainty of the reference."
    figure.supxlabel(f"{TIMED}{shaded}\n{one_line(facts)}", fontsize=6, color="0.3")
    return figure


def _panel(axes: Any, rows: Sequence[Mapping[str, Any]], name: str, x: str) -> None:
    seen = dict.fromkeys(COLOURS, 0)
    for number, method in enumerate(METHODS):
        colour = COLOURS[method.program][seen[method.program]]
        seen[method.program] += 1
        own = [row for row in rows if row["method"] == method.id and np.isfinite(row[f"{name} error"])]
        if own:
            axes.loglog(
                [row[x] for row in own], [max(row[f"{name} error"], 1e-15) for row in own],
                marker=MARKERS[number % len(MARKERS)], color=colour, label=method.id, **STYLES[method.program],
            )  # fmt: skip
    axes.grid(alpha=0.25)


def winners(
    rows: Sequence[Mapping[str, Any]], problem: Problem
) -> list[tuple[str, float, str, float, str, float]]:
    """Least CPU seconds to an error: (quantity, error, fastest of kshell, s, fastest peer, s); inf: nobody."""
    out = []
    for name in problem.references:
        for target in (1e-3, 1e-6):
            if target <= problem.uncertainty:
                continue
            best = {True: ("none", np.inf), False: ("none", np.inf)}
            for row in rows:
                ours = row["method"].startswith("kshell")
                good = row["problem"] == problem.id and row[f"{name} error"] <= target
                if good and row["seconds"] < best[ours][1]:
                    best[ours] = (row["method"], row["seconds"])
            out.append((NAMES[name], target, *best[True], *best[False]))
    return out
