"""Grids of nodes with three translations and three rotations each, as Kratos, OpenSees and CalculiX take them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from verification.peers.surfaces import FREEDOMS, Surface

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# rules on the triangle with corners (0, 0), (1, 0), (0, 1), exact to degree 2, and on the square [-1, 1]^2
TRIANGLE = (np.array([[1, 1], [4, 1], [1, 4]]) / 6, np.full(3, 1 / 6))
_G, _W = np.polynomial.legendre.leggauss(3)
SQUARE = (np.stack(np.meshgrid(_G, _G), axis=-1).reshape(-1, 2), np.outer(_W, _W).ravel())
# corners, then middles of sides
_PLACES = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0]])


def lattice(along: int, across: int, nodes: int) -> tuple[Floats, Ints]:
    """Points (n, 2) of the unit square and cells of 3, 4 or 8 nodes.

    Triangles are those of `kshell.verify.cases.meshes.grid`.
    """
    step = 2 if nodes == 8 else 1
    n, m = step * along, step * across
    s, t = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, m + 1), indexing="ij")
    number = np.arange((n + 1) * (m + 1)).reshape(n + 1, m + 1)

    def at(i: int, j: int) -> Ints:
        rows, columns = slice(i, i + n - step + 1, step), slice(j, j + m - step + 1, step)
        return number[rows, columns].ravel()

    a, b, c, d = at(0, 0), at(step, 0), at(step, step), at(0, step)
    if nodes == 3:
        cells = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    elif nodes == 4:
        cells = np.stack([a, b, c, d], axis=1)
    else:
        cells = np.stack([a, b, c, d, at(1, 0), at(2, 1), at(1, 2), at(0, 1)], axis=1)
    points = np.column_stack([s.ravel(), t.ravel()])
    used, inverse = np.unique(cells, return_inverse=True)
    return points[used], inverse.reshape(cells.shape)


def shapes(nodes: int, xi: Floats) -> tuple[Floats, Floats]:
    """Values (point, node) and gradients (point, node, 2) of the shape functions."""
    x, y = xi.T
    if nodes == 3:
        values = np.stack([1 - x - y, x, y], axis=1)
        return values, np.tile(np.array([[-1.0, -1], [1, 0], [0, 1]]), (len(xi), 1, 1))
    a, b = _PLACES[:nodes].T.astype(float)
    x, y = x[:, None], y[:, None]
    corner = (1 + a * x) * (1 + b * y) / 4
    down = np.stack([a * (1 + b * y) / 4, b * (1 + a * x) / 4], axis=2)
    if nodes == 4:
        return corner, down
    # corners of eight nodes: (1 + a x)(1 + b y)(a x + b y - 1) / 4; middles: (1 - x^2)(1 + b y) / 2 and alike
    values = corner * (a * x + b * y - 1)
    slopes = down * (a * x + b * y - 1)[..., None] + corner[..., None] * np.stack([a, b], axis=1)
    flat = a == 0
    middle_x, middle_y = (1 - x**2) * (1 + b * y) / 2, (1 - y**2) * (1 + a * x) / 2
    slope_x = np.stack([-x * (1 + b * y), (1 - x**2) * b / 2], axis=2)
    slope_y = np.stack([(1 - y**2) * a / 2, -y * (1 + a * x)], axis=2)
    values[:, 4:] = np.where(flat, middle_x, middle_y)[:, 4:]
    slopes[:, 4:] = np.where(flat[:, None], slope_x, slope_y)[:, 4:]
    return values, slopes


def area_forces(points: Floats, cells: Ints, force: Any) -> Floats:
    """(n, 3) forces on the nodes that work as a force per area does."""
    nodes = cells.shape[1]
    xi, weights = TRIANGLE if nodes == 3 else SQUARE
    values, slopes = shapes(nodes, xi)
    tangents = np.einsum("qkd,ekx->eqdx", slopes, points[cells])
    area = np.linalg.norm(np.cross(tangents[:, :, 0], tangents[:, :, 1]), axis=2) * weights
    shares = np.zeros(len(points))
    np.add.at(shares, cells, area @ values)
    return shares[:, None] * np.asarray(force, dtype=float)


def line_forces(points: Floats, on: Ints, force: Any) -> Floats:
    """(n, 3) forces on the nodes of a straight side, two to a cell, that work as a force per length does."""
    order = on[np.argsort(np.linalg.norm(points[on] - points[on[0]], axis=1))]
    length = np.linalg.norm(np.diff(points[order], axis=0), axis=1)
    shares = np.zeros(len(points))
    shares[order[:-1]] += length / 2
    shares[order[1:]] += length / 2
    return shares[:, None] * np.asarray(force, dtype=float)


def of_surface(surface: Surface, count: int, nodes: int) -> dict[str, Any]:
    """The arrays of drivers that know nodes, for one of the surfaces."""
    st, cells = lattice(*surface.grid(count), nodes)
    s, t = st.T
    points = np.column_stack(surface.place(s, t, np))
    sides = {"left": s == 0, "right": s == 1, "bottom": t == 0, "top": t == 1}
    fixed = np.zeros((len(points), 6), dtype=bool)
    for side, how in surface.held.items():
        fixed[np.ix_(sides[side], [int(k) - 1 for k in FREEDOMS[how]])] = True
        if nodes == 8 and how != "clamped":
            _keep_turns_about(fixed, points, np.flatnonzero(sides[side]))

    def node(corner: tuple[float, float]) -> int:
        return int(np.argmin(np.abs(st - corner).sum(axis=1)))

    for corner, freedom in surface.pinned:
        fixed[node(corner), freedom - 1] = True
    force = area_forces(points, cells, surface.dead)
    for corner, value in surface.points:
        force[node(corner)] += value
    for side, value in surface.lines:
        force += line_forces(points, np.flatnonzero(sides[side]), value)
    corner, axis, sign = surface.read
    normals = surface.normal(points)
    normals = normals / np.linalg.norm(normals, axis=1)[:, None]
    first = points[cells[0]]
    turn = np.cross(first[1] - first[0], first[2] - first[0]) @ normals[cells[0, 0]]
    return {
        "points": points,
        "cells": cells,
        "fixed": fixed,
        "force": force,
        "read": np.array([node(corner), axis, int(sign)]),
        "normals": normals if turn > 0 else -normals,
    }


def _keep_turns_about(fixed: NDArray[np.bool_], points: Floats, on: Ints) -> None:
    """Release all rotations of a side but that about the axis nearest to it: CalculiX makes the others rigid knots."""
    order = on[np.argsort(np.linalg.norm(points[on] - points[on[0]], axis=1))]
    along = np.abs(np.gradient(points[order], axis=0)).argmax(axis=1)
    held = fixed[order, 3 + along].copy()
    fixed[order, 3:] = False
    fixed[order, 3 + along] = held


def of_plate(points: Floats, triangles: Ints, edges: Ints, kind: str, place: Any) -> dict[str, Any]:
    """The same for a plate in the plane z = 0 under the pressure 1, all edges alike.

    A supported edge holds the deflection, and the slope along it where it runs along x or y.
    """
    points = np.column_stack([points, np.zeros(len(points))])
    fixed = np.zeros((len(points), 6), dtype=bool)
    fixed[:, [0, 1, 5]] = True
    rim = np.unique(edges)
    fixed[rim, 2] = True
    if kind == "clamped":
        fixed[rim] = True
    else:
        along = np.abs(points[edges[:, 1]] - points[edges[:, 0]])
        for axis, turn in ((0, 4), (1, 3)):  # w,x is a rotation about y and the other way round
            parallel = along[:, 1 - axis] < 1e-12 * along.max()
            fixed[np.unique(edges[parallel]), turn] = True
    node = int(np.argmin(np.linalg.norm(points[:, :2] - place, axis=1)))
    force = area_forces(points, triangles, (0.0, 0.0, 1.0))
    return {
        "points": points,
        "cells": triangles,
        "fixed": fixed,
        "force": force,
        "read": np.array([node, 2, 1]),
    }
