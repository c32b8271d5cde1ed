"""Pictures of curves, charts and curvature with matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError
from kshell.geometry.chart import Chart
from kshell.geometry.components import Floats
from kshell.geometry.curve import Curve
from kshell.geometry.places import Range
from kshell.geometry.surface_point import SurfacePoint
from kshell.mesh.mesh import Mesh

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# quantity: label of the colour bar
QUANTITIES = {
    "gaussian_curvature": "Gaussian curvature K",
    "mean_curvature": "mean curvature H",
    "k1": "larger principal curvature k1",
    "k2": "smaller principal curvature k2",
}
KIND_COLOURS = {
    "elliptic": "#c44e52",
    "hyperbolic": "#4c72b0",
    "parabolic": "#dd9b3c",
    "planar": "#8c8c8c",
}
LEGEND: Final = "outside upper left"
INSET = 1e-3  # of the range: how far pictures stay from poles, where a chart is singular


def curvature(
    chart: Chart,
    quantity: str = "gaussian_curvature",
    n: int = 80,
    u_range: Sequence[float] | None = None,
    v_range: Sequence[float] | None = None,
) -> Figure:
    """The surface coloured by a curvature, blue negative, white zero, red positive."""
    if quantity not in QUANTITIES:
        raise InputError(f'no picture of "{quantity}": there are {", ".join(QUANTITIES)}')
    s = _cells(chart, n, u_range, v_range)
    values = {"k1": 0, "k2": 1}.get(quantity)
    data = s.principal_curvatures[..., values] if values is not None else getattr(s, quantity)
    title = f"{QUANTITIES[quantity]} of the {chart.name}"
    figure, axes = _space(title[0].upper() + title[1:])
    _coloured(axes, _corners(chart, n, u_range, v_range), data, QUANTITIES[quantity])
    return figure


def classification(
    chart: Chart, n: int = 80, u_range: Sequence[float] | None = None, v_range: Sequence[float] | None = None
) -> Figure:
    """The surface coloured by elliptic, hyperbolic, parabolic and planar points."""
    from matplotlib.colors import to_rgba
    from matplotlib.patches import Patch

    kinds = _cells(chart, n, u_range, v_range).kind
    figure, axes = _space(f"Kinds of points of the {chart.name}")
    colours = np.empty((*kinds.shape, 4))
    for kind, colour in KIND_COLOURS.items():
        colours[kinds == kind] = to_rgba(colour)
    x, y, z = np.moveaxis(_corners(chart, n, u_range, v_range), -1, 0)
    axes.plot_surface(
        x, y, z, facecolors=colours, rstride=1, cstride=1, shade=True, linewidth=0, antialiased=False
    )
    present = [kind for kind in KIND_COLOURS if (kinds == kind).any()]
    figure.legend(handles=[Patch(color=KIND_COLOURS[k], label=k) for k in present], loc=LEGEND)
    _equal(axes, np.stack([x, y, z], axis=-1))
    return figure


def principal_directions(
    chart: Chart,
    n: int = 16,
    u_range: Sequence[float] | None = None,
    v_range: Sequence[float] | None = None,
) -> Figure:
    """Crosses of principal directions, left out at umbilics, where every direction is principal."""
    s = _cells(chart, n, u_range, v_range)
    figure, axes = _space(f"Principal directions of the {chart.name}")
    corners = _corners(chart, 3 * n, u_range, v_range)
    axes.plot_surface(*np.moveaxis(corners, -1, 0), color="#e8e4da", linewidth=0, antialiased=False, zorder=1)
    size = 0.35 * np.sqrt(s.area_element * np.prod(_steps(chart, n, u_range, v_range)))
    k1, k2 = np.moveaxis(s.principal_curvatures, -1, 0)
    umbilic = np.abs(k1 - k2) <= 1e-6 * np.maximum(np.abs(k1), np.abs(k2))
    shown = ~umbilic & _visible(axes, s.point, corners)
    if umbilic.all():
        axes.set_title(f"{chart.name}: every point is an umbilic, every direction principal")
    else:
        for i, (colour, label) in enumerate((("#c44e52", "k1"), ("#4c72b0", "k2"))):
            d = s.principal_directions[..., i, :] * size[..., None]
            segments = np.stack([s.point - d, s.point + d], axis=-2)[shown]
            _segments(axes, segments, colour, f"direction of {label}")
        figure.legend(loc=LEGEND)
    _equal(axes, corners)
    return figure


def gauss_map(
    chart: Chart, n: int = 40, u_range: Sequence[float] | None = None, v_range: Sequence[float] | None = None
) -> Figure:
    """The surface and its image under the Gauss map on the unit sphere, in the same colours of K."""
    import matplotlib.pyplot as plt

    figure = plt.figure(figsize=(10, 5), layout="constrained")
    left, right = (figure.add_subplot(1, 2, i, projection="3d") for i in (1, 2))
    s = _cells(chart, n, u_range, v_range)
    corners = _corners(chart, n, u_range, v_range)
    _coloured(left, corners, s.gaussian_curvature, QUANTITIES["gaussian_curvature"])
    normals = _at_corners(chart, n, u_range, v_range).normal
    _coloured(right, normals, s.gaussian_curvature, None)
    left.set_title(chart.name)
    right.set_title("image of the Gauss map on the unit sphere")
    return figure


def frames(
    curve: Curve, t: ArrayLike, rotation_minimising: bool = False, scale: float | None = None
) -> Figure:
    """Frames along a curve: Frenet's, or rotation-minimising ones, which exist at inflections too."""
    t = np.asarray(t, dtype=np.float64)
    line = curve(np.linspace(t.min(), t.max(), 600))
    rows = curve.rotation_minimising(t) if rotation_minimising else curve.at(t).frame
    names = (
        ("tangent T", "U", "V = T x U") if rotation_minimising else ("tangent T", "normal N", "binormal B")
    )
    kind = "Rotation-minimising" if rotation_minimising else "Frenet"
    figure, axes = _space(f"{kind} frames")
    axes.plot(*line.T, color="#333333", linewidth=1.5)
    size = 0.12 * np.ptp(line, axis=0).max() if scale is None else scale
    at = curve(t)
    for i, (name, colour) in enumerate(zip(names, ("#333333", "#c44e52", "#4c72b0"), strict=True)):
        _segments(axes, np.stack([at, at + size * rows[:, i]], axis=1), colour, name)
    figure.legend(loc=LEGEND)
    _equal(axes, np.concatenate([line, at + size * rows[:, 1], at + size * rows[:, 2]]))
    return figure


