"""How a result was refined: the mesh coloured by its error, the half width over the unknowns; studies."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from kshell.draw.canvas import bar_axes, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from kshell.analysis.converge import Convergence
    from kshell.result.result import Result

DECADES = 6  # of the error that colours tell apart


def error_figure(result: Result) -> Figure:
    """The last mesh, each triangle in the colour of what it adds to the error."""
    from matplotlib.colors import LogNorm

    mesh = result.mesh
    error = np.asarray(result.cell_fields["error"], dtype=float)
    error = error / max(float(error.max()), 1e-300)
    norm = LogNorm(10.0**-DECADES, 1.0)
    label = "what the triangle adds to the error, relative to the largest"
    values = np.maximum(error, 10.0**-DECADES)
    if np.ptp(mesh.points[:, 2]) <= 1e-9 * mesh.size:
        from matplotlib.tri import Triangulation

        figure, axes = new_figure(mesh, result.title, "right")
        image: Any = axes.tripcolor(
            Triangulation(mesh.points[:, 0], mesh.points[:, 1], mesh.triangles),
            facecolors=values,
            norm=norm,
            edgecolors="black",
            linewidth=0.15,
        )
        figure.colorbar(image, cax=bar_axes(figure, axes, "right"), label=label)
    else:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.cm import ScalarMappable
        from matplotlib.figure import Figure
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection

        figure = Figure(figsize=(7.5, 6.5), layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.add_subplot(projection="3d")
        image = ScalarMappable(norm, "viridis")
        faces = Poly3DCollection(
            list(mesh.points[mesh.triangles]),
            facecolors=image.to_rgba(values),
            edgecolors="black",
            linewidths=0.15,
        )
        axes.add_collection(faces)
        low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
        for set_limits, a, b in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), low, high, strict=True):
            set_limits(a, b if b > a else a + mesh.size)
        axes.set_box_aspect(np.maximum(high - low, 0.05 * mesh.size))
        if result.title:
            axes.set_title(result.title, wrap=True)
        figure.colorbar(image, ax=axes, label=label, shrink=0.8)
    return figure


def levels_figure(result: Result) -> Figure:
    """The relative half width over the unknowns, level by level, and the rate between the first and the last."""
    figure, axes = _log_axes(result.title)
    levels = [level for level in result.error["levels"] if level["half_width"]]
    unknowns = np.array([level["unknowns"] for level in levels], dtype=float)
    width = np.array([level["half_width"] for level in levels])
    label = f"half width ({result.error['kind']})"
    if len(levels) > 1 and unknowns[-1] > unknowns[0]:
        rate = np.log(width[-1] / width[0]) / np.log(unknowns[-1] / unknowns[0])
        label += f", about N^{rate:.1f}"
    axes.loglog(unknowns, width, "o-", label=label)
    axes.set_ylabel("relative half width")
    axes.legend(fontsize=9)
    return figure


def study_figure(study: Convergence) -> Figure:
    """Differences to the value of Richardson, or to the last where there is none, over the unknowns."""
    figure, axes = _log_axes(study.title)
    for series in study.series:
        for name, values in series.values.items():
            limit = series.limit(name)
            end = values[-1] if limit is None else limit
            off = np.abs(np.array(values) - end) / max(abs(end), 1e-300)
            shown = off > 0.0
            if shown.any():
                axes.loglog(
                    np.array(series.unknowns)[shown],
                    off[shown],
                    "o-",
                    label=f"{series.element} {series.order}: {name}",
                )
    axes.set_ylabel("relative difference to the value of Richardson")
    if axes.get_legend_handles_labels()[1]:
        axes.legend(fontsize=8)
    return figure


def _log_axes(title: str) -> tuple[Figure, Axes]:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.5, 5.5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    axes.set_xlabel("unknowns N")
    axes.grid(True, which="both", linewidth=0.3)
    if title:
        axes.set_title(title, wrap=True)
    return figure, axes
