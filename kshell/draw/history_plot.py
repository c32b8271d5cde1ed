"""Motion in time: probes and energies over the time, and a film strip of states."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kshell.draw.canvas import flat_triangles
from kshell.draw.shape import round_scale
from kshell.result.result import Result
from kshell.result.vtu import at_nodes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]

# components smaller than this part of the largest of all are not drawn
SMALL = 0.02
MOST_CURVES = 10
FRAMES, COLUMNS = 8, 4
ENERGIES = {
    "kinetic_energy": "kinetic",
    "strain_energy": "strain",
    "external_work": "work of loads",
    "dissipated_energy": "dissipated",
}
VIEW = {"elev": 22.0, "azim": -58.0}


def history_figure(result: Result) -> Figure:
    """Displacements of probes above, energies below."""
    figure = _empty((8.0, 6.5))
    time, probes = result.history["time"], result.history["probes"]
    upper, lower = figure.subplots(2, 1, sharex=True) if probes else (None, figure.add_subplot())
    if upper is not None:
        curves = {
            f"{name}, u_{letter}": values["u"][:, axis]
            for name, values in probes.items()
            for axis, letter in enumerate("xyz")
        }
        largest = max(float(np.abs(u).max()) for u in curves.values())
        drawn = sorted(curves.items(), key=lambda item: -float(np.abs(item[1]).max()))[:MOST_CURVES]
        for label, u in drawn:
            if np.abs(u).max() >= SMALL * largest:
                upper.plot(time, u, linewidth=1.0, label=label)
        upper.axhline(0.0, color="black", linewidth=0.5)
        upper.set_ylabel("displacement")
        upper.legend(fontsize=9)
    for name, label in ENERGIES.items():
        if name in result.history:
            lower.plot(time, result.history[name], linewidth=1.0, label=label)
    if "kinetic_energy" in result.history:
        total = result.history["kinetic_energy"] + result.history["strain_energy"]
        lower.plot(time, total, color="black", linewidth=0.8, linestyle="--", label="kinetic + strain")
    lower.set_xlabel("t")
    lower.set_ylabel("energy")
    lower.legend(fontsize=9)
    if result.title:
        figure.suptitle(result.title)
    return figure


def film_figure(result: Result) -> Figure:
    """States evenly chosen from those kept, from one side: small deflections enlarged, large ones to scale."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    chosen = np.unique(np.linspace(0, len(result.series) - 1, FRAMES).round().astype(int))
    rest, triangles = flat_triangles(result.mesh, result.rows)
    moves = []
    for number in chosen:
        state = result.series[number][1]()
        u = at_nodes(
            state.rows, "displacement", state.fields["displacement"], state.fields, state.edge_fields
        )
        moves.append(u)
    large = bool(result.model["large_deflection"])
    scale = 1.0 if large else round_scale(max(float(np.linalg.norm(u, axis=1).max()) for u in moves), result)
    places = [rest + scale * u for u in moves]
    low = np.min([place.min(axis=0) for place in places], axis=0)
    high = np.max([place.max(axis=0) for place in places], axis=0)
    middle, extent = 0.5 * (low + high), np.maximum(high - low, 0.15 * (high - low).max())
    rows = -(-len(chosen) // COLUMNS)
    figure = _empty((3.0 * COLUMNS, 3.0 * rows + 0.4))
    for place, (number, nodes) in enumerate(zip(chosen, places, strict=True), 1):
        axes = figure.add_subplot(rows, COLUMNS, place, projection="3d", computed_zorder=False)
        axes.add_collection3d(
            Poly3DCollection(
                nodes[triangles], facecolors="#8fb3d9", edgecolors="#44607c", linewidths=0.2, rasterized=True
            )
        )
        for setter, m, s in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), middle, extent, strict=True):
            setter(m - 0.5 * s, m + 0.5 * s)
        axes.set_box_aspect(extent.copy(), zoom=0.8)  # which it scales in place
        axes.view_init(**VIEW)
        axes.set_axis_off()
        axes.set_title(f"t = {result.series[number][0]:.4g}", fontsize=10)
    words = [result.title] if result.title else []
    if scale != 1.0:
        words.append(f"displacements drawn {scale:g} times as large")
    if words:
        figure.suptitle("\n".join(words))
    return figure


def _empty(size: tuple[float, float]) -> Figure:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    return figure
