"""Strokes over flat meshes, seen from above, and what the colours of strokes mean."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from kshell.draw.canvas import FEW_TRIANGLES, add_below, draw_lines, new_figure, one_line
from kshell.draw.drawn import Drawn
from kshell.draw.strokes import Strokes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GREY = "#eef0f2"
WIDTH = 1.5
BELOW = 0.5  # inches for words


def crosses_figure(drawn: Drawn, label: str, strokes: Sequence[Strokes]) -> Figure:
    """Strokes over a flat mesh, with what their colours mean below."""
    from matplotlib.collections import PolyCollection

    mesh = drawn.result.mesh
    figure, axes = new_figure(mesh, drawn.result.title)
    places = drawn.rest[:, :2]
    faces = PolyCollection(places[drawn.triangles], facecolor=GREY, edgecolor=GREY, rasterized=True)
    axes.add_collection(faces)
    if len(mesh.triangles) <= FEW_TRIANGLES:
        draw_lines(axes, places[drawn.lines], colors="black", linewidths=0.2, alpha=0.2)
    draw_lines(axes, places[drawn.lines[mesh.boundary_edges]], colors="black", linewidths=0.9)
    axes.autoscale_view()
    for each in strokes:
        draw_strokes(axes, each, WIDTH)
    name_strokes(figure, words_for(label, strokes), strokes)
    return figure


def draw_strokes(axes: Any, strokes: Strokes, width: float, halo: bool = False) -> Any:
    """Draw strokes in a plan view, over colours with a halo; what was drawn."""
    from matplotlib.collections import LineCollection
    from matplotlib.patheffects import withStroke

    lines = [one_line(strokes.lines[:, :, :2])]
    drawn = LineCollection(lines, colors=strokes.colour, linewidths=width, capstyle="round", zorder=7)
    if halo:
        drawn.set_path_effects([withStroke(linewidth=width + 1.4, foreground="white", alpha=0.7)])
    return axes.add_collection(drawn, autolim=False)


def name_strokes(figure: Figure, label: str, strokes: Sequence[Strokes]) -> None:
    """Words below everything: what is drawn, and what the colours mean."""
    from matplotlib.lines import Line2D

    add_below(figure, BELOW)
    handles = [Line2D([], [], color=each.colour, linewidth=2.0, label=each.words) for each in strokes]
    figure.legend(
        handles=handles,
        loc="lower center",
        ncols=max(len(handles), 1),
        fontsize=9,
        frameon=False,
        borderpad=0.2,
        title=label,
        title_fontsize=9,
    )


def words_for(label: str, strokes: Sequence[Strokes]) -> str:
    """A label with what the longest stroke stands for."""
    return f"{label}; longest stroke: {strokes[0].longest}" if strokes else label
