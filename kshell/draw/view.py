"""Results in 3D with PyVista, the extra "view": deformed surfaces with fields, to be turned with the mouse."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.draw.canvas import FEW_TRIANGLES, colours, flat_triangles
from kshell.draw.drawn import Drawn
from kshell.draw.marks import USUAL, Mark, marks, seeing, towards
from kshell.draw.pictures import PRINCIPAL, picture_values, pictures, principal_label
from kshell.draw.shape import deformed_nodes, drawn_scale
from kshell.draw.strokes import Strokes, longest, strokes_of
from kshell.draw.strokes_plot import words_for
from kshell.errors import InputError
from kshell.values.naming import listing, suggestion

if TYPE_CHECKING:
    from kshell.result.result import Result

Floats = NDArray[np.float64]

RAISED = 0.004  # of the size: strokes above the surface on both sides, which hides what lies in it
NEARER = -40.0  # smallest steps of depth by which edges are drawn in front of the surface
MARGIN = 0.04  # of the height of the picture
LETTER = 0.0075  # of the width of the picture
ABOVE = 0.16  # of half the height of the picture, by which the surface stands above its middle
QUADRATIC_TRIANGLE, TRIANGLE = 22, 5  # numbers of the cells of VTK


def pyvista() -> Any:
    """The module PyVista.

    Raises
    ------
    InputError
        If it is not installed.
    """
    try:
        import pyvista as module
    except ImportError as error:
        raise InputError(
            f"3D views need PyVista ({error}): install it with `pip install kshell[view]`, or use result.plot(...) for "
            "a still picture"
        ) from None
    return module


def surface_grid(drawn: Drawn, scale: float) -> Any:
    """A pyvista.UnstructuredGrid of the deformed surface; triangles that are not divided are curved as the mesh's."""
    nodes, cells = drawn.deformed(scale), drawn.triangles
    if drawn.parts == 1:
        cells = drawn.result.rows.cells
    kind = TRIANGLE if cells.shape[1] == 3 else QUADRATIC_TRIANGLE
    count = cells.shape[1]
    listed = np.concatenate([np.full((len(cells), 1), count), cells], axis=1).ravel()
    return pyvista().UnstructuredGrid(listed, np.full(len(cells), kind, dtype=np.uint8), nodes)


def show(result: Result, what: str, scale: float | None, file: str | None) -> Any:
    """See `Result.show`."""
    plotter = view_of(result, what, scale, file is not None)
    if file is not None:
        plotter.screenshot(str(file))
    else:
        plotter.show(auto_close=False)
    return plotter


