"""Triangle meshes of charts: sides glued where they coincide, poles collapsed, sides named.

The grid of (n_u + 1) x (n_v + 1) parameter points is cut into triangles whose corners run
counter-clockwise in the (u, v) plane, so that each triangle has the side of the chart's normal on top.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.geometry.components import Floats
from kshell.geometry.places import Range
from kshell.mesh.mesh import EDGE_VERTICES, Group, Mesh

Numbers = NDArray[np.int64]
Points = Callable[[Floats, Floats], Floats]  # (..., 3) places at parameters u, v

PATTERNS = ("diagonal", "alternate", "crossed")
SURFACE_GROUP = "surface"
COINCIDENT = 1e-9  # of the size of the surface: two sides nearer than that are one
SMALLEST_AREA = 1e-14  # of the size squared
MOST_TRIANGLES = 20_000_000


def mesh_on_chart(
    x: Points,
    name: str,
    n_u: int,
    n_v: int,
    order: int,
    names: Sequence[str | None],
    u_range: Range,
    v_range: Range,
    pattern: str,
) -> Mesh:
    """The mesh that `Chart.mesh` describes, of the surface with the points x(u, v) and a name for messages.

    Raises
    ------
    InputError
        If counts, order, names or pattern are not possible, or a triangle would have no area (the message
        says where).
    """
    _check(n_u, n_v, order, names, pattern)
    grid_u, grid_v = np.meshgrid(
        np.linspace(*u_range, n_u + 1), np.linspace(*v_range, n_v + 1), indexing="ij"
    )
    grid = x(grid_u, grid_v)  # (i, j, xyz)
    size = float(np.linalg.norm(np.ptp(grid.reshape(-1, 3), axis=0)))
    if size == 0.0:
        raise InputError(f"{name}: the whole range is one point, {grid[0, 0]}")

    sides = {"u0": grid[0], "u1": grid[-1], "v0": grid[:, 0], "v1": grid[:, -1]}
    collapsed = {side: bool(np.ptp(row, axis=0).max() <= COINCIDENT * size) for side, row in sides.items()}
    glued = {
        axis: _coincide(sides[axis + "0"], sides[axis + "1"], size) and not collapsed[axis + "0"]
        for axis in "uv"
    }
    for axis, count in (("u", n_u), ("v", n_v)):
        if glued[axis] and count < 3:
            raise InputError(f"{name} closes up along {axis}: it needs at least 3 cells there, not {count}")
        if collapsed[axis + "0"] and collapsed[axis + "1"] and count < 2:
            raise InputError(f"{name} has a pole on both sides of {axis}: it needs at least 2 cells there")

    number = _glue(np.arange(grid_u.size).reshape(grid_u.shape), glued, collapsed)
    corners, u, v = _cells(number, grid_u, grid_v, pattern)
    points = grid.reshape(-1, 3)
    if pattern == "crossed":
        points = np.concatenate([points, x(u[:, 2], v[:, 2])[::4]])
    real = (corners != np.roll(corners, 1, axis=1)).all(axis=1)  # no corner twice
    corners, u, v = corners[real], u[real], v[real]
    used, inverse = np.unique(corners, return_inverse=True)
    triangles: NDArray[np.int32] = inverse.reshape(-1, 3).astype(np.int32)
    points = points[used]
    mesh = Mesh(points, triangles)
    _refuse_flat(name, mesh, size, u, v)

    renumber = np.full(int(number.max()) + 1, -1)
    on_grid = used <= number.max()
    renumber[used[on_grid]] = np.flatnonzero(on_grid)
    groups = _groups(mesh, renumber[number], glued, collapsed, names)
    midpoints = _midpoints(x, mesh, u, v, u_range, v_range, collapsed) if order == 2 else None
    return Mesh(points, triangles, midpoints, groups, _notes(name, glued, collapsed), name)


def _check(n_u: int, n_v: int, order: int, names: Sequence[str | None], pattern: str) -> None:
    for name, count in (("n_u", n_u), ("n_v", n_v)):
        if not isinstance(count, (int, np.integer)) or isinstance(count, bool) or count < 1:
            raise InputError(f"{name} = {count!r} must be a whole number of cells, at least 1")
    if 2 * n_u * n_v > MOST_TRIANGLES:
        raise InputError(f"{n_u} x {n_v} cells are more than {MOST_TRIANGLES} triangles: take fewer")
    if order not in (1, 2):
        raise InputError(f"order = {order!r} must be 1 or 2")
    if isinstance(names, str) or len(names) != 4:
        raise InputError(f"names = {names!r} must name the four sides u0, u1, v0, v1 (None leaves one out)")
    if SURFACE_GROUP in names:
        raise InputError(f'the name "{SURFACE_GROUP}" is that of the whole surface: name the sides otherwise')
    if pattern not in PATTERNS:
        raise InputError(f'pattern = "{pattern}" must be one of {", ".join(PATTERNS)}')


def _coincide(first: Floats, last: Floats, size: float) -> bool:
    return bool(np.abs(first - last).max() <= COINCIDENT * size)


def _glue(number: Numbers, glued: dict[str, bool], collapsed: dict[str, bool]) -> Numbers:
    """Grid numbers (i, j) with those of coincident points made equal."""
    if glued["u"]:
        number[-1] = number[0]
    if glued["v"]:
        number[:, -1] = number[:, 0]
    for side, row in (("u0", (0,)), ("u1", (-1,)), ("v0", (slice(None), 0)), ("v1", (slice(None), -1))):
        if collapsed[side]:
            number[row] = number[row].flat[0]
    return number


def _cells(number: Numbers, grid_u: Floats, grid_v: Floats, pattern: str) -> tuple[Numbers, Floats, Floats]:
    """Corners of the triangles, their u and their v, each (triangle, 3); u and v do not jump at a seam."""

    def four(a: Any) -> Any:
        return [a[:-1, :-1].ravel(), a[1:, :-1].ravel(), a[1:, 1:].ravel(), a[:-1, 1:].ravel()]

    n, u, v = four(number), four(grid_u), four(grid_v)
    first, second = [(0, 1, 2), (0, 2, 3)], [(0, 1, 3), (1, 2, 3)]
    if pattern == "crossed":
        for corners, middle in (
            (n, number.size + np.arange(len(n[0]))),
            (u, sum(u) / 4.0),
            (v, sum(v) / 4.0),
        ):
            corners.append(middle)
        cut = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
        return _gather(n, cut), _gather(u, cut), _gather(v, cut)
    if pattern == "diagonal":
        return _gather(n, first), _gather(u, first), _gather(v, first)
    i, j = np.indices((grid_u.shape[0] - 1, grid_u.shape[1] - 1))
    odd = np.repeat(((i + j) % 2 == 1).ravel(), 2)[:, None]
    return tuple(np.where(odd, _gather(a, second), _gather(a, first)) for a in (n, u, v))


def _gather(corner_arrays: list[Any], cut: list[tuple[int, int, int]]) -> Any:
    """(cell * triangle in the cell, 3) from arrays per corner of the cell."""
    per_cell = np.stack([np.stack([corner_arrays[c] for c in corners], axis=-1) for corners in cut], axis=1)
    return per_cell.reshape(-1, 3)


def _refuse_flat(name: str, mesh: Mesh, size: float, u: Floats, v: Floats) -> None:
    flat = np.flatnonzero(mesh.areas <= SMALLEST_AREA * size**2)
    if len(flat):
        at = flat[0]
        raise InputError(
            f"{name}: {len(flat)} triangles have no area, the first near u = {u[at].mean():.6g}, "
            f"v = {v[at].mean():.6g}: the chart is singular there or the range far too thin"
        )


def _groups(
    mesh: Mesh,
    number: Numbers,
    glued: dict[str, bool],
    collapsed: dict[str, bool],
    names: Sequence[str | None],
) -> dict[str, Group]:
    sides = {"u0": number[0], "u1": number[-1], "v0": number[:, 0], "v1": number[:, -1]}
    groups = {SURFACE_GROUP: Group(2, np.arange(len(mesh.triangles), dtype=np.int32))}
    for (side, row), name in zip(sides.items(), names, strict=True):
        if name is None or glued[side[0]]:
            continue
        if collapsed[side]:
            part = Group(0, np.array([row[0]], dtype=np.int32))
        else:
            part = Group(1, np.unique(mesh.edge_index(np.stack([row[:-1], row[1:]], axis=1))))
        if name in groups:
            if groups[name].dimension != part.dimension:
                raise InputError(f'the name "{name}" stands for a point and for a curve: give two names')
            part = Group(part.dimension, np.union1d(groups[name].members, part.members).astype(np.int32))
        groups[name] = part
    return groups


def _midpoints(
    x: Points, mesh: Mesh, u: Floats, v: Floats, u_range: Range, v_range: Range, collapsed: dict[str, bool]
) -> Floats:
    """(edge, 3) points of the chart halfway along each edge in the parameters.

    At a pole one parameter means nothing; the edge follows the parameter line of its other end.
    """
    ends_u, ends_v = u[:, EDGE_VERTICES], v[:, EDGE_VERTICES]  # (triangle, edge, end)
    middle_u, middle_v = ends_u.mean(axis=2), ends_v.mean(axis=2)
    for k, side in enumerate(("v0", "v1")):
        if collapsed[side]:
            for end in range(2):
                middle_u = np.where(ends_v[..., end] == v_range[k], ends_u[..., 1 - end], middle_u)
    for k, side in enumerate(("u0", "u1")):
        if collapsed[side]:
            for end in range(2):
                middle_v = np.where(ends_u[..., end] == u_range[k], ends_v[..., 1 - end], middle_v)
    midpoints = np.empty((len(mesh.edges), 3))
    midpoints[mesh.triangle_edges] = x(middle_u, middle_v)
    return midpoints


def _notes(name: str, glued: dict[str, bool], collapsed: dict[str, bool]) -> tuple[str, ...]:
    notes = [f"{name}: the sides {a}0 and {a}1 coincide and were glued" for a in "uv" if glued[a]]
    notes += [f"{name}: the side {side} is one point" for side, one in collapsed.items() if one]
    return tuple(notes)
