"""The load factor over the displacement of the probes along a path."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kshell.result.result import Result

# components smaller than this part of the largest of all are not drawn
SMALL = 0.02
MOST_CURVES = 10


def path_figure(result: Result) -> Figure:
    """One curve per probe and component that moves; stable states filled, unstable ones open, limit points marked."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.5, 5.5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    factors = np.array([entry["factor"] for entry in result.path])
    stable = np.array([entry["stable"] for entry in result.path])
    curves = {
        f"{name}, u_{letter}": np.array([entry["probes"][name]["u"][axis] for entry in result.path])
        for name in result.probes
        for axis, letter in enumerate("xyz")
    }
    largest = max(float(np.abs(u).max()) for u in curves.values())
    drawn = sorted(curves.items(), key=lambda item: -float(np.abs(item[1]).max()))[:MOST_CURVES]
    for label, u in drawn:
        if np.abs(u).max() < SMALL * largest:
            continue
        (line,) = axes.plot(u, factors, linewidth=1.2, label=label)
        axes.plot(u[stable], factors[stable], "o", color=line.get_color(), markersize=4)
        axes.plot(
            u[~stable], factors[~stable], "o", color=line.get_color(), markersize=4, markerfacecolor="white"
        )
    for number, point in enumerate(result.critical):
        words = f"{point['kind']} point, {point['factor']:.4g}"
        axes.axhline(point["factor"], color="grey", linewidth=0.7, linestyle="--")
        place = ("bottom", 2) if number % 2 == 0 else ("top", -2)
        axes.annotate(
            words, (0.99, point["factor"]), xycoords=("axes fraction", "data"), xytext=(0, place[1]),
            textcoords="offset points", ha="right", va=place[0], fontsize=8, color="dimgrey",
        )  # fmt: skip
    axes.axhline(0.0, color="black", linewidth=0.5)
    axes.axvline(0.0, color="black", linewidth=0.5)
    axes.set_xlabel("displacement of the probe")
    axes.set_ylabel("load factor")
    if not stable.all():
        axes.plot([], [], "o", color="black", markersize=4, markerfacecolor="white", label="unstable")
    if axes.get_legend_handles_labels()[1]:
        axes.legend(fontsize=9)
    if result.title:
        axes.set_title(result.title, wrap=True)
    return figure
