"""Tensors at corners where a triangle is alone: averages would be its own values.

Where triangles meet, they differ by about their error. A triangle with two edges on the boundary shares the nodes of
its third edge only: under a force on its corner (a quarter of a pulled hemisphere, an eighth of a pinched cylinder)
plain averages found a tenth of its error, and intervals missed by up to three times. So the average at its boundary
nodes is that of a polynomial of the degree of the tensors, fitted by least squares to their values at the nodes of the
triangles around its corners and of the neighbours of these across an edge. Tensors are carried from the plane of one
triangle to another by the least rotation of the normal, so that those of a curved surface differ by no more than its
curvature makes them. Such fits at all boundary nodes were safe as well, and three to four times wider than they need
be.

Symbols
-------
P     monomials of the position in the tangent plane of a vertex, relative to the size of its triangles
R     (2, 2) takes components in one frame to those in another

A triangle that is a piece by itself, such as a facet of a pyramid, would be followed exactly by its own polynomial; it
is fitted by one of a degree less. That holds for orders of 3 and more (8 pyramids of one triangle a facet, triangular
plates, plates of two triangles of different thickness); below, nothing tells how stiff such a triangle is, and with
order 1 nothing tells it of two triangles that have but each other. Nor does it of a part one triangle wide, whose
vertices are all on its border: it bends by turning edges alone, and what loads and warmth do inside, or how far it
twists, is in no average (of 60 folded shells one triangle wide a third were outside, by up to 1,000 times; of 22 with
vertices inside all parts two, by up to 1.6). With order 2 none of 96 such shells is outside by more than a tenth, since
coarse ones are widened (`shells.py`).

Source: Zienkiewicz & Zhu, Int. J. Numer. Meth. Eng. 33 (1992) 1331-1364 (patches that reach further in at boundaries).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.elements.reference import monomials
from kshell.mesh.distinct import renumbered
from kshell.mesh.vectors import cross
from kshell.shell.reference import EDGES

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SINGLE = (
    "a part of one smooth shape and one stiffness has one or two triangles, which tell nothing of their error with "
    "elements of order 1 or 2: take order 3, or a finer mesh"
)
NARROW = (
    "a part of one smooth shape and one stiffness is one triangle wide, which tells nothing of its error with elements "
    "of order 1: take order 2, or a finer mesh"
)
RANK = 1e-10  # of eigenvalues of the normal equations, below which a few triangles do not tell a coefficient


class CornerFits:
    """The fits around triangles with two or three edges on the boundary.

    Parameters
    ----------
    corners, edges : (triangle, 3) int arrays
        Vertices 0, 1, 2 of each triangle, and its edges 01, 12, 02.
    pieces : (triangle,) int array
        Smooth pieces with one stiffness each: where two of them meet is a boundary of both.
    degree : int
        Of the tensors; at least 1.
    position : (triangle, node, 3)
        Lagrange nodes of that degree: corners, inner nodes of the edges one after the other, inside.
    axes : (triangle, node, 3, 3)
        Rows e_1, e_2, n of the frames of the tensors there.

    Attributes
    ----------
    triangles, nodes : (n,) int arrays
        The boundary nodes of these triangles.
    """

    def __init__(
        self, corners: Ints, edges: Ints, pieces: Ints, degree: int, position: Floats, axes: Floats
    ) -> None:
        corner, edge = by_piece(corners, pieces), by_piece(edges, pieces)
        on_boundary = (np.bincount(edge.ravel()) == 1)[edge]
        alone = np.flatnonzero(on_boundary.sum(axis=1) > 1)
        vertices, place, fit_of = np.unique(corner[alone].ravel(), return_index=True, return_inverse=True)
        first = alone[place // 3], place % 3
        self._frame, self._origin = axes[first], position[first]
        self._fit, self._member = _around(corner, edge, vertices)
        away = _in_plane(
            position[self._member] - self._origin[self._fit][:, None], self._frame[self._fit][:, None]
        )
        self._size = np.zeros(len(vertices))
        np.maximum.at(self._size, self._fit, np.abs(away).max(axis=(1, 2)))
        self._carry = carried(axes[self._member], self._frame[self._fit][:, None])
        self._p = monomials(degree, away / self._size[self._fit][:, None, None])
        self._single = (np.bincount(corner.ravel()) == 1)[corner].all(axis=1)
        shared = np.bincount(edge[alone].ravel(), minlength=int(edge.max()) + 1) > 1
        self._pair = shared[edge].any(axis=1)
        self._narrow = _one_triangle_wide(corner, corner[:, np.array(EDGES)][on_boundary])
        self._p[self._single[self._member], :, -(degree + 1) :] = 0.0  # the monomials of the highest degree
        normal = np.zeros((len(vertices), self._p.shape[2], self._p.shape[2]))
        np.add.at(normal, self._fit, self._p.swapaxes(1, 2) @ self._p)
        self._inverse = np.linalg.pinv(normal, rcond=RANK, hermitian=True)

        rows = _boundary_nodes(alone, fit_of.reshape(-1, 3), on_boundary[alone], degree)
        self.triangles, self.nodes = rows[:, 0], rows[:, 1]
        self._ends = []
        for fit in rows[:, 2:].T:  # on an edge the mean of the fits of its ends
            at = position[self.triangles, self.nodes] - self._origin[fit]
            p = monomials(degree, _in_plane(at, self._frame[fit]) / self._size[fit][:, None])
            self._ends.append((fit, p, carried(self._frame[fit], axes[self.triangles, self.nodes])))

    def untold(self, order: int) -> NDArray[np.bool_]:
        """(triangle,) whether elements of an order tell nothing of the error of a triangle."""
        if order > 2:
            return np.zeros_like(self._single)
        return self._single if order == 2 else self._single | self._pair

    def narrow(self, order: int) -> NDArray[np.bool_]:
        """(triangle,) whether shells of an order tell nothing of it because its part is one triangle wide there."""
        return self._narrow & (order == 1)

    def values(self, tensor: Floats) -> Floats:
        """(n, 3) at the boundary nodes, in the frames of tensors (triangle, node, 3) there."""
        seen = turned(tensor[self._member], self._carry)
        right = np.zeros((*self._inverse.shape[:2], 3))
        np.add.at(right, self._fit, self._p.swapaxes(1, 2) @ seen)
        coefficients = self._inverse @ right
        found = [turned((p[:, None] @ coefficients[fit])[:, 0], carry) for fit, p, carry in self._ends]
        return np.asarray(0.5 * (found[0] + found[1]))


def carried(one: Floats, other: Floats) -> Floats:
    """R (..., 2, 2) from one frame (..., 3, 3) to another, its normal turned onto the other's by the least angle."""
    n, m = np.broadcast_arrays(one[..., 2, :], other[..., 2, :])
    side = np.where((n * m).sum(axis=-1, keepdims=True) < 0.0, -1.0, 1.0)  # triangles may show their backs
    axis, cosine = cross(n, side * m), side * (n * m).sum(axis=-1, keepdims=True)
    tangents = np.broadcast_arrays(one[..., :2, :], other[..., :2, :])[0]
    axis = axis[..., None, :]
    along = (axis * tangents).sum(axis=-1, keepdims=True) / (1.0 + cosine[..., None])
    moved = cosine[..., None] * tangents + cross(axis, tangents) + axis * along
    return np.asarray(other[..., :2, :] @ moved.swapaxes(-1, -2))


