"""Charts of a verification run: errors against allowances, errors against unknowns, rates, times."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kshell.verify.cases.case import method_of
from kshell.verify.run import Report

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from kshell.verify.cases import Outcome
    from kshell.verify.cases.rates import Measured

FLOOR = 1e-16  # errors below are drawn here
MARKS = {  # and what the legend calls it
    "argyris": ("o", "#c2410c", "Argyris"),
    "morley": ("^", "#1d4ed8", "Morley"),
    "koiter1": ("v", "#7dd3a8", "Koiter, degree 1"),
    "koiter2": ("s", "#059669", "Koiter, degree 2"),
    "koiter3": ("D", "#064e3b", "Koiter, degree 3"),
}


def charts(report: Report, foot: str) -> dict[str, Figure]:
    """Figures by file name."""
    out = {"margins.png": _margins(report), "errors.png": _errors(report), "times.png": _times(report)}
    if any(block.measured for block in report.blocks):
        out["rates.png"] = _rates(report)
    for figure in out.values():
        figure.supxlabel(foot, fontsize=5.5, color="0.35", wrap=True)
    return out


def _figure(height: float = 4.2) -> tuple[Figure, Axes]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.5, height), layout="constrained", dpi=110)
    return figure, figure.add_subplot()


def _values(report: Report) -> list[Outcome]:
    """Compared values, without the rates."""
    return [one for block in report.blocks if block.measured is None for one in block.outcomes]


def _by_method(outcomes: list[Outcome]) -> dict[str, list[Outcome]]:
    """In the order of `MARKS`, without methods that no value has."""
    out: dict[str, list[Outcome]] = {method: [] for method in MARKS}
    for one in outcomes:
        out[method_of(one.run)].append(one)
    return {method: some for method, some in out.items() if some}


def _margins(report: Report) -> Figure:
    """Error over allowed error of every value, by family; above 1 it failed."""
    figure, axes = _figure()
    values = _values(report)
    families = list(dict.fromkeys(one.case.partition(".")[0] for one in values))
    for method, some in _by_method(values).items():
        marker, colour, words = MARKS[method]
        # spread sideways by golden-ratio steps, so that points do not hide each other
        spread = 0.7 * (np.arange(len(some)) * 0.618 % 1 - 0.5)
        x = np.array([families.index(one.case.partition(".")[0]) for one in some]) + spread
        y = np.maximum([min(one.used, 1e3) for one in some], 1e-6)
        axes.semilogy(x, y, marker, color=colour, markersize=3, alpha=0.5, label=words)
    axes.axhline(1.0, color="black", linewidth=1)
    axes.text(0.003, 1.15, "fails above", transform=axes.get_yaxis_transform(), fontsize=8)
    axes.set_xticks(
        range(len(families)), families, rotation=30, ha="right", rotation_mode="anchor", fontsize=8
    )
    axes.set_ylim(5e-7, 4 if not report.failed else None)
    axes.set(
        ylabel="error / allowed error", title=f"{report.cases} cases, {len(values)} values: margin to failure"
    )
    axes.legend(loc="lower right", fontsize=8)
    return figure


def _errors(report: Report) -> Figure:
    """Relative error of every value against unknowns."""
    figure, axes = _figure()
    for method, some in _by_method(_values(report)).items():
        marker, colour, words = MARKS[method]
        errors = np.maximum([one.error if np.isfinite(one.error) else 1.0 for one in some], FLOOR)
        axes.loglog(
            [max(one.unknowns, 1) for one in some], errors, marker, color=colour, markersize=3.5, alpha=0.4,
            label=f"{words}, median {np.median(errors):.0e}",
        )  # fmt: skip
    axes.set(
        xlabel="unknowns",
        ylabel="relative error",
        title="Deflections, moments, reactions, energies: relative errors",
    )
    axes.grid(alpha=0.25)
    axes.legend(fontsize=8)
    return figure


def _times(report: Report) -> Figure:
    """Wall seconds of each solve against unknowns."""
    figure, axes = _figure(3.6)
    for method, (marker, colour, words) in MARKS.items():
        some = [b for b in report.blocks if b.measured is None and method_of(b.outcomes[0].run) == method]
        if not some:
            continue
        axes.loglog(
            [max(b.outcomes[0].unknowns, 1) for b in some], [b.seconds for b in some], marker, color=colour,
            markersize=4, alpha=0.6, label=words,
        )  # fmt: skip
    axes.set(
        xlabel="unknowns",
        ylabel="seconds of wall time",
        title=f"Each solve: mesh, assembly, solution, recovery; {report.seconds:.0f} s altogether",
    )
    axes.grid(alpha=0.25)
    axes.legend(fontsize=8)
    return figure


def _rates(report: Report) -> Figure:
    """Observed rates beside the expected ones: plate elements, and Koiter elements and charts."""
    from matplotlib.figure import Figure

    measured = [block.measured for block in report.blocks if block.measured is not None]
    parts: dict[str, list[Measured]] = {"plates": [], "Koiter elements, and Argyris on charts": []}
    for one in measured:
        parts[list(parts)[one.row.method.startswith("koiter") or one.row.case.startswith("shell.")]].append(
            one
        )
    parts = {name: some for name, some in parts.items() if some}
    longest = max(len(some) for some in parts.values())
    figure = Figure(figsize=(8.5 * len(parts), 1.4 + 0.17 * longest), layout="constrained", dpi=110)
    for axes, (name, some) in zip(
        figure.subplots(1, len(parts), squeeze=False)[0], parts.items(), strict=True
    ):
        y = np.arange(len(some))[::-1]
        axes.plot([one.row.rate for one in some], y, "|", color="black", markersize=11, label="expected")
        observed = np.array([one.rate for one in some])
        for method, (marker, colour, words) in MARKS.items():
            own = np.array([one.row.method == method for one in some])
            if own.any():
                axes.plot(observed[own], y[own], marker, color=colour, markersize=5, label=words)
        labels = [f"{one.row.case} {one.row.quantity}, {one.row.name}" for one in some]
        axes.set_yticks(y, labels, fontsize=6.5)
        axes.set(xlabel="rate of convergence in the mesh size", title=f"Observed and expected rates: {name}")
        axes.grid(axis="x", alpha=0.25)
        axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.07), ncols=6)
    return figure
