"""Modes of vibration and buckling: a grid of all of them, and each by itself.

Plates are seen from above, with their nodal lines (Chladni's figures) in black; shells are drawn deformed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.draw.canvas import draw_edges, flat_triangles
from kshell.result.result import Result
from kshell.result.vtu import at_nodes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]

MOST = 24  # modes in one picture
COLUMNS = 4
SHOWN = 0.12  # largest displacement as drawn, against the size of the shell
VIEW = {"elev": 28.0, "azim": -58.0}
LEVELS = 10


def modes_figure(result: Result) -> Figure:
    """All modes, at most the first MOST."""
    return _figure(result, list(range(1, min(len(result.eigen), MOST) + 1)))


def mode_figure(result: Result, number: int) -> Figure:
    """One mode, counted from 1."""
    return _figure(result, [number])


def caption(result: Result, number: int) -> str:
    """Number and frequency, factor, or name."""
    entry = result.eigen[number - 1]
    if "name" in entry:
        return f"{number}: {entry['name']}"
    if result.analysis == "buckling":
        return f"{number}: factor {entry['value']:.5g}"
    if entry["frequency"] is None:
        return f"{number}: value {entry['value']:.5g}, unstable"
    return f"{number}: {entry['frequency']:.5g} Hz"


def _figure(result: Result, numbers: list[int]) -> Figure:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    mesh = result.mesh
    plate = result.model.get("kind") == "plate"
    columns = min(COLUMNS, len(numbers))
    rows = -(-len(numbers) // columns)
    width, height = np.maximum(np.ptp(mesh.points[:, :2], axis=0), 1e-9 * mesh.size)
    ratio = float(np.clip(height / width, 0.3, 1.6)) if plate else 0.9
    side = 7.0 if columns == 1 else 3.0
    figure = Figure(figsize=(side * columns, (side * ratio + 0.4) * rows + 0.4), layout="constrained")
    FigureCanvasAgg(figure)
    for place, number in enumerate(numbers, 1):
        shape = at_nodes(result.rows, f"mode_{number}", result.fields[f"mode_{number}"], result.fields)
        if plate:
            axes = figure.add_subplot(rows, columns, place)
            _contours(axes, result, shape[:, 2])
        else:
            axes = figure.add_subplot(rows, columns, place, projection="3d", computed_zorder=False)
            _deformed(axes, result, shape)
        axes.set_title(caption(result, number), fontsize=10, wrap=True)
    if result.title:
        figure.suptitle(result.title)
    return figure


def _contours(axes: Any, result: Result, w: Floats) -> None:
    """Deflection in colours, and where it is zero."""
    from matplotlib.tri import Triangulation

    mesh = result.mesh
    points, triangles = flat_triangles(mesh)
    most = float(np.abs(w).max()) or 1.0
    triangulation = Triangulation(points[:, 0], points[:, 1], triangles)
    levels = np.linspace(-most, most, 2 * LEVELS + 1)
    axes.tricontourf(triangulation, w, levels=levels, cmap="RdBu_r", extend="both")
    if w.min() < 0 < w.max():
        axes.tricontour(triangulation, w, levels=[0.0], colors="black", linewidths=1.2)
    draw_edges(axes, mesh, mesh.boundary_edges, colors="black", linewidths=0.9)
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.set_axis_off()


def _deformed(axes: Any, result: Result, shape: Floats) -> None:
    """The surface moved along the mode, coloured by the length of the displacement, with its outline at rest."""
    from matplotlib import colormaps
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    mesh = result.mesh
    rest, triangles = flat_triangles(mesh)
    size = np.linalg.norm(shape, axis=1)
    most = float(size.max()) or 1.0
    nodes = rest + SHOWN * mesh.size / most * shape
    faces = colormaps["viridis"](size[triangles].mean(axis=1) / most)
    axes.add_collection3d(
        Poly3DCollection(
            nodes[triangles], facecolors=faces, edgecolors=faces, linewidths=0.2, rasterized=True
        )
    )
    outline = np.flatnonzero(mesh.edge_counts != 2)
    if len(outline):
        for where, style in ((nodes, {"colors": "black"}), (rest, {"colors": "0.5", "linestyles": "--"})):
            lines = where[mesh.edges[outline]]
            axes.add_collection3d(Line3DCollection(lines, linewidths=0.8, **style))
    both = np.concatenate([rest, nodes])
    low, high = both.min(axis=0), both.max(axis=0)
    middle, extent = 0.5 * (low + high), np.maximum(high - low, 0.15 * (high - low).max())
    for setter, m, s in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), middle, extent, strict=True):
        setter(m - 0.52 * s, m + 0.52 * s)
    axes.set_box_aspect(extent)
    axes.view_init(**VIEW)
    axes.set_axis_off()