def on_mesh(mesh: Mesh, values: ArrayLike, label: str, title: str = "") -> Figure:
    """A triangle mesh coloured by values at vertices (in cells) or triangles; grey where NaN.

    Raises
    ------
    InputError
        If there are not as many values as vertices or triangles.
    """
    from matplotlib.colors import TwoSlopeNorm
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    data = np.asarray(values, dtype=np.float64)
    corners = mesh.points[mesh.triangles]
    if data.shape == (len(mesh.points),):
        data = data[mesh.triangles].ravel()
        polygons = _vertex_cells(corners)
    elif data.shape == (len(mesh.triangles),):
        polygons = corners
    else:
        raise InputError(f"values of shape {data.shape} are neither one per vertex nor one per triangle")
    figure, axes = _space(title)
    limit = _limit(data)
    mapped = _mappable(TwoSlopeNorm(0.0, -limit, limit))
    colours = mapped.to_rgba(data)
    colours[~np.isfinite(data)] = (0.6, 0.6, 0.6, 1.0)
    edges = "#00000030" if polygons is corners and len(corners) < 5000 else colours
    axes.add_collection3d(Poly3DCollection(polygons, facecolors=colours, edgecolors=edges, linewidths=0.4))
    figure.colorbar(mapped, ax=axes, label=label, shrink=0.7, pad=0.08)
    _equal(axes, mesh.points)
    return figure


def _vertex_cells(corners: Floats) -> Floats:
    """(3 * triangle, 4, 3) the part of each triangle nearest to each of its corners, as quadrilaterals."""
    after = 0.5 * (corners + np.roll(corners, -1, axis=1))
    before = 0.5 * (corners + np.roll(corners, 1, axis=1))
    middle = np.broadcast_to(corners.mean(axis=1, keepdims=True), corners.shape)
    return np.stack([corners, after, middle, before], axis=2).reshape(-1, 4, 3)


def _space(title: str) -> tuple[Figure, Any]:
    import matplotlib.pyplot as plt

    figure = plt.figure(figsize=(6.5, 5), layout="constrained")
    axes = figure.add_subplot(projection="3d", computed_zorder=False)
    axes.set_title(title)
    return figure, axes


def _ranges(
    chart: Chart, u_range: Sequence[float] | None, v_range: Sequence[float] | None
) -> tuple[Range, Range]:
    (a, b), (c, d) = chart.ranges(u_range, v_range)
    inset = INSET * (d - c)
    return (a, b), (c + inset, d - inset)


def _steps(
    chart: Chart, n: int, u_range: Sequence[float] | None, v_range: Sequence[float] | None
) -> tuple[float, float]:
    (a, b), (c, d) = _ranges(chart, u_range, v_range)
    return (b - a) / n, (d - c) / n


