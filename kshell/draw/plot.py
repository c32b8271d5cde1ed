"""Pictures of results with matplotlib: fields over a flat mesh seen from above, over a surface in 3D."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import numpy as np
from numpy.typing import NDArray

from kshell.draw.drawn import Drawn
from kshell.draw.field_plot import FieldFigure
from kshell.draw.history_plot import film_figure, history_figure
from kshell.draw.levels_plot import error_figure, levels_figure
from kshell.draw.mode_plot import mode_figure, modes_figure
from kshell.draw.path_plot import path_figure
from kshell.draw.pictures import (
    MODAL,
    PRINCIPAL,
    pictures,
    principal_label,
    usual_pictures,
)
from kshell.draw.png import png
from kshell.draw.reactions_plot import reactions_figure
from kshell.draw.response_plot import response_figure
from kshell.draw.scene_plot import plot_scene
from kshell.draw.shape import drawn_scale
from kshell.draw.stills import drawn_by_pyvista, still
from kshell.draw.strokes import strokes_of
from kshell.draw.strokes_plot import crosses_figure
from kshell.draw.surface_plot import surface_figure
from kshell.draw.surface_scene_plot import plot_surface_scene
from kshell.errors import InputError
from kshell.result.result import Result
from kshell.values.naming import listing, suggestion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# heights closer together than this fraction of the size are a plan view
FLAT = 1e-9
DPI = 150


def plot(result: Result, what: str = "deflection", fields: Callable[[], FieldFigure] | None = None) -> Figure:
    """A picture of a result, see `Result.plot`; fields over flat meshes in a given figure, where there is one."""
    if what == "deflection" and result.analysis in MODAL:
        what = "modes"
    if what == "deflection" and result.response:
        what = "response"
    known = pictures(result)
    if what not in known:
        raise InputError(f'no picture "{what}": {suggestion(what, known)}the pictures are {listing(known)}')
    if what == "load_deflection":
        return path_figure(result)
    if what == "error":
        return error_figure(result)
    if what == "convergence":
        return levels_figure(result)
    if what == "reactions":
        return reactions_figure(result)
    if what == "response":
        return response_figure(result)
    if what == "history":
        return history_figure(result)
    if what == "film":
        return film_figure(result)
    if what == "modes":
        return modes_figure(result)
    if what.startswith("mode_"):
        return mode_figure(result, int(what.removeprefix("mode_")))
    flat = np.ptp(result.mesh.points[:, 2]) <= FLAT * result.mesh.size
    if what == "mesh":
        return (plot_scene if flat else plot_surface_scene)(result.mesh, result.scene, result.title)
    scale = 0.0 if flat else drawn_scale(result)
    if flat and what not in PRINCIPAL:
        figure = FieldFigure(result) if fields is None else fields()
        return figure.show(what, strokes_of(figure.drawn, what, scale))
    drawn = Drawn(result)
    strokes = strokes_of(drawn, what, scale)
    if flat:
        return crosses_figure(drawn, principal_label(result, what), strokes)
    return surface_figure(drawn, what, strokes)


def save_picture(
    result: Result,
    what: str,
    path: Path | BinaryIO,
    dpi: int = DPI,
    small: bool = False,
    fields: Callable[[], FieldFigure] | None = None,
) -> None:
    """Write a picture of a result as PNG, to be small or written fast."""
    if drawn_by_pyvista(result, what):
        image = still(result, what)
        if image is not None:
            _write(image, path, dpi, small)
            return
    save_figure(plot(result, what, fields), path, dpi, small)


def save_figure(figure: Figure, path: Path | BinaryIO, dpi: int = DPI, small: bool = False) -> None:
    """Write a figure as PNG, to be small or written fast."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure.set_dpi(dpi)
    engine = figure.get_layout_engine()
    if engine is not None:  # laid out here, or savefig would draw everything twice
        engine.execute(figure)
        figure.set_layout_engine("none")
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    opaque = np.ascontiguousarray(np.asarray(canvas.buffer_rgba())[..., :3])
    _write(opaque, path, dpi, small)


def _write(image: NDArray[np.uint8], path: Path | BinaryIO, dpi: int, small: bool) -> None:
    data = png(image, dpi, 6 if small else 1)
    if isinstance(path, Path):
        path.write_bytes(data)
    else:
        path.write(data)


def picture_files(result: Result, plots: bool) -> dict[str, Callable[[Path], object]]:
    """The pictures that are saved with a result: file name to function of the path to write.

    Of a path the load over the displacements, of a motion its history, always; all others if asked.
    """
    names = ["load_deflection"] if result.analysis == "path" and result.probes else []
    names += ["history"] if result.history else []
    single = result.analysis in MODAL  # the picture of all modes holds those of each
    names += [
        name
        for name in usual_pictures(result)
        if plots and name not in names and not (single and name.startswith("mode_"))
    ]
    fields = cache(partial(FieldFigure, result))  # to make a figure takes as long as to draw it
    return {f"{name}.png": partial(save_picture, result, name, fields=fields) for name in names}
