"""Results in 3D with PyVista, the extra "view": deformed surfaces with fields, to be turned with the mouse."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from kshell.draw.canvas import FEW_TRIANGLES, colours, flat_triangles
from kshell.draw.marks import USUAL, marks, seeing, towards
from kshell.draw.pictures import picture_values, pictures
from kshell.draw.surface_plot import deformed_nodes, drawn_scale
from kshell.errors import InputError
from kshell.values.naming import listing, suggestion

if TYPE_CHECKING:
    from kshell.result.result import Result

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


def surface_grid(result: Result, scale: float) -> Any:
    """A pyvista.UnstructuredGrid of the deformed surface, with curved triangles where the mesh has them."""
    _, nodes = deformed_nodes(result, scale)
    cells = result.rows.cells
    kind = TRIANGLE if result.mesh.midpoints is None else QUADRATIC_TRIANGLE
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
    values, label = picture_values(result, what)
    grid = surface_grid(result, scale)
    grid.point_data[label] = values
    style = colours(float(values.min()), float(values.max()))
    plotter = module.Plotter(off_screen=off_screen, window_size=(1200, 900))
    surface = grid.extract_surface(nonlinear_subdivision=2, algorithm="dataset_surface")
    plotter.add_mesh(
        surface,
        scalars=label,
        cmap=style["cmap"],
        clim=(style["vmin"], style["vmax"]),
        smooth_shading=True,
        show_edges=result.mesh.midpoints is None and len(result.mesh.triangles) <= FEW_TRIANGLES,
        edge_opacity=0.25,
        ambient=0.5,
        diffuse=0.5,  # with ambient light: no brighter than the colours of the bar, or pale ones would turn white
        scalar_bar_args={
            "title": f"{label}\n",  # a line between it and the numbers
            "title_font_size": 18,
            "label_font_size": 15,
            "position_y": 0.02,
            "height": 0.14,
        },
    )
    outline = surface.extract_feature_edges(manifold_edges=False, feature_angle=30.0)
    if outline.n_points:
        plotter.add_mesh(outline, color="black", line_width=2)
    rest = surface_grid(result, 0.0).extract_surface(nonlinear_subdivision=2, algorithm="dataset_surface")
    plotter.add_mesh(rest.extract_feature_edges(manifold_edges=False), color="grey", line_width=1)
    plotter.add_text(f"{result.title}\ndisplacements {scale:g} times as large", font_size=10)
    nodes = deformed_nodes(result, scale)[1]
    found = marks(values, result.rows)
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
    view = seeing(nodes, triangles, found[0].node) if found else USUAL
    plotter.show_axes()
    plotter.view_vector(towards(*view), viewup=(0.0, 0.0, 1.0))
    plotter.camera.zoom(0.95)
    # the surface above the middle: its bar of colours is below, with a title that no mark may cover
    plotter.camera.SetWindowCenter(0.0, -ABOVE)
    return plotter
