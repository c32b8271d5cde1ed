"""Still pictures of surfaces in 3D with matplotlib: fields on the deformed shape, supports and loads of a scene."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.draw.canvas import FEW_TRIANGLES, LETTERS, add_below, colour_bar, colours, flat_triangles
from kshell.draw.hidden import Depths
from kshell.draw.in_time import largest_values, pressed
from kshell.draw.marks import USUAL, draw_marks, marks, seeing
from kshell.draw.scene_plot import ASIDE, PATCH_SIGNS, SUPPORT_COLOURS, load_colour, material_axes, on_mesh
from kshell.material.by_group import ELSE
from kshell.mesh import Mesh, Selection, select
from kshell.result.vtu import at_nodes
from kshell.scene.loads import Load
from kshell.scene.placed_pressures import Patch
from kshell.scene.places import on_words
from kshell.scene.supports import Support
from kshell.shell.frames import plane_tangents, tangent_frame

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kshell.result.result import Result
    from kshell.result.rows import Rows
    from kshell.scene.scene import Scene

Floats = NDArray[np.float64]

LARGEST_SHOWN = 0.1  # of the size of the shell: the largest displacement as drawn
SIGNS = 12  # about this many arrows of one load
MANY_FACES = 5_000
DASH = 3  # pieces of lines that make a dash
BAR, SQUARE = 1.0, 6.6  # inches for a bar of colours, and of the axes
LIGHT = np.array([0.3, -0.5, 0.8]) / np.linalg.norm([0.3, -0.5, 0.8])


def drawn_scale(result: Result) -> float:
    """A round number by which displacements are drawn, so that the largest is seen but small."""
    return round_scale(float(np.linalg.norm(result.fields["displacement"], axis=1).max()), result)


def round_scale(largest: float, result: Result) -> float:
    """The same for the largest of several states."""
    if largest == 0.0:
        return 1.0
    exact = LARGEST_SHOWN * result.mesh.size / largest
    power = 10.0 ** np.floor(np.log10(exact))
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step * power <= exact * (1 + 1e-9)))


def deformed_nodes(result: Result, scale: float) -> tuple[Floats, Floats]:
    """Nodes (n, 3) of the rows of the fields, at rest and displaced by `scale` times the displacement."""
    rest = result.rows.nodes
    u = at_nodes(
        result.rows, "displacement", result.fields["displacement"], result.fields, result.edge_fields
    )
    return rest, rest + scale * u


def nodes_of_mesh(rows: Rows, values: Floats) -> Floats:
    """Values at the vertices of the mesh, then at its mid-edge nodes, of those at the nodes of rows."""
    mesh, count = rows.mesh, len(rows.vertex)
    if mesh.midpoints is None:
        return values[: len(mesh.points)]
    first = np.zeros(len(mesh.edges), dtype=np.int64)
    first[rows.middle_edge] = count + np.arange(len(rows.middle_edge))
    return np.concatenate([values[: len(mesh.points)], values[first]])


def surface_figure(result: Result, values: Floats, label: str) -> Figure:
    """A field in colours on the deformed surface, with the outline at rest.

    Parameters
    ----------
    values : (node,)
        At the nodes of the rows of the fields.
    label : str
    """
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    mesh, scale = result.mesh, drawn_scale(result)
    rest, nodes = deformed_nodes(result, scale)
    still, shown = (nodes_of_mesh(result.rows, places) for places in (rest, nodes))
    _, triangles = flat_triangles(mesh, result.rows)
    low, high = float(values.min()), float(values.max())
    style = colours(low, high)
    norm = Normalize(style["vmin"], style["vmax"] if style["vmax"] > style["vmin"] else style["vmin"] + 1.0)
    image = ScalarMappable(norm, colormaps[style["cmap"]])
    found = marks(values, result.rows)
    view = seeing(nodes, triangles, found[0].node) if found else USUAL
    figure, axes = _figure(result.title, np.concatenate([rest, nodes]), BAR, view)
    corners, shades = _smoothed(nodes[triangles], values[triangles])
    faces = image.to_rgba(shades)
    faces[:, :3] *= _shade(corners)[:, None]
    axes.add_collection3d(
        Poly3DCollection(corners, facecolors=faces, edgecolors=faces, linewidths=0.2, rasterized=True)
    )
    depths = Depths(axes, nodes[triangles])
    if len(mesh.triangles) <= FEW_TRIANGLES:
        lines = depths.visible(_edge_lines(mesh, shown, np.arange(len(mesh.edges))))
        axes.add_collection3d(Line3DCollection(lines, colors="black", linewidths=0.25, alpha=0.35))
    outline = np.flatnonzero(mesh.edge_counts != 2)
    if len(outline):
        lines = depths.visible(_edge_lines(mesh, shown, outline))
        axes.add_collection3d(Line3DCollection(lines, colors="black", linewidths=1.0))
        pieces = depths.visible(_edge_lines(mesh, still, outline))
        dashes = pieces[np.arange(len(pieces)) % (2 * DASH) < DASH]
        axes.add_collection3d(Line3DCollection(dashes, colors="0.5", linewidths=0.8))
    draw_marks(axes, found, nodes)
    words = f"{label}, from {low:.4g} to {high:.4g}\ndisplacements drawn {scale:g} times as large, dashed: at rest"
    tall = figure.get_figheight()
    bar = figure.add_axes((0.1, 0.72 / tall, 0.8, 0.17 / tall))
    colour_bar(figure, bar, image, words, "bottom")
    return figure


def plot_surface_scene(mesh: Mesh, scene: Scene | None, title: str = "") -> Figure:
    """A mesh in space with supports and loads, as `kshell.draw.scene_plot.plot_scene` draws flat ones.

    Parameters
    ----------
    mesh : Mesh
        In space.
    scene : Scene or None
        None draws the mesh alone.
    title : str
    """
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    nodes, triangles = flat_triangles(mesh)
    figure, axes = _figure(title, nodes)
    corners = nodes[triangles]
    grey = np.repeat((0.92 * _shade(corners))[:, None], 3, axis=1)
    axes.add_collection3d(
        Poly3DCollection(corners, facecolors=grey, edgecolors=grey, linewidths=0.2, rasterized=True)
    )
    thin = float(np.clip(40.0 / np.sqrt(len(mesh.triangles)), 0.1, 0.6))
    depths = Depths(axes, corners)
    every = depths.visible(_edge_lines(mesh, nodes, np.arange(len(mesh.edges))))
    axes.add_collection3d(Line3DCollection(every, colors="#9aa3ad", linewidths=thin))
    outline = np.flatnonzero(mesh.edge_counts != 2)
    if len(outline):
        lines = depths.visible(_edge_lines(mesh, nodes, outline))
        axes.add_collection3d(Line3DCollection(lines, colors="black", linewidths=1.0))
    if scene is not None:
        for support in on_mesh(scene.supports, scene):
            _draw_support(axes, mesh, nodes, support)
        for number, load in enumerate(on_mesh(scene.loads, scene)):
            _draw_load(axes, mesh, nodes, load, scene.solve.time, number)
        _draw_material_axes(axes, mesh, scene)
        for name, point in scene.probes.items():
            axes.plot(*np.array(point)[:, None], marker="+", color="black", markersize=9, linestyle="")
            axes.text(*point, f"  {name}", fontsize=9)
    signs = len(axes.get_legend_handles_labels()[0])
    if signs:
        add_below(figure, 0.22 * signs + 0.1)
        figure.legend(loc="lower center", ncols=1, fontsize=9, frameon=False, borderpad=0.0)
    return figure


def _figure(
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


def _smoothed(corners: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Triangles cut into four until there are many, so that one colour for each looks smooth: corners, values."""
    while 4 * len(corners) <= MANY_FACES:
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        ab, bc, ca = 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)
        parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        corners = np.concatenate([np.stack(part, axis=1) for part in parts])
        u, v, w = values.T
        uv, vw, wu = 0.5 * (u + v), 0.5 * (v + w), 0.5 * (w + u)
        values = np.concatenate(
            [np.stack(part, axis=1) for part in ((u, uv, wu), (uv, v, vw), (wu, vw, w), (uv, vw, wu))]
        )
    return corners, values.mean(axis=1)


