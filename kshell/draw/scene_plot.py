"""The mesh seen from above, with supports and loads drawn where they act.

Forces along z are circles, with a dot toward the viewer (+z) and with a cross away from the viewer (-z);
forces in the plane are arrows. The legend says what each sign means.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.draw.canvas import add_below, draw_edges, new_figure
from kshell.draw.in_time import largest_values, pressed
from kshell.draw.signs import away, toward
from kshell.mesh import Mesh, Selection, select
from kshell.mesh.check import is_flat
from kshell.mesh.facing import top_words
from kshell.scene.loads import Load
from kshell.scene.normals import beside
from kshell.scene.placed_pressures import Patch
from kshell.scene.places import on_words
from kshell.scene.sections import each
from kshell.scene.supports import RigidLink, Support

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from kshell.scene.scene import Scene

Floats = NDArray[np.float64]

SUPPORT_COLOURS = {
    "clamped": "#1f4e9c",
    "simply_supported": "#1b8a3a",
    "soft_supported": "#58b368",
    "symmetry": "#8e44ad",
    "free": "#7f7f7f",
    "hinge": "#e67e22",
    "rigid_link": "#5d4037",
    "fixed": "#00838f",
    "elastic": "#b8860b",
}
# of the loads, one after the other; none is that of a support
LOAD_COLOURS = ("#c0392b", "#d81b9a", "#ef6c00", "#3b2fd1", "#6d4c00", "#00a3c4")
ASIDE = 0.02  # of the size: symbols of further loads on one surface stand beside those of the first
PATCH_SIGNS = 3  # signs across a disc or a rectangle
SIGNS = 40  # about this many hatch strokes along the diagonal of the plate


def plot_scene(mesh: Mesh, scene: Scene | None, title: str = "") -> Figure:
    """Mesh, supports and loads.

    Parameters
    ----------
    mesh : Mesh
    scene : Scene or None
        None draws the mesh alone.
    title : str
    """
    figure, axes = new_figure(mesh, title)
    every = np.arange(len(mesh.edges))
    thin = float(np.clip(60.0 / np.sqrt(len(mesh.triangles)), 0.15, 0.8))
    draw_edges(axes, mesh, every, colors="#9aa3ad", linewidths=thin)
    draw_edges(axes, mesh, mesh.boundary_edges, colors="black", linewidths=1.0)
    if scene is not None:
        for support in on_mesh(scene.supports, scene):
            _draw_support(axes, mesh, support)
        for number, load in enumerate(on_mesh(scene.loads, scene)):
            _draw_load(axes, mesh, load, scene.solve.time, number)
        _draw_material_axes(axes, mesh, scene)
        if not is_flat(mesh.points):
            for words in top_words(mesh):
                axes.plot([], [], linestyle="", marker="", label=words)
        for number, (name, point) in enumerate(scene.probes.items()):
            axes.plot(*point[:2], marker="+", color="black", markersize=9, markeredgewidth=1.5, linestyle="")
            axes.annotate(
                name, point[:2], xytext=(5, (5, -13)[number % 2]), textcoords="offset points", fontsize=9
            )
    axes.autoscale_view()
    axes.margins(0.12)
    signs = len(axes.get_legend_handles_labels()[0])
    if signs:
        add_below(figure, 0.22 * signs + 0.1)
        figure.legend(loc="lower center", ncols=1, fontsize=9, frameon=False, borderpad=0.0)
    return figure


def on_mesh(items: Iterable[Any], scene: Scene) -> list[Any]:
    """Supports or loads without those on points of rigid links, which lie anywhere."""
    names = {support.name for support in scene.supports if isinstance(support, RigidLink)} - {""}
    return [item for item in items if not (isinstance(item.on, str) and item.on in names)]


def _draw_support(axes: Axes, mesh: Mesh, support: Support) -> None:
    chosen = select(mesh, support.on, what=str(support))
    colour = SUPPORT_COLOURS[support.kind]
    label = f"{support.kind.replace('_', ' ')} {on_words(support.on)}"
    if support.kind in ("fixed", "elastic"):
        label += f" ({support.freedoms})"
    if chosen.dimension == 0:
        marker = "s" if support.kind == "clamped" else "^"
        x = mesh.points[chosen.members, :2]
        axes.plot(*x.T, marker=marker, color=colour, markersize=8, linestyle="", label=label, zorder=5)
    elif chosen.dimension == 1:
        _draw_supported_edges(axes, mesh, chosen, support.kind, colour, label)
    else:
        _tint(axes, mesh, chosen, colour, label)


def _draw_supported_edges(
    axes: Axes, mesh: Mesh, chosen: Selection, kind: str, colour: str, label: str
) -> None:
    draw_edges(axes, mesh, chosen.members, colors=colour, linewidths=3.0, zorder=4)
    point, outward = _along(mesh, chosen.members, SIGNS if kind == "clamped" else SIGNS // 2)
    size = 0.022 * mesh.size
    tangent = np.stack([-outward[:, 1], outward[:, 0]], axis=1)
    if kind == "clamped":  # hatched like a wall
        _segments(axes, point, point + size * (outward + 0.7 * tangent), colour)
        axes.plot([], [], color=colour, linewidth=3, label=label, marker=(2, 0, -45), markersize=10)
    elif kind in ("simply_supported", "soft_supported"):
        corner = [point, point + size * (outward + 0.6 * tangent), point + size * (outward - 0.6 * tangent)]
        _polygons(axes, np.stack(corner, axis=1), colour)
        axes.plot([], [], color=colour, linewidth=3, label=label, marker="^", markersize=7)
    elif kind == "symmetry":  # two short bars across the edge
        for shift in (-0.25 * size, 0.25 * size):
            middle = point + shift * tangent
            _segments(axes, middle - 0.7 * size * outward, middle + 0.7 * size * outward, colour)
        axes.plot([], [], color=colour, linewidth=3, label=label, marker="$=$", markersize=9)
    elif kind == "elastic":  # a spring
        steps = np.array([[0, 0], [0.25, 0.4], [0.5, -0.4], [0.75, 0.4], [1.0, 0]])
        line = point[:, None] + size * (steps[:, :1] * outward[:, None] + steps[:, 1:] * tangent[:, None])
        _segments(axes, line[:, :-1].reshape(-1, 2), line[:, 1:].reshape(-1, 2), colour)
        axes.plot([], [], color=colour, linewidth=3, label=label, marker="$\\wr$", markersize=9)
    else:
        style = ":" if kind == "free" else "-"
        axes.plot([], [], color=colour, linewidth=3, linestyle=style, label=label)


def load_colour(number: int) -> str:
    """Of a load in pictures, by its number."""
    return LOAD_COLOURS[number % len(LOAD_COLOURS)]


def _draw_load(axes: Axes, mesh: Mesh, load: Load, end: float | None, number: int) -> None:
    colour = load_colour(number)
    label = f"{load.kind.replace('_', ' ')} {load.where}: {load.amount}"
    if load.on is None:
        chosen = Selection(2, np.arange(len(mesh.triangles), dtype=np.int32), "everywhere")
    else:
        chosen = select(mesh, load.on, what=str(load))
    if load.kind in ("temperature", "initial_curvature"):
        _tint(axes, mesh, chosen, colour, label)
        return
    if isinstance(load, Patch):
        _draw_patch(axes, mesh, chosen, load, end, label, colour)
        return
    points = _places(mesh, chosen)
    if load.kind == "edge_moment":
        axes.plot(*points.T[:2], marker="D", color=colour, markersize=4, linestyle="", label=label, zorder=6)
        return
    at = beside(mesh, chosen.members, points) if load.needs_normal else points
    values = largest_values(load, at, end)
    vector = values if values.ndim == 2 else values[:, None] * np.array([0.0, 0.0, 1.0])
    if load.kind == "point_moment":
        _arrows(axes, mesh, points, vector, label, colour, heads=2)
        return
    aside = ASIDE * mesh.size * number if chosen.dimension == 2 else 0.0
    _forces(axes, mesh, points + np.array([aside, 0.0, 0.0]), vector, label, colour)


def _draw_patch(
    axes: Axes, mesh: Mesh, chosen: Selection, load: Patch, end: float | None, label: str, colour: str
) -> None:
    """The rim of a disc or a rectangle, and signs inside; of one that moves, when most of it is on the plate."""
    centres = mesh.points[mesh.triangles[chosen.members]].mean(axis=1)
    frozen, members = pressed(load, centres, chosen.members, end)
    if not len(members):
        axes.plot([], [], linestyle="", label=f"{label} (presses on nothing)")
        return
    axes.plot(*frozen.outline()[:, :2].T, color=colour, linewidth=1.2, zorder=5)
    points = _places(mesh, Selection(2, members, chosen.label), PATCH_SIGNS)
    _forces(axes, mesh, points, frozen.at(points)[:, None] * np.array([0.0, 0.0, 1.0]), label, colour)


def _forces(axes: Axes, mesh: Mesh, points: Floats, vector: Floats, label: str, colour: str) -> None:
    most = np.abs(vector).max()
    if most == 0.0:
        axes.plot([], [], linestyle="", label=f"{label} (zero)")
        return
    seen = 1e-9 * most
    for sign, marker, words in (
        (1.0, toward(), "+z, toward you"),
        (-1.0, away(), "-z, away from you"),
    ):
        x = points[sign * vector[:, 2] > seen]
        if len(x):
            text = f"{label} ({words})"
            axes.plot(
                *x.T[:2], marker=marker, markersize=11, color=colour, linestyle="", label=text, zorder=6
            )
    flat = np.abs(vector[:, :2]).max(axis=1) > seen
    if flat.any():
        _arrows(axes, mesh, points[flat], vector[flat], label, colour, heads=1)


def _arrows(
    axes: Axes, mesh: Mesh, points: Floats, vector: Floats, label: str, colour: str, heads: int
) -> None:
    length = np.linalg.norm(vector[:, :2], axis=1).max()
    arrow = vector[:, :2] * (0.08 * mesh.size / length if length else 0.0)
    axes.update_datalim(points[:, :2] + arrow)
    for reach in (1.0, 0.8)[:heads]:  # a moment has two heads
        axes.quiver(
            *points.T[:2],
            *(reach * arrow).T,
            angles="xy",
            scale_units="xy",
            scale=1,
            color=colour,
            zorder=6,
        )
    axes.plot([], [], color=colour, marker=">", label=label)


def _places(mesh: Mesh, chosen: Selection, across: int = 0) -> Floats:
    """(n, 3) places for signs, spread evenly over what was chosen, with so many across it instead of the mesh."""
    if chosen.dimension == 0:
        return mesh.points[chosen.members]
    if chosen.dimension == 1:
        points = _along(mesh, chosen.members, SIGNS // 3)[0]
        return np.column_stack([points, np.full(len(points), mesh.points[0, 2])])
    centres = mesh.points[mesh.triangles[chosen.members]].mean(axis=1)
    whole = mesh.points[:, :2]
    cell = np.ptp(whole, axis=0).max() / 6
    low = whole.min(axis=0)
    if across:
        corners = whole[mesh.triangles[chosen.members]].reshape(-1, 2)
        low, cell = corners.min(axis=0), max(np.ptp(corners, axis=0).max() / across, cell / 3)
    boxes = np.floor((centres[:, :2] - low) / cell).astype(np.int64)
    middle = low + (boxes + 0.5) * cell
    order = np.argsort(np.linalg.norm(centres[:, :2] - middle, axis=1), kind="stable")
    _, first = np.unique(boxes[order], axis=0, return_index=True)
    return centres[order[first]]


def _along(mesh: Mesh, edges: NDArray[np.integer], signs: int) -> tuple[Floats, Floats]:
    """Points (n, 2) evenly along edges, and unit normals away from the triangle there."""
    length = np.cumsum(mesh.edge_lengths[edges])
    number = max(1, round(signs * length[-1] / mesh.size))
    position = (np.arange(number) + 0.5) * length[-1] / number
    nearest = np.minimum(np.searchsorted(length, position), len(edges) - 1)
    edges = edges[nearest]
    fraction = 1.0 - (length[nearest] - position) / mesh.edge_lengths[edges]
    start, end = (mesh.points[mesh.edges[edges, k], :2] for k in (0, 1))
    along = end - start
    point = start + fraction[:, None] * along
    if mesh.midpoints is not None:  # on the parabola through the mid-edge node
        bulge = mesh.midpoints[edges, :2] - 0.5 * (start + end)
        point += (4.0 * fraction * (1.0 - fraction))[:, None] * bulge
    normal = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.linalg.norm(along, axis=1)[:, None]
    inside = mesh.points[mesh.triangles[mesh.edge_owner[edges, 0]]].mean(axis=1)[:, :2] - point
    return point, np.where(np.sum(normal * inside, axis=1) > 0, -1.0, 1.0)[:, None] * normal


def _tint(axes: Axes, mesh: Mesh, chosen: Selection, colour: str, label: str) -> None:
    if chosen.dimension == 2:
        corners = mesh.points[mesh.triangles[chosen.members]][:, :, :2]
        _polygons(axes, corners, colour, alpha=0.2)
        axes.plot([], [], marker="s", markersize=10, alpha=0.3, color=colour, linestyle="", label=label)
    else:
        draw_edges(axes, mesh, chosen.members, colors=colour, linewidths=3.0)
        axes.plot([], [], color=colour, linewidth=3, label=label)


def _segments(axes: Axes, start: Floats, end: Floats, colour: str) -> None:
    from matplotlib.collections import LineCollection

    axes.add_collection(LineCollection(list(np.stack([start, end], axis=1)), colors=colour, linewidths=1.1))


def _polygons(axes: Axes, corners: Floats, colour: str, **style: Any) -> None:
    from matplotlib.collections import PolyCollection

    axes.add_collection(
        PolyCollection(list(corners), facecolors=colour, edgecolors="none", zorder=4, **style)
    )


def material_axes(scene: Scene) -> Iterator[tuple[str, float, str]]:
    """For every direction of direction-dependent materials: words, the angle in degrees, and a style of line."""
    stacks = list(each(scene.layers))
    layers = [(material, 0.0) for material in each(scene.material)]
    layers += [(layer.material, layer.angle) for stack in stacks for layer in stack]
    numbers: dict[float, list[str]] = {}  # angle: the layers at it
    for number, (material, turned) in enumerate(layers, start=1):
        if hasattr(material, "angle"):
            numbers.setdefault((material.angle + turned) % 180.0, []).append(str(number))
    for (angle, which), style in zip(numbers.items(), cycle(("-", "--", "-.", ":")), strict=False):
        whose = "" if not stacks else f" of layer {', '.join(which)}"
        yield f"material axis 1{whose}: {angle:g} degrees", angle, style


def _draw_material_axes(axes: Axes, mesh: Mesh, scene: Scene) -> None:
    """Axis 1 of every direction-dependent material, as a line through the middle of the plate."""
    centre = 0.5 * (mesh.points[:, :2].min(axis=0) + mesh.points[:, :2].max(axis=0))
    for label, angle, style in material_axes(scene):
        half = 0.1 * mesh.size * np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
        axes.plot(
            *np.stack([centre - half, centre + half]).T,
            color="#e67e22",
            linewidth=2.5,
            linestyle=style,
            label=label,
        )
