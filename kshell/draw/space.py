"""Surfaces in 3D with matplotlib: axes, shades of faces, lines through vertices and mid-edge nodes."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.draw.canvas import LETTERS
from kshell.draw.marks import USUAL
from kshell.mesh import Mesh

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]

MANY_FACES = 5_000
BAR, SQUARE = 1.0, 6.6  # inches for a bar of colours, and of the axes
LIGHT = np.array([0.3, -0.5, 0.8]) / np.linalg.norm([0.3, -0.5, 0.8])


def figure_in_space(
    title: str, nodes: Floats, below: float = 0.0, view: tuple[float, float] = USUAL
) -> tuple[Figure, Any]:
    """A figure with axes for nodes in space, and some inches below them; places are set as for plan views."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    lines = textwrap.wrap(title, LETTERS) if title else []
    tall = 5.6 + below + 0.22 * len(lines)
    figure = Figure(figsize=(8.0, tall))
    FigureCanvasAgg(figure)
    # the square of the axes, beyond which lines are cut off, is larger than what is drawn in it
    place = ((8.0 - SQUARE) / 16.0, (below + 2.75 - SQUARE / 2) / tall, SQUARE / 8.0, SQUARE / tall)
    axes: Any = figure.add_axes(place, projection="3d", computed_zorder=False)
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    middle, size = 0.5 * (low + high), np.maximum(high - low, 0.15 * (high - low).max())
    for setter, m, s in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), middle, size, strict=True):
        setter(m - 0.52 * s, m + 0.52 * s)
    axes.set_box_aspect(size, zoom=5.5 / SQUARE)
    axes.view_init(elev=view[0], azim=view[1])
    for setter, name in zip((axes.set_xlabel, axes.set_ylabel, axes.set_zlabel), "xyz", strict=True):
        setter(name)
    for axis, part in zip((axes.xaxis, axes.yaxis, axes.zaxis), size / size.max(), strict=True):
        ticks = 5 if part > 0.3 else 1  # more of them would overlap on a short axis
        axis.get_major_locator().set_params(nbins=ticks, min_n_ticks=1)
    if lines:
        axes.set_title("\n".join(lines), y=0.5 + 3.05 / SQUARE)
    return figure, axes


def smoothed(corners: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Triangles cut into four until there are many, so that one colour for each looks smooth: corners, values."""
    both = np.concatenate([corners, values[..., None]], axis=2)
    while 4 * len(both) <= MANY_FACES:
        both = cut_in_four(both)
    return both[..., :3], both[..., 3].mean(axis=1)


def cut_in_four(corners: Floats) -> Floats:
    """Triangles (n, 3, k), each cut into four."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, bc, ca = 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([np.stack(part, axis=1) for part in parts])


def shade(corners: Floats) -> Floats:
    """Brightness (triangle,) of both sides under a light from above."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    return 0.72 + 0.28 * np.abs(normal @ LIGHT) / np.where(length > 0, length, 1.0)


def lines_in_space(mesh: Mesh, nodes: Floats, edges: NDArray[np.integer]) -> Floats:
    """(edge, 2 or 3, 3) polylines through vertices and mid-edge nodes."""
    ends = nodes[mesh.edges[edges]]
    if mesh.midpoints is None:
        return ends
    return np.stack([ends[:, 0], nodes[len(mesh.points) + edges], ends[:, 1]], axis=1)