def _shade(corners: Floats) -> Floats:
    """Brightness (triangle,) of both sides under a light from above."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    return 0.72 + 0.28 * np.abs(normal @ LIGHT) / np.where(length > 0, length, 1.0)


def _edge_lines(mesh: Mesh, nodes: Floats, edges: NDArray[np.integer]) -> Floats:
    """(edge, 2 or 3, 3) polylines through vertices and mid-edge nodes."""
    ends = nodes[mesh.edges[edges]]
    if mesh.midpoints is None:
        return ends
    return np.stack([ends[:, 0], nodes[len(mesh.points) + edges], ends[:, 1]], axis=1)


def _draw_support(axes: Any, mesh: Mesh, nodes: Floats, support: Support) -> None:
    colour = SUPPORT_COLOURS[support.kind]
    label = f"{support.kind.replace('_', ' ')} {on_words(support.on)}"
    if support.kind in ("fixed", "elastic"):
        label += f" ({support.freedoms})"
    _mark(axes, mesh, nodes, select(mesh, support.on, what=str(support)), colour, label)


def _mark(axes: Any, mesh: Mesh, nodes: Floats, chosen: Selection, colour: str, label: str) -> None:
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    if chosen.dimension == 0:
        axes.plot(
            *mesh.points[chosen.members].T,
            marker="^",
            color=colour,
            markersize=8,
            linestyle="",
            label=label,
            zorder=6,
        )
    elif chosen.dimension == 1:
        lines = _edge_lines(mesh, nodes, chosen.members)
        axes.add_collection3d(Line3DCollection(lines, colors=colour, linewidths=3.0, zorder=5))
        axes.plot([], [], [], color=colour, linewidth=3, label=label)
    else:
        corners = mesh.points[mesh.triangles[chosen.members]]
        axes.add_collection3d(Poly3DCollection(corners, facecolors=colour, alpha=0.25, zorder=4))
        axes.plot([], [], [], marker="s", markersize=10, alpha=0.4, color=colour, linestyle="", label=label)


def _draw_load(axes: Any, mesh: Mesh, nodes: Floats, load: Load, end: float | None, number: int) -> None:
    colour = load_colour(number)
    label = f"{load.kind.replace('_', ' ')} {load.where}: {load.amount}"
    chosen = Selection(2, np.arange(len(mesh.triangles), dtype=np.int32), "everywhere")
    if load.on is not None:
        chosen = select(mesh, load.on, what=str(load))
    if load.kind in ("temperature", "initial_curvature", "edge_moment"):
        _mark(axes, mesh, nodes, chosen, colour, label)
        return
    across = 0
    if isinstance(load, Patch):
        centres = mesh.points[mesh.triangles[chosen.members]].mean(axis=1)
        load, members = pressed(load, centres, chosen.members, end)
        if not len(members):
            axes.plot([], [], [], linestyle="", label=f"{label} (presses on nothing)")
            return
        chosen, across, number = Selection(2, members, chosen.label), PATCH_SIGNS, 0
    points, normals = _places(mesh, nodes, chosen, across)
    values = largest_values(load, np.hstack([points, normals]) if load.needs_normal else points, end)
    vector = values if values.ndim == 2 else values[:, None] * normals
    most = np.linalg.norm(vector, axis=1).max()
    if most == 0.0:
        axes.plot([], [], [], linestyle="", label=f"{label} (zero)")
        return
    arrow = 0.12 * mesh.size * vector / most
    if chosen.dimension == 2:
        points = points + np.array([ASIDE * mesh.size * number, 0.0, 0.0])
    heads = (1.0, 0.75) if load.kind == "point_moment" else (1.0,)
    for reach in heads:  # a moment has two heads
        axes.quiver(
            *points.T, *(reach * arrow).T, color=colour, linewidths=1.4, arrow_length_ratio=0.3, zorder=7
        )
    axes.plot([], [], [], color=colour, marker=">", label=label)


def _places(mesh: Mesh, nodes: Floats, chosen: Selection, across: int = 0) -> tuple[Floats, Floats]:
    """(n, 3) places for arrows, spread evenly, and unit normals of the surface there; see `scene_plot`."""
    if chosen.dimension == 0:
        points = mesh.points[chosen.members]
        return points, np.zeros_like(points)
    if chosen.dimension == 1:
        every = max(1, len(chosen.members) // SIGNS)
        lines = _edge_lines(mesh, nodes, chosen.members[::every])
        points = lines[:, 1] if lines.shape[1] == 3 else lines.mean(axis=1)
        return points, np.zeros_like(points)
    corners = mesh.points[mesh.triangles[chosen.members]]
    centres = corners.mean(axis=1)
    # the triangles nearest to the middles of the boxes of a grid
    cell = mesh.size / 7
    if across:
        cell = max(float(np.ptp(corners.reshape(-1, 3), axis=0).max()) / across, cell / 3)
    boxes = np.floor((centres - mesh.points.min(axis=0)) / cell).astype(np.int64)
    middle = mesh.points.min(axis=0) + (boxes + 0.5) * cell
    order = np.argsort(np.linalg.norm(centres - middle, axis=1), kind="stable")
    _, first = np.unique(boxes[order], axis=0, return_index=True)
    some = order[first]
    normal = np.cross(corners[some, 1] - corners[some, 0], corners[some, 2] - corners[some, 0])
    return centres[some], normal / np.linalg.norm(normal, axis=1, keepdims=True)


def _direction_for_all(scene: Scene) -> Any:
    """The direction material angles count from, where there is one for all."""
    given = scene.direction.get(ELSE) if isinstance(scene.direction, Mapping) else scene.direction
    return None if given is None else np.array(given)


def _draw_material_axes(axes: Any, mesh: Mesh, scene: Scene) -> None:
    """Axis 1 of every direction-dependent material, as lines on the surface."""
    every = Selection(2, np.arange(len(mesh.triangles), dtype=np.int32), "everywhere")
    points, normals = _places(mesh, mesh.points, every)
    tangents = np.stack(plane_tangents(normals.T))
    e1, e2, _ = tangent_frame(tangents, _direction_for_all(scene))
    for label, angle, style in material_axes(scene):
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        half = 0.03 * mesh.size * (c * e1 + s * e2).T
        for start, end in zip(points - half, points + half, strict=True):
            axes.plot(*np.stack([start, end]).T, color="#e67e22", linewidth=2.0, linestyle=style, zorder=6)
        axes.plot([], [], [], color="#e67e22", linewidth=2.0, linestyle=style, label=label)