def _grid(
    chart: Chart, n: int, u_range: Sequence[float] | None, v_range: Sequence[float] | None, middle: bool
) -> list[NDArray[np.float64]]:
    (a, b), (c, d) = _ranges(chart, u_range, v_range)
    u, v = np.linspace(a, b, n + 1), np.linspace(c, d, n + 1)
    if middle:
        u, v = 0.5 * (u[1:] + u[:-1]), 0.5 * (v[1:] + v[:-1])
    return list(np.meshgrid(u, v, indexing="ij"))


def _cells(
    chart: Chart, n: int, u_range: Sequence[float] | None, v_range: Sequence[float] | None
) -> SurfacePoint:
    return chart.at(*_grid(chart, n, u_range, v_range, middle=True))


def _at_corners(
    chart: Chart, n: int, u_range: Sequence[float] | None, v_range: Sequence[float] | None
) -> SurfacePoint:
    return chart.at(*_grid(chart, n, u_range, v_range, middle=False))


def _corners(
    chart: Chart, n: int, u_range: Sequence[float] | None, v_range: Sequence[float] | None
) -> Floats:
    return chart(*_grid(chart, n, u_range, v_range, middle=False))


def _limit(data: Floats) -> float:
    """A symmetric range of colours that a few extreme values do not wash out."""
    finite = np.abs(data[np.isfinite(data)])
    return max(float(np.quantile(finite, 0.98)) if len(finite) else 1.0, 1e-12)


def _mappable(norm: Any) -> Any:
    from matplotlib.cm import ScalarMappable

    return ScalarMappable(norm, cmap="RdBu_r")


def _coloured(axes: Any, corners: Floats, data: Floats, label: str | None) -> None:
    from matplotlib.colors import TwoSlopeNorm

    limit = _limit(data)
    mapped = _mappable(TwoSlopeNorm(0.0, -limit, limit))
    x, y, z = np.moveaxis(corners, -1, 0)
    colours = mapped.to_rgba(data)
    cells = axes.plot_surface(x, y, z, facecolors=colours, rstride=1, cstride=1, shade=False, linewidth=0.4)
    cells.set_edgecolor(colours.reshape(-1, 4))  # without it thin gaps show between the cells
    if label is not None:
        axes.figure.colorbar(mapped, ax=axes, label=label, shrink=0.7, pad=0.08)
    _equal(axes, corners)


def _visible(axes: Any, points: Floats, surface: Floats) -> NDArray[np.bool_]:
    """Which points no other part of the surface hides, as the axes are turned now.

    matplotlib draws whole collections in one depth; so marks on a surface must be sorted out beforehand.
    """
    from scipy.spatial import KDTree

    elevation, azimuth = np.radians(axes.elev), np.radians(axes.azim)
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    outward = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    toward = np.cos(elevation) * outward + np.sin(elevation) * np.array([0.0, 0.0, 1.0])
    screen = np.stack([right, np.cross(toward, right)], axis=1)
    cells = surface.reshape(-1, 3)
    size = float(np.linalg.norm(np.ptp(cells, axis=0)))
    tree = KDTree(cells @ screen)
    flat = points.reshape(-1, 3)
    near = tree.query_ball_point(flat @ screen, 0.02 * size)
    depth = cells @ toward
    front = np.array([depth[found].max() if found else -np.inf for found in near])
    return (flat @ toward > front - 0.08 * size).reshape(points.shape[:-1])


def _segments(axes: Any, segments: Floats, colour: str, label: str) -> None:
    from mpl_toolkits.mplot3d.art3d import Line3DCollection

    axes.add_collection3d(Line3DCollection(segments, colors=colour, linewidths=1.4, label=label, zorder=2))


def _equal(axes: Any, points: Floats) -> None:
    from matplotlib.ticker import MaxNLocator

    flat = points.reshape(-1, points.shape[-1])
    low, high = flat.min(axis=0), flat.max(axis=0)
    middle, half = 0.5 * (low + high), 0.52 * np.maximum(high - low, 0.15 * np.max(high - low))
    axes.set(xlim=(middle[0] - half[0], middle[0] + half[0]), ylim=(middle[1] - half[1], middle[1] + half[1]))
    axes.set(zlim=(middle[2] - half[2], middle[2] + half[2]), xlabel="x", ylabel="y", zlabel="z")
    axes.set_box_aspect(half)
    for k, axis in enumerate((axes.xaxis, axes.yaxis, axes.zaxis)):
        axis.set_major_locator(MaxNLocator(2 if half[k] < 0.4 * half.max() else 4))
