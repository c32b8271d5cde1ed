"""Pictures of results with matplotlib: fields over a flat mesh seen from above, over a surface in 3D."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.mesh import Mesh
from kshell.result.vtu import at_nodes
from kshell.values.naming import listing, suggestion

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from kshell.result.result import Result

Floats = NDArray[np.float64]

SIZE = -1  # instead of a column: the length of the vector

# picture: (field, column, label of the colour bar)
FIELDS: dict[str, tuple[str, int, str]] = {
    "deflection": ("displacement", 2, "deflection w"),
    "moment_xx": ("moment", 0, "bending moment M_xx per length"),
    "moment_yy": ("moment", 1, "bending moment M_yy per length"),
    "moment_xy": ("moment", 2, "twisting moment M_xy per length"),
    "von_mises_top": ("von_mises_top", 0, "von Mises stress at the top (z = +t/2)"),
}
PICTURES = (*FIELDS, "mesh")

# of shells, in addition or instead
SHELL_FIELDS: dict[str, tuple[str, int, str]] = {
    **FIELDS,
    "deflection": ("displacement", SIZE, "length of the displacement"),
    "force_xx": ("membrane_force", 0, "membrane force N_xx per length"),
    "force_yy": ("membrane_force", 1, "membrane force N_yy per length"),
    "force_xy": ("membrane_force", 2, "membrane force N_xy per length"),
    "von_mises_top": ("von_mises_top", 0, "von Mises stress at the top (side of the normal)"),
    "von_mises_middle": ("von_mises_middle", 0, "von Mises stress in the middle"),
    "von_mises_bottom": ("von_mises_bottom", 0, "von Mises stress at the bottom"),
}

# heights closer together than this fraction of the size are a plan view
FLAT = 1e-9
# up to this many triangles their edges are drawn over a field
FEW_TRIANGLES = 4000
DPI = 150
TICKS = 5  # numbers along an axis: laying them out takes half of the time of a picture


def pictures(result: Result) -> tuple[str, ...]:
    """The names of the pictures that a result has."""
    if result.model.get("kind") != "shell":
        return PICTURES
    path = ("load_deflection",) if result.path and result.probes else ()
    return (*SHELL_FIELDS, *path, "mesh")


def plot(result: Result, what: str = "deflection") -> Figure:
    """A picture of a result. See `Result.plot`."""
    known = pictures(result)
    if what not in known:
        raise InputError(f'no picture "{what}": {suggestion(what, known)}the pictures are {listing(known)}')
    if what == "load_deflection":
        from kshell.draw.path_plot import path_figure

        return path_figure(result)
    flat = np.ptp(result.mesh.points[:, 2]) <= FLAT * result.mesh.size
    if what == "mesh":
        from kshell.draw.scene_plot import plot_scene
        from kshell.draw.surface_plot import plot_surface_scene

        return (plot_scene if flat else plot_surface_scene)(result.mesh, result.scene, result.title)
    values, label = picture_values(result, what)
    if flat:
        return _field_figure(result, values, label)
    from kshell.draw.surface_plot import surface_figure

    return surface_figure(result, values, label)


def picture_values(result: Result, what: str) -> tuple[Floats, str]:
    """Values at vertices and mid-edge nodes, and words for the colour bar."""
    name, column, label = (SHELL_FIELDS if result.model.get("kind") == "shell" else FIELDS)[what]
    if name not in result.fields:
        raise InputError(f'no picture "{what}": the result has no field "{name}"')
    values = result.fields[name].reshape(len(result.mesh.points), -1)
    values = at_nodes(result.mesh, name, values, result.fields, result.edge_fields)
    return (np.linalg.norm(values, axis=1) if column == SIZE else values[:, column]), label


def colours(low: float, high: float) -> dict[str, Any]:
    """Colour map and limits for values from low to high: white is zero where both signs occur."""
    if low < 0.0 < high and min(-low, high) > 0.02 * max(-low, high):
        most = max(-low, high)
        return {"cmap": "RdBu_r", "vmin": -most, "vmax": most}
    return {"cmap": "viridis_r" if high <= 0.0 or -low > high else "viridis", "vmin": low, "vmax": high}


def save_picture(result: Result, what: str, path: Path) -> None:
    """Write a picture as PNG."""
    figure = plot(result, what)
    figure.set_dpi(DPI)
    engine = figure.get_layout_engine()
    if engine is not None:  # laid out here, or savefig would draw everything twice
        engine.execute(figure)
        figure.set_layout_engine("none")
    figure.savefig(path, dpi=DPI, format="png", pil_kwargs={"compress_level": 1})


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


def flat_triangles(mesh: Mesh) -> tuple[Floats, NDArray[np.int32]]:
    """Nodes (n, 3) and straight triangles for drawing; an order-2 triangle becomes four."""
    if mesh.midpoints is None:
        return mesh.points, mesh.triangles
    a, b, c = mesh.triangles.T
    ab, bc, ac = (mesh.triangle_edges + len(mesh.points)).T
    parts = [(a, ab, ac), (ab, b, bc), (ac, bc, c), (ab, bc, ac)]
    triangles = np.concatenate([np.stack(part, axis=1) for part in parts])
    return np.concatenate([mesh.points, mesh.midpoints]), triangles


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
    from matplotlib.tri import Triangulation

    mesh = result.mesh
    figure, axes = new_figure(mesh, result.title)
    points, triangles = flat_triangles(mesh)
    triangulation = Triangulation(points[:, 0], points[:, 1], triangles)
    low, high = float(values.min()), float(values.max())
    image = axes.tripcolor(triangulation, values, shading="gouraud", rasterized=True, **colours(low, high))
    if high > low:
        lines = axes.tricontour(triangulation, values, levels=8, colors="black", linewidths=0.4)
        lines.set_alpha(0.5)
    if len(mesh.triangles) <= FEW_TRIANGLES:
        draw_edges(axes, mesh, np.arange(len(mesh.edges)), colors="black", linewidths=0.2, alpha=0.25)
    draw_edges(axes, mesh, mesh.boundary_edges, colors="black", linewidths=0.9)
    axes.autoscale_view()
    wide = np.ptp(mesh.points[:, 0]) > 1.3 * np.ptp(mesh.points[:, 1])
    where = "bottom" if wide else "right"
    if wide:
        figure.set_figheight(figure.get_figheight() + 1.0)
    colour_bar(figure, axes, image, f"{label}\nfrom {low:.4g} to {high:.4g}", where, 40 if wide else 30)
    return figure


def colour_bar(figure: Figure, axes: Axes, image: Any, label: str, where: str, aspect: float) -> None:
    """Add a colour bar with short numbers."""
    from matplotlib.ticker import MaxNLocator, ScalarFormatter

    numbers = ScalarFormatter(useMathText=False)  # parsing mathematics takes longer than the rest of the text
    numbers.set_powerlimits((-3, 4))
    ticks = MaxNLocator(TICKS)
    figure.colorbar(image, ax=axes, format=numbers, ticks=ticks, location=where, aspect=aspect).set_label(
        label
    )
