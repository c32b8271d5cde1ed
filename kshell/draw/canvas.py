"""What pictures share: figures, colours, edges and triangles of a mesh as matplotlib draws them."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.result.rows import Rows

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colorbar import Colorbar
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]

# up to this many triangles their edges are drawn over a field
FEW_TRIANGLES = 4000
CURVED, STRAIGHT = 8, 1e-9  # pieces of a curved edge; of the size: what is straight
TICKS = 5  # numbers along an axis: laying them out takes half of the time of a picture
# inches: width of a plan view; what numbers and words take left and below, and a bar of colours right or below that
WIDE, LEFT, BELOW, BAR_RIGHT, BAR_BELOW = 7.5, 0.85, 0.6, 1.45, 0.95
LETTERS = 72  # of a line of the title
SENSE: dict[str, Any] = {"right": "vertical", "bottom": "horizontal"}


def colours(low: float, high: float) -> dict[str, Any]:
    """Colour map and limits for values from low to high: white is zero where both signs occur."""
    if low < 0.0 < high and min(-low, high) > 0.02 * max(-low, high):
        most = max(-low, high)
        return {"cmap": "RdBu_r", "vmin": -most, "vmax": most}
    return {"cmap": "viridis_r" if high <= 0.0 or -low > high else "viridis", "vmin": low, "vmax": high}


def new_figure(mesh: Mesh, title: str, bar: Literal["right", "bottom"] | None = None) -> tuple[Figure, Axes]:
    """An empty figure for a plan view of the mesh: equal axes, as wide or high as the mesh asks.

    Places are set here: to find them from the sizes of texts would draw everything twice.

    Parameters
    ----------
    bar : "right" or "bottom", optional
        Where room is left for a bar of colours.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    width, height = np.maximum(np.ptp(mesh.points[:, :2], axis=0), 1e-9 * mesh.size)
    ratio = float(np.clip(height / width, 0.3, 1.6))
    lines = textwrap.wrap(title, LETTERS) if title else []
    right = BAR_RIGHT if bar == "right" else 0.25
    below = BELOW + (BAR_BELOW if bar == "bottom" else 0.0)
    across = WIDE - LEFT - right
    up = across * ratio
    tall = below + up + 0.2 + 0.22 * len(lines)
    figure = Figure(figsize=(WIDE, tall))
    FigureCanvasAgg(figure)
    axes = figure.add_axes((LEFT / WIDE, below / tall, across / WIDE, up / tall))
    axes.set_aspect("equal")
    axes.locator_params(nbins=TICKS)
    axes.set_xlabel("x")
    axes.set_ylabel("y")
    if lines:
        axes.set_title("\n".join(lines), y=1.0)  # where nothing can push it up
    return figure, axes


def add_below(figure: Figure, inches: float) -> None:
    """Make room below everything."""
    wide, tall = figure.get_size_inches()
    figure.set_size_inches(wide, tall + inches)
    for axes in figure.axes:
        left, bottom, across, up = axes.get_position(original=True).bounds
        axes.set_position(
            (left, (bottom * tall + inches) / (tall + inches), across, up * tall / (tall + inches))
        )


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
    """(edge, point, 2) polylines along edges, parabolas through the mid-edge nodes where any lies off its chord."""
    ends = mesh.points[mesh.edges[edges]][:, :, :2]
    if mesh.midpoints is None:
        return ends
    aside = mesh.midpoints[edges, :2] - ends.mean(axis=1)
    if np.abs(aside).max(initial=0.0) <= STRAIGHT * mesh.size:
        return ends
    s = np.linspace(0.0, 1.0, CURVED + 1)[:, None]
    return (1 - s) * ends[:, :1] + s * ends[:, 1:] + 4 * s * (1 - s) * aside[:, None]


def draw_edges(axes: Axes, mesh: Mesh, edges: NDArray[np.integer], **style: Any) -> None:
    """Draw edges of the mesh as lines."""
    draw_lines(axes, edge_lines(mesh, edges), **style)


def draw_lines(axes: Axes, lines: Floats, **style: Any) -> None:
    """Draw polylines (line, point, 2)."""
    from matplotlib.collections import LineCollection

    axes.add_collection(LineCollection([one_line(lines)], **style))


def one_line(lines: Floats) -> Floats:
    """Polylines (line, point, k) as one (n, k) with gaps, which is drawn many times as fast."""
    gaps = np.full((len(lines), 1, lines.shape[2]), np.nan)
    return np.concatenate([lines, gaps], axis=1).reshape(-1, lines.shape[2])


def colour_bar(
    figure: Figure, bar: Axes, image: Any, label: str, where: Literal["right", "bottom"]
) -> Colorbar:
    """Fill axes, see `bar_axes`, with a colour bar with short numbers."""
    from matplotlib.ticker import MaxNLocator, ScalarFormatter

    numbers = ScalarFormatter(useMathText=False)  # parsing mathematics takes longer than the rest of the text
    numbers.set_powerlimits((-3, 4))
    ticks = MaxNLocator(TICKS)
    made = figure.colorbar(image, cax=bar, format=numbers, ticks=ticks, orientation=SENSE[where])
    made.set_label(label)
    return made


def bar_axes(figure: Figure, axes: Axes, where: Literal["right", "bottom"]) -> Axes:
    """Axes for a colour bar in the room that `new_figure` left for it."""
    wide, tall = figure.get_size_inches()
    left, bottom, across, up = axes.get_position(original=True).bounds
    if where == "right":
        place = (left + across + 0.2 / wide, bottom, 0.2 / wide, up)
    else:
        place = (left, bottom - (BELOW + 0.2) / tall, across, 0.17 / tall)
    return figure.add_axes(place)
