"""Amplitudes of a harmonic response over the frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kshell.result.result import Result

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SMALL = 1e-3  # of the largest amplitude: curves below are not drawn


def response_figure(result: Result) -> Figure:
    """One curve per probe and component that moves; natural frequencies as vertical lines."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.5, 5.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    frequency = np.array(result.response["frequency"])
    curves: dict[str, np.ndarray] = {}
    for name, probe in result.response["probes"].items():
        size = np.abs(np.array(probe["u"]["real"]) + 1j * np.array(probe["u"]["imag"]))
        curves |= {f"{name}, |u_{letter}|": size[:, axis] for axis, letter in enumerate("xyz")}
    largest = max(float(curve.max()) for curve in curves.values())
    for label, curve in curves.items():
        if curve.max() > SMALL * largest:
            axes.semilogy(frequency, np.maximum(curve, 1e-12 * largest), linewidth=1.2, label=label)
    for f in result.response["modes"]:
        if frequency[0] <= f <= frequency[-1]:
            axes.axvline(f, color="grey", linewidth=0.6, linestyle=":")
    axes.set_xlabel("frequency")
    axes.set_ylabel("amplitude")
    if axes.get_legend_handles_labels()[1]:
        axes.legend(fontsize=9)
    if result.title:
        axes.set_title(result.title, wrap=True)
    return figure
