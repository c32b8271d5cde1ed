"""Still pictures of fields on deformed surfaces in 3D with matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kshell.draw.canvas import FEW_TRIANGLES, colour_bar, colours, flat_triangles
from kshell.draw.drawn import Drawn
from kshell.draw.hidden import Depths
from kshell.draw.marks import USUAL, draw_marks, marks, seeing
from kshell.draw.pictures import PRINCIPAL, picture_values, principal_label
from kshell.draw.shape import deformed_nodes, drawn_scale
from kshell.draw.space import BAR, figure_in_space, shade, smoothed
from kshell.draw.strokes import Strokes, longest
from kshell.draw.strokes_plot import name_strokes, words_for

if TYPE_CHECKING:
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]

STROKE = 1.3  # points
GREY = 0.93
DASH = 3  # pieces of lines that make a dash


def surface_figure(drawn: Drawn, what: str, strokes: Sequence[Strokes] = ()) -> Figure:
    """A field in colours on the deformed surface, or strokes, or both, with the outline at rest.

    Parameters
    ----------
    drawn : Drawn
    what : str
        Name of the picture; under crosses the surface is grey.
    strokes : sequence of Strokes
    """
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    result, triangles = drawn.result, drawn.triangles
    mesh, scale = result.mesh, drawn_scale(result)
    rest, nodes = drawn.rest, drawn.deformed(scale)
    values = None
    if what in PRINCIPAL:
        label = principal_label(result, what)
    else:
        values, label = picture_values(result, what)
    found = [] if values is None else marks(values, result.rows)
    marked = deformed_nodes(result, scale)[1]
    seen = found[0].node if found else longest(strokes, marked)
    flat = flat_triangles(mesh, result.rows)[1]
    view = USUAL if seen is None else seeing(marked, flat, seen)
    figure, axes = figure_in_space(result.title, np.concatenate([rest, nodes]), BAR, view)
    corners, shades = smoothed(
        nodes[triangles], np.zeros(triangles.shape) if values is None else drawn.values(what)[triangles]
    )
    image = None if values is None else _coloured(values)
    faces = np.full((len(corners), 4), GREY) if image is None else image.to_rgba(shades)
    faces[:, :3] *= shade(corners)[:, None]
    faces[:, 3] = 1.0
    axes.add_collection3d(
        Poly3DCollection(corners, facecolors=faces, edgecolors=faces, linewidths=0.2, rasterized=True)
    )
    depths = Depths(axes, nodes[triangles])
    if len(mesh.triangles) <= FEW_TRIANGLES:
        lines = depths.visible(nodes[drawn.lines])
        axes.add_collection3d(Line3DCollection(lines, colors="black", linewidths=0.25, alpha=0.35))
    outline = np.flatnonzero(mesh.edge_counts != 2)
    if len(outline):
        lines = depths.visible(nodes[drawn.lines[outline]])
        axes.add_collection3d(Line3DCollection(lines, colors="black", linewidths=1.0))
        pieces = depths.visible(rest[drawn.lines[outline]])
        dashes = pieces[np.arange(len(pieces)) % (2 * DASH) < DASH]
        axes.add_collection3d(Line3DCollection(dashes, colors="0.5", linewidths=0.8))
    for each in strokes:
        lines = depths.visible(each.lines)
        if values is not None:  # over dark colours, too
            halo = Line3DCollection(lines, colors="white", linewidths=STROKE + 1.0, alpha=0.6, zorder=8)
            axes.add_collection3d(halo)
        axes.add_collection3d(Line3DCollection(lines, colors=each.colour, linewidths=STROKE, zorder=8))
    draw_marks(axes, found, marked)
    moved = f"displacements drawn {scale:g} times as large, dashed: at rest"
    if values is None or image is None:
        name_strokes(figure, f"{words_for(label, strokes)}\n{moved}", strokes)
        return figure
    words = f"{label}, from {values.min():.4g} to {values.max():.4g}\n{moved}"
    tall = figure.get_figheight()
    bar = figure.add_axes((0.1, 0.72 / tall, 0.8, 0.17 / tall))
    colour_bar(figure, bar, image, words, "bottom")
    return figure


def _coloured(values: Floats) -> ScalarMappable:
    """From values to colours."""
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    style = colours(float(values.min()), float(values.max()))
    norm = Normalize(style["vmin"], style["vmax"] if style["vmax"] > style["vmin"] else style["vmin"] + 1.0)
    return ScalarMappable(norm, colormaps[style["cmap"]])