def view_of(result: Result, what: str, scale: float | None, off_screen: bool) -> Any:
    """The plotter of a view, not yet shown.

    Raises
    ------
    InputError
        If there is no such view, or PyVista is not installed.
    """
    known = [name for name in pictures(result) if name != "mesh"]
    if what not in known:
        raise InputError(f'no view "{what}": {suggestion(what, known)}the views are {listing(known)}')
    if scale is None:
        scale = drawn_scale(result)
    module = pyvista()
    drawn = Drawn(result)
    grid = surface_grid(drawn, scale)
    strokes = strokes_of(drawn, what, scale)
    found: list[Mark] = []
    plotter = module.Plotter(off_screen=off_screen, window_size=(1200, 900))
    style: dict[str, Any] = {"color": "#e4e6e9"}
    if what not in PRINCIPAL:
        values, label = picture_values(result, what)
        grid.point_data[label] = drawn.values(what)
        found = marks(values, result.rows)
        style = _coloured(values, label)
    surface = grid.extract_surface(nonlinear_subdivision=2, algorithm="dataset_surface")
    plotter.add_mesh(
        surface,
        smooth_shading=True,
        ambient=0.5,
        diffuse=0.5,  # with ambient light: no brighter than the colours of the bar, or pale ones would turn white
        **style,
    )
    if len(result.mesh.triangles) <= FEW_TRIANGLES:
        edges = _polylines(drawn.deformed(scale)[drawn.lines])
        lines = plotter.add_mesh(edges, color="black", opacity=0.25, line_width=1)
        lines.mapper.resolve = "polygon_offset"  # in front of the surface that they lie in
        lines.mapper.SetRelativeCoincidentTopologyLineOffsetParameters(-2.0, NEARER)
    for each in strokes:
        if len(each.lines):
            raised = RAISED * result.mesh.size
            if what not in PRINCIPAL:  # over dark colours, too
                plotter.add_mesh(_lines(each, 0.5 * raised), color="white", line_width=6, opacity=0.6)
            plotter.add_mesh(_lines(each, raised), color=each.colour, line_width=3)
    if what in PRINCIPAL:
        _name(plotter, words_for(principal_label(result, what), strokes), strokes)
    outline = surface.extract_feature_edges(manifold_edges=False, feature_angle=30.0)
    if outline.n_points:
        plotter.add_mesh(outline, color="black", line_width=2)
    rest = surface_grid(drawn, 0.0).extract_surface(nonlinear_subdivision=2, algorithm="dataset_surface")
    plotter.add_mesh(rest.extract_feature_edges(manifold_edges=False), color="grey", line_width=1)
    plotter.add_text(f"{result.title}\ndisplacements {scale:g} times as large", font_size=10)
    nodes = deformed_nodes(result, scale)[1]
    for mark in found:
        plotter.add_point_labels(
            nodes[[mark.node]],
            [f"{mark.kind} {mark.words}"],
            font_size=16,
            point_size=12,
            point_color="black",
            shape_color="white",
            shape_opacity=0.75,
            render_points_as_spheres=True,
            always_visible=True,
        )
    triangles = flat_triangles(result.mesh, result.rows)[1]
    seen = found[0].node if found else longest(strokes, nodes)
    view = USUAL if seen is None else seeing(nodes, triangles, seen)
    plotter.show_axes()
    plotter.view_vector(towards(*view), viewup=(0.0, 0.0, 1.0))
    plotter.camera.zoom(min(0.95, (1.0 - ABOVE - MARGIN) / _height(plotter.bounds, view)))
    # the surface above the middle: its bar of colours is below, with a title that no mark may cover
    plotter.camera.SetWindowCenter(0.0, -ABOVE)
    return plotter


def _height(bounds: Sequence[float], view: tuple[float, float]) -> float:
    """How high a box looks, over its diagonal, to which cameras are set: upright things fill the picture."""
    size = np.ptp(np.reshape(bounds, (3, 2)), axis=1)
    eye = towards(*view)
    up = np.array([0.0, 0.0, 1.0]) - eye[2] * eye
    return float(np.abs(up / np.linalg.norm(up)) @ size / np.linalg.norm(size))


def _coloured(values: Floats, label: str) -> dict[str, Any]:
    """How a surface shows a field in colours, with their bar."""
    style = colours(float(values.min()), float(values.max()))
    return {
        "scalars": label,
        "cmap": style["cmap"],
        "clim": (style["vmin"], style["vmax"]),
        "scalar_bar_args": {
            "title": f"{label}\n",  # a line between it and the numbers
            "title_font_size": 18,
            "label_font_size": 15,
            "position_y": 0.02,
            "height": 0.14,
        },
    }


def _lines(strokes: Strokes, raised: float) -> Any:
    """A pyvista.PolyData of strokes on both sides of the surface."""
    up = raised * strokes.normals[:, None]
    lines = np.concatenate([strokes.lines + up, strokes.lines - up])
    return _polylines(lines)


def _polylines(lines: Floats) -> Any:
    """A pyvista.PolyData of polylines (line, point, 3)."""
    count = lines.shape[1]
    number = np.arange(lines.shape[0] * count).reshape(-1, count)
    cells = np.concatenate([np.full((len(lines), 1), count), number], axis=1).ravel()
    return pyvista().PolyData(lines.reshape(-1, 3), lines=cells)


def _name(plotter: Any, label: str, strokes: Sequence[Strokes]) -> None:
    """Words for strokes, below: what they are, and each colour."""
    lines = label.split("; ")
    left = 0.5 - 0.5 * LETTER * max(map(len, lines))
    plotter.add_text("\n".join(lines), position=(left, 0.065), viewport=True, font_size=9)
    for number, each in enumerate(strokes):
        at = (0.5 + 0.24 * (number - 0.5 * len(strokes)), 0.02)
        plotter.add_text(f"-- {each.words}", position=at, viewport=True, font_size=9, color=each.colour)
