"""A field over a flat mesh, seen from above."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kshell.draw.canvas import FEW_TRIANGLES, colour_bar, colours, draw_edges, flat_triangles, new_figure
from kshell.result.result import Result

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]


def field_figure(result: Result, values: Floats, label: str) -> Figure:
    """A field in colours with lines of equal value.

    Parameters
    ----------
    values : (node,)
        At the nodes of the rows of the fields.
    label : str
    """
    from matplotlib.tri import Triangulation

    mesh = result.mesh
    figure, axes = new_figure(mesh, result.title)
    points, triangles = flat_triangles(mesh, result.rows)
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
