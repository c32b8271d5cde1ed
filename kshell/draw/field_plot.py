"""A field over a flat mesh, seen from above."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from kshell.draw.canvas import (
    FEW_TRIANGLES,
    bar_axes,
    colour_bar,
    colours,
    draw_lines,
    new_figure,
)
from kshell.draw.drawn import Drawn
from kshell.draw.marks import draw_marks, marks
from kshell.draw.pictures import picture_values
from kshell.draw.strokes import Strokes
from kshell.draw.strokes_plot import draw_strokes
from kshell.result.result import Result

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class FieldFigure:
    """A field in colours with lines of equal value; other fields of the result can be shown in the same figure.

    Parameters
    ----------
    result : Result
        With a flat mesh.
    """

    def __init__(self, result: Result) -> None:
        from matplotlib.tri import Triangulation

        mesh = result.mesh
        wide = np.ptp(mesh.points[:, 0]) > 1.3 * np.ptp(mesh.points[:, 1])
        self._where: Literal["right", "bottom"] = "bottom" if wide else "right"
        self.figure, self._axes = new_figure(mesh, result.title, self._where)
        self.drawn = Drawn(result)
        places = self.drawn.rest[:, :2]
        self._triangulation = Triangulation(places[:, 0], places[:, 1], self.drawn.triangles)
        zero = np.zeros(len(places))
        self._image = self._axes.tripcolor(
            self._triangulation, zero, shading="gouraud", rasterized=True, zorder=0
        )
        self._lines: Any = None
        self._bar: Any = None
        self._marks: list[Any] = []
        self._rows, self._nodes = result.rows, result.rows.nodes[:, :2]
        if len(mesh.triangles) <= FEW_TRIANGLES:
            draw_lines(self._axes, places[self.drawn.lines], colors="black", linewidths=0.2, alpha=0.25)
        outline = places[self.drawn.lines[mesh.boundary_edges]]
        draw_lines(self._axes, outline, colors="black", linewidths=0.9)
        self._axes.autoscale_view()

    def show(self, what: str, strokes: Sequence[Strokes] = ()) -> Figure:
        """The figure with a field, and lines over it.

        Parameters
        ----------
        what : str
            Name of the picture.
        strokes : sequence of Strokes
        """
        marked, label = picture_values(self.drawn.result, what)
        values = self.drawn.values(what)
        low, high = float(marked.min()), float(marked.max())
        style = colours(low, high)
        self._image.set_array(values)
        norm: Any = self._image.norm
        with norm.callbacks.blocked():  # the bar is drawn anew for the colours alone, and not for each limit
            norm.vmin, norm.vmax = style["vmin"], style["vmax"]
        self._image.set_cmap(style["cmap"])
        for drawn in self._marks:
            drawn.remove()
        self._marks = draw_marks(self._axes, marks(marked, self._rows), self._nodes)
        self._marks += [draw_strokes(self._axes, each, 0.9, halo=True) for each in strokes]
        if self._lines is not None:
            self._lines.remove()
            self._lines = None
        if high > low:
            self._lines = self._axes.tricontour(
                self._triangulation, values, levels=8, colors="black", linewidths=0.4, alpha=0.5
            )
        words = f"{label}\nfrom {low:.4g} to {high:.4g}"
        if self._bar is None:
            bar = bar_axes(self.figure, self._axes, self._where)
            self._bar = colour_bar(self.figure, bar, self._image, words, self._where)
        else:
            self._bar.set_label(words)
        return self.figure