def turned(tensor: Floats, rotation: Floats) -> Floats:
    """Components 11, 22, 12 (..., 3) of R T R^T."""
    full = tensor[..., np.array([[0, 2], [2, 1]])]
    full = rotation @ full @ rotation.swapaxes(-1, -2)
    return np.stack([full[..., 0, 0], full[..., 1, 1], full[..., 0, 1]], axis=-1)


def _in_plane(step: Floats, frame: Floats) -> Floats:
    """(..., 2) components of steps (..., 3) along the first two axes of frames (..., 3, 3)."""
    return np.asarray((frame[..., :2, :] @ step[..., None])[..., 0])


def by_piece(number: Ints, pieces: Ints) -> Ints:
    """Numbers (triangle, 3) of corners or edges that differ from piece to piece."""
    if not pieces.any():
        return renumbered(number)
    key = pieces[:, None] * (int(number.max()) + 1) + number.astype(np.int64)
    return np.unique(key.ravel(), return_inverse=True)[1].reshape(key.shape).astype(np.int64)


def _one_triangle_wide(corner: Ints, border: Ints) -> NDArray[np.bool_]:
    """(triangle,) whether no triangle at its corners has a vertex inside; `border` (n, 2): edges of the border."""
    inside = np.ones(int(corner.max()) + 1, dtype=bool)
    inside[border] = False
    near = np.zeros_like(inside)
    near[corner[inside[corner].any(axis=1)]] = True
    return np.asarray(~near[corner].any(axis=1))


def _around(corner: Ints, edge: Ints, vertices: Ints) -> tuple[Ints, Ints]:
    """Pairs of a vertex (its place in `vertices`) and a triangle: those at it, and their neighbours across edges."""
    fit, member = _sharing(corner, vertices)
    place, other = _sharing(edge, edge[member].ravel())
    pairs = np.unique(np.repeat(fit, 3)[place] * len(corner) + other)
    return pairs // len(corner), pairs % len(corner)


def _sharing(numbers: Ints, wanted: Ints) -> tuple[Ints, Ints]:
    """Pairs of a place in `wanted` (n,) and a triangle that has that number, of numbers (triangle, 3)."""
    order = np.argsort(numbers, axis=None, kind="stable")
    inside = numbers.ravel()[order]
    begin = np.searchsorted(inside, wanted, side="left")
    count = np.searchsorted(inside, wanted, side="right") - begin
    place = np.repeat(np.arange(len(wanted)), count)
    within = np.arange(len(place)) - np.repeat(np.cumsum(count) - count, count)
    return place, order[begin[place] + within] // 3


def _boundary_nodes(alone: Ints, fit: Ints, on_boundary: NDArray[np.bool_], degree: int) -> Ints:
    """(n, 4) triangle, node, and the two fits that it has its value from, of triangles with fits (n, 3) at corners."""
    rows = []
    for corner in range(3):
        own = fit[:, corner]
        rows.append(np.stack([alone, np.full_like(alone, corner), own, own], axis=1))
    for side, (a, b) in enumerate(EDGES):
        here = on_boundary[:, side]
        for k in range(degree - 1):
            node = np.full_like(alone[here], 3 + side * (degree - 1) + k)
            rows.append(np.stack([alone[here], node, fit[here, a], fit[here, b]], axis=1))
    return np.concatenate(rows)
