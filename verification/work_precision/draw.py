"""Charts of the measurements: each error against CPU seconds and against unknowns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np

from kshell.verify.machine import one_line
from verification.work_precision.methods import METHODS
from verification.work_precision.problems import Comparison

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Row = Mapping[str, Any]
OURS = "kshell"
# kshell's lines are thick and solid, each peer has a colour of its own and dashes
KSHELL = {
    "kshell Argyris": "#b91c1c",
    "kshell Argyris, multigrid": "#f472b6",
    "kshell Morley": "#f97316",
    "kshell Morley, multigrid": "#fbbf24",
    "kshell HHJ, order 3": "#fda4af",
    "kshell HHJ, order 4": "#fb7185",
    "kshell HHJ, order 5": "#f43f5e",
    "kshell HHJ, order 6": "#be123c",
    "kshell HHJ, order 7": "#9f1239",
    "kshell HHJ, order 8": "#881337",
    "kshell HHJ, order 10": "#4c0519",
    "kshell HHJ, order 12": "#1c0206",
    "kshell Koiter p = 1": "#93c5fd",
    "kshell Koiter p = 2": "#2563eb",
    "kshell Koiter p = 3": "#1e3a8a",
    "kshell Koiter p = 4": "#0f766e",
    "kshell Koiter p = 5": "#14b8a6",
    "kshell Koiter p = 6": "#042f2e",
    "kshell Argyris, bare": "#f87171",
    "kshell Koiter p = 2, bare": "#7dd3fc",
    "kshell Koiter p = 3, bare": "#6366f1",
}
PEERS = {
    "NGSolve": ("#bbf7d0", "#4ade80", "#16a34a", "#14532d", "#86efac", "#22c55e", "#052e16"),
    "scikit-fem": ("#57534e", "#a8a29e"),
    "Kratos": ("#7c3aed",),
    "OpenSees": ("#0891b2", "#67e8f9"),
    "GetFEM": ("#a16207", "#eab308"),
    "FreeFEM": ("#db2777",),
    "CalculiX": ("#000000",),
}
MARKERS = "os^vDPX*"
NAMES = {"compliance": "energy", "w": "deflection", "M": "moment"}
TIMED = (
    "Seconds: processor time on one thread from the arrays of the mesh to the solution, best of 3 to 12, without "
    "imports and a first small solve; each program in a process of its own.\nIn this time kshell also checks mesh, "
    "supports and equilibrium, without estimates of errors; the others build, assemble and solve. Values at points are "
    "read behind the clock."
)


def errors(rows: Sequence[Row], name: str) -> list[Row]:
    """The rows that have an error of a quantity."""
    return [row for row in rows if np.isfinite(row[f"{name} error"])]


def chart(comparison: Comparison, rows: Sequence[Row], facts: dict[str, str]) -> Figure:
    """One row of panels per quantity; against seconds on the left, against unknowns on the right."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    own = [row for row in rows if row["problem"] == comparison.id]
    names = [name for name in comparison.references if errors(own, name)]
    figure = Figure(figsize=(11.5, 1.6 + 3.3 * len(names)), layout="constrained", dpi=90)
    FigureCanvasAgg(figure)
    panels: Any = figure.subplots(len(names), 2, squeeze=False, sharey="row")
    lines: dict[str, Any] = {}
    for line, name in zip(panels, names, strict=True):
        uncertainty = comparison.references[name].uncertainty
        for axes, x in zip(line, ("seconds", "unknowns"), strict=True):
            lines |= _panel(axes, own, name, x, uncertainty)
        line[0].set_ylabel(f"relative error of the {NAMES[name]}")
    panels[-1, 0].set_xlabel("CPU seconds")
    panels[-1, 1].set_xlabel("unknowns")
    shown = {name: lines[name] for name in comparison.plan if name in lines}
    figure.legend(list(shown.values()), list(shown), loc="outside right upper", fontsize=8)
    figure.suptitle(comparison.title)
    missing = sorted({METHODS[row["method"]].program for row in own if row["version"] == "not installed"})
    words = [TIMED, *wrap(one_line(facts), 190)]
    words += [f"Not installed: {', '.join(missing)}"] if missing else []
    words += sorted(
        {f"{row['method']}: {row['version']}" for row in own if row["version"].startswith("no answer")}
    )
    if any(reference.uncertainty > 1e-9 for reference in comparison.references.values()):
        words[0] += "\nShaded: below the uncertainty of the reference."
    figure.supxlabel("\n".join(words), fontsize=6.5, color="0.3")
    return figure


def style(method: str) -> dict[str, Any]:
    """Colour, line and marker of a method."""
    program = METHODS[method].program
    siblings = [name for name, other in METHODS.items() if (other.program, other.driver) == _family(method)]
    number = siblings.index(method)
    marker = MARKERS[number % len(MARKERS)]
    if program == OURS:
        return {"color": KSHELL[method], "linewidth": 2.2, "markersize": 5.5, "marker": marker}
    colours = PEERS[program]
    dashes = {"linewidth": 1.2, "markersize": 4.5, "linestyle": (0, (4, 2))}
    return {"color": colours[number % len(colours)], "marker": marker, **dashes}


def _family(method: str) -> tuple[str, str]:
    return METHODS[method].program, METHODS[method].driver


def _panel(axes: Any, rows: Sequence[Row], name: str, x: str, uncertainty: float) -> dict[str, Any]:
    found = errors(rows, name)
    lines = {}
    floor = max(uncertainty, 1e-13) / 10
    for method in sorted({row["method"] for row in found}, key=list(METHODS).index):
        own = [row for row in found if row["method"] == method]
        y = [max(row[f"{name} error"], floor) for row in own]
        (lines[method],) = axes.loglog([row[x] for row in own], y, **style(method))
    if uncertainty > 1e-9:
        axes.axhspan(floor / 10, uncertainty, color="0.92")
        axes.set_ylim(bottom=floor)
    axes.set_ylim(top=min(2.0, axes.get_ylim()[1]))
    axes.grid(alpha=0.25)
    _plain_ticks(axes)
    return lines


def _plain_ticks(axes: Any) -> None:
    """Numbers along x that do not run into each other: 1, 2 and 5 within one and a half decades, else powers of ten."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axes.get_xlim()
    axes.xaxis.set_minor_formatter(NullFormatter())
    if high < 30 * low:
        axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
