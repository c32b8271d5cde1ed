"""Pictures of results with matplotlib: fields over the plate seen from above."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.mesh import Mesh
from kshell.naming import listing, suggestion
from kshell.vtu import at_nodes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from kshell.result import Result

Floats = NDArray[np.float64]

# picture: (field, column, label of the colour bar)
FIELDS: dict[str, tuple[str, int, str]] = {
    "deflection": ("displacement", 2, "deflection w"),
    "moment_xx": ("moment", 0, "bending moment M_xx per length"),
    "moment_yy": ("moment", 1, "bending moment M_yy per length"),
    "moment_xy": ("moment", 2, "twisting moment M_xy per length"),
    "von_mises_top": ("von_mises_top", 0, "von Mises stress at the top (z = +t/2)"),
}
PICTURES = (*FIELDS, "mesh")

# up to this many triangles their edges are drawn over a field
FEW_TRIANGLES = 4000


def plot(result: Result, what: str = "deflection") -> Figure:
    """A picture of a result. See `Result.plot`."""
    if what not in PICTURES:
        raise InputError(
            f'no picture "{what}": {suggestion(what, PICTURES)}the pictures are {listing(PICTURES)}'
        )
    if what == "mesh":
        from kshell.scene_plot import plot_scene

        return plot_scene(result.mesh, result.scene, result.title)
    name, column, label = FIELDS[what]
    if name not in result.fields:
        raise InputError(f'no picture "{what}": the result has no field "{name}"')
    values = result.fields[name].reshape(len(result.mesh.points), -1)
    values = at_nodes(result.mesh, name, values, result.fields)[:, column]
    return _field_figure(result, values, label)


def save_picture(result: Result, what: str, path: Path) -> None:
    """Write a picture as PNG."""
    plot(result, what).savefig(path, dpi=150, format="png")


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
    axes.set_xlabel("x")
    axes.set_ylabel("y")
    if title:
        axes.set_title(title, wrap=True)
    return figure, axes


def flat_triangles(mesh: Mesh) -> tuple[Floats, NDArray[np.int32]]:
    """Nodes (n, 2) and straight triangles for drawing; an order-2 triangle becomes four."""
    if mesh.midpoints is None:
        return mesh.points[:, :2], mesh.triangles
    a, b, c = mesh.triangles.T
    ab, bc, ac = (mesh.triangle_edges + len(mesh.points)).T
    parts = [(a, ab, ac), (ab, b, bc), (ac, bc, c), (ab, bc, ac)]
    triangles = np.concatenate([np.stack(part, axis=1) for part in parts])
    return np.concatenate([mesh.points, mesh.midpoints])[:, :2], triangles


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


def _field_figure(result: Result, values: Floats, label: str) -> Figure:
    from matplotlib.ticker import ScalarFormatter
    from matplotlib.tri import Triangulation

    mesh = result.mesh
    figure, axes = new_figure(mesh, result.title)
    points, triangles = flat_triangles(mesh)
    triangulation = Triangulation(points[:, 0], points[:, 1], triangles)
    low, high = float(values.min()), float(values.max())
    style: dict[str, Any] = {"cmap": "viridis", "vmin": low, "vmax": high}
    if low < 0.0 < high and min(-low, high) > 0.02 * max(-low, high):
        most = max(-low, high)  # both signs: white is zero
        style = {"cmap": "RdBu_r", "vmin": -most, "vmax": most}
    elif high <= 0.0 or -low > high:
        style["cmap"] = "viridis_r"
    image = axes.tripcolor(triangulation, values, shading="gouraud", rasterized=True, **style)
    if high > low:
        lines = axes.tricontour(triangulation, values, levels=8, colors="black", linewidths=0.4)
        lines.set_alpha(0.5)
    if len(mesh.triangles) <= FEW_TRIANGLES:
        draw_edges(axes, mesh, np.arange(len(mesh.edges)), colors="black", linewidths=0.2, alpha=0.25)
    draw_edges(axes, mesh, mesh.boundary_edges, colors="black", linewidths=0.9)
    axes.autoscale_view()
    numbers = ScalarFormatter(useMathText=True)
    numbers.set_powerlimits((-3, 4))
    wide = np.ptp(mesh.points[:, 0]) > 1.3 * np.ptp(mesh.points[:, 1])
    where = "bottom" if wide else "right"
    if wide:
        figure.set_figheight(figure.get_figheight() + 1.0)
    bar = figure.colorbar(image, ax=axes, format=numbers, location=where, aspect=40 if wide else 30)
    bar.set_label(f"{label}\nfrom {low:.4g} to {high:.4g}")
    return figure
