"""What pictures share: figures, colours, edges and triangles of a mesh as matplotlib draws them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.result.rows import Rows

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]

# up to this many triangles their edges are drawn over a field
FEW_TRIANGLES = 4000
TICKS = 5  # numbers along an axis: laying them out takes half of the time of a picture


def colours(low: float, high: float) -> dict[str, Any]:
    """Colour map and limits for values from low to high: white is zero where both signs occur."""
    if low < 0.0 < high and min(-low, high) > 0.02 * max(-low, high):
        most = max(-low, high)
        return {"cmap": "RdBu_r", "vmin": -most, "vmax": most}
    return {"cmap": "viridis_r" if high <= 0.0 or -low > high else "viridis", "vmin": low, "vmax": high}


def new_figure(mesh: Mesh, title: str) -> tuple[Figure, Axes]:
    """An empty figure for a plan view of the mesh: equal axes, as wide or high as the mesh asks."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    width, height = np.maximum(np.ptp(mesh.points[:, :2], axis=0), 1e-9 * mesh.size)
    ratio = float(np.clip(height / width, 0.3, 1.6))
    figure = Figure(figsize=(7.5, 1.2 + 5.6 * ratio), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    axes.set_aspect("equal")
    axes.locator_params(nbins=TICKS)
    axes.set_xlabel("x")
    axes.set_ylabel("y")
    if title:
        axes.set_title(title, wrap=True)
    return figure, axes


def flat_triangles(mesh: Mesh, rows: Rows | None = None) -> tuple[Floats, NDArray[np.integer]]:
    """Nodes (n, 3) and straight triangles for drawing; an order-2 triangle becomes four.

    Parameters
    ----------
    rows : Rows, optional
        Of the fields to be drawn, with a node for each; one for each vertex and edge if absent.
    """
    if rows is None:
        rows = Rows.of_vertices(mesh)
    if mesh.midpoints is None:
        return rows.nodes, rows.cells
    a, b, c, ab, bc, ac = rows.cells.T
    parts = [(a, ab, ac), (ab, b, bc), (ac, bc, c), (ab, bc, ac)]
    triangles = np.concatenate([np.stack(part, axis=1) for part in parts])
    return rows.nodes, triangles


def edge_lines(mesh: Mesh, edges: NDArray[np.integer]) -> Floats:
    """(edge, 2 or 3 points, 2) polylines along edges, through the mid-edge nodes where there are some."""
    ends = mesh.points[mesh.edges[edges]][:, :, :2]
    if mesh.midpoints is None:
        return ends
    return np.stack([ends[:, 0], mesh.midpoints[edges, :2], ends[:, 1]], axis=1)


def draw_edges(axes: Axes, mesh: Mesh, edges: NDArray[np.integer], **style: Any) -> None:
    """Draw edges of the mesh as lines."""
    from matplotlib.collections import LineCollection

    axes.add_collection(LineCollection(list(edge_lines(mesh, edges)), **style))


def colour_bar(figure: Figure, axes: Axes, image: Any, label: str, where: str, aspect: float) -> None:
    """Add a colour bar with short numbers."""
    from matplotlib.ticker import MaxNLocator, ScalarFormatter

    numbers = ScalarFormatter(useMathText=False)  # parsing mathematics takes longer than the rest of the text
    numbers.set_powerlimits((-3, 4))
    ticks = MaxNLocator(TICKS)
    figure.colorbar(image, ax=axes, format=numbers, ticks=ticks, location=where, aspect=aspect).set_label(
        label
    )
