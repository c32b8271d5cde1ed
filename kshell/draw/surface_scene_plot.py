"""A mesh in space with supports, loads and material axes, with matplotlib."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.draw.canvas import add_below, flat_triangles
from kshell.draw.hidden import Depths
from kshell.draw.in_time import largest_values, pressed
from kshell.draw.scene_plot import ASIDE, PATCH_SIGNS, SUPPORT_COLOURS, load_colour, material_axes, on_mesh
from kshell.draw.space import figure_in_space, lines_in_space, shade
from kshell.material.by_group import ELSE
from kshell.mesh import Mesh, Selection, select
from kshell.scene.loads import Load
from kshell.scene.placed_pressures import Patch
from kshell.scene.places import on_words
from kshell.scene.supports import Support
from kshell.shell.frames import plane_tangents, tangent_frame

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kshell.scene.scene import Scene

Floats = NDArray[np.float64]

SIGNS = 12  # about this many arrows of one load


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
    figure, axes = figure_in_space(title, nodes)
    corners = nodes[triangles]
    grey = np.repeat((0.92 * shade(corners))[:, None], 3, axis=1)
    axes.add_collection3d(
        Poly3DCollection(corners, facecolors=grey, edgecolors=grey, linewidths=0.2, rasterized=True)
    )
    thin = float(np.clip(40.0 / np.sqrt(len(mesh.triangles)), 0.1, 0.6))
    depths = Depths(axes, corners)
    every = depths.visible(lines_in_space(mesh, nodes, np.arange(len(mesh.edges))))
    axes.add_collection3d(Line3DCollection(every, colors="#9aa3ad", linewidths=thin))
    outline = np.flatnonzero(mesh.edge_counts != 2)
    if len(outline):
        lines = depths.visible(lines_in_space(mesh, nodes, outline))
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
        lines = lines_in_space(mesh, nodes, chosen.members)
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
        lines = lines_in_space(mesh, nodes, chosen.members[::every])
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
