"""Kinematic conditions on a shell: which motions are left, and what is prescribed.

Conditions are collected node by node as directions in which the translation is given, so inclined planes,
corners and changes of the support need no special case. The unknowns become x = T q + x0.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import ArrayLike, NDArray

from kshell.equilibrium.reduction import Reduction
from kshell.errors import InputError
from kshell.shell.koiter.edges import first_triangle
from kshell.shell.koiter.surface import Surface
from kshell.shell.vectors import cross, norm

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

AXES = {"x": 0, "y": 1, "z": 2}
# a direction that lies this close to the span of the others on a node says nothing new
DEPENDENT = 1e-6
ROUNDING = 1e-14
# how far from its plane, against its size, a symmetric or stiffened edge may lie
PLANAR = 1e-3
# degrees by which a surface may miss the right angle to its plane of symmetry; coarse facets miss it by some
LARGEST_SLANT = 30.0
# a plane whose normal, found from interpolated shape, is so close to a coordinate axis is meant to be at right
# angles to it
ON_AXIS = 2e-3


class Supports:
    """Conditions on the motion of a surface; every method adds some.

    Parameters
    ----------
    surface : Surface
    """

    def __init__(self, surface: Surface) -> None:
        self.surface = surface
        self._nodes: list[NDArray] = []
        self._directions: list[Floats] = []
        self._values: list[Floats] = []
        self._rotations: list[NDArray] = []
        self._rotation_values: list[Floats] = []

    def along(self, nodes: ArrayLike, directions: ArrayLike, values: ArrayLike = 0.0) -> None:
        """Prescribe the translation of nodes along directions.

        Parameters
        ----------
        nodes : (n,) int array
        directions : (3,) or (n, 3)
            Need not be of unit length.
        values : float or (n,)
            Displacement along the unit direction.
        """
        nodes = np.atleast_1d(np.asarray(nodes, dtype=np.int64))
        directions = np.broadcast_to(np.asarray(directions, dtype=float), (len(nodes), 3))
        self._nodes.append(nodes)
        self._directions.append(directions / np.linalg.norm(directions, axis=1, keepdims=True))
        self._values.append(np.broadcast_to(np.asarray(values, dtype=float), (len(nodes),)))

    def rotation(self, edges: ArrayLike, values: ArrayLike = 0.0) -> None:
        """Prescribe the rotation about edges, from the lower to the higher vertex, in radians.

        `values` is a number or one per Gauss point, (rotations of the edges,).
        """
        unknowns = self.surface.rotations_of_edges(edges)
        self._rotations.append(unknowns)
        self._rotation_values.append(np.broadcast_to(np.asarray(values, dtype=float), unknowns.shape))

    def translation(self, nodes: ArrayLike, axes: str = "xyz", value: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """Prescribe components, named by letters, of the displacement `value` (3,) or (n, 3)."""
        nodes = np.atleast_1d(np.asarray(nodes, dtype=np.int64))
        value = np.broadcast_to(np.asarray(value, dtype=float), (len(nodes), 3))
        for letter in axes:
            axis = AXES[letter]
            self.along(nodes, np.eye(3)[axis], value[:, axis])

    def clamp(self, edges: ArrayLike, value: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """No rotation, translations zero or prescribed."""
        self.translation(self.surface.nodes_of_edges(edges), "xyz", value)
        self.rotation(edges)

    def simple(self, edges: ArrayLike, value: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """No translation, free rotation."""
        self.translation(self.surface.nodes_of_edges(edges), "xyz", value)

    def symmetry(self, edges: ArrayLike, normal: ArrayLike | None = None) -> None:
        """The edges lie in a plane of symmetry: no translation across it, no rotation about the edges.

        Parameters
        ----------
        normal : (3,), optional
            Normal of the plane. Absent: the direction in which the surface leaves the edges.

        Raises
        ------
        InputError
            If the edges do not lie in one plane, or the surface does not meet it at a right angle.
        """
        conormals = edge_conormals(self.surface, edges)
        axis = (
            self._plane(edges) if normal is None else np.asarray(normal, dtype=float) / np.linalg.norm(normal)
        )
        if axis is None:  # a straight line: the surface tells the plane
            axis = np.linalg.svd(conormals.reshape(-1, 3), full_matrices=False)[2][0]
        if normal is None:
            axis = snapped(axis)
        self._require_plane(edges, axis, "a symmetry plane")
        slope = np.min(np.abs(conormals @ axis))
        if slope < np.cos(np.radians(LARGEST_SLANT)):
            raise InputError(
                f"symmetry: the surface meets the plane with normal ({axis[0]:.4g}, {axis[1]:.4g}, {axis[2]:.4g}) "
                f"{np.degrees(np.arccos(slope)):.3g} degrees off the right angle: half of a smooth symmetric surface "
                "meets its plane of symmetry at a right angle"
            )
        self.along(self.surface.nodes_of_edges(edges), axis)
        self.rotation(edges)

    def diaphragm(self, edges: ArrayLike, normal: ArrayLike | None = None) -> None:
        """A wall in the plane of the edges, rigid in its plane and soft across it; rotation free.

        Raises
        ------
        InputError
            If the edges lie in no plane, or in many (a straight line) and `normal` is not given.
        """
        axis = (
            self._plane(edges) if normal is None else np.asarray(normal, dtype=float) / np.linalg.norm(normal)
        )
        if axis is None:
            raise InputError("diaphragm: the edges form a straight line: give the normal of the plane")
        self._require_plane(edges, axis, "a diaphragm")
        nodes = self.surface.nodes_of_edges(edges)
        for direction in np.linalg.svd(axis[None])[2][1:]:
            self.along(nodes, direction)

    def _plane(self, edges: ArrayLike) -> Floats | None:
        """Normal of the plane through edges, None for a straight line."""
        x = self.surface.nodes[self.surface.nodes_of_edges(edges)]
        _, size, rows = np.linalg.svd(x - x.mean(axis=0), full_matrices=False)
        return rows[2] if size[1] > PLANAR * size[0] else None

    def _require_plane(self, edges: ArrayLike, axis: Floats, what: str) -> None:
        nodes = self.surface.nodes_of_edges(edges)
        x = self.surface.nodes[nodes]
        height = (x - x.mean(axis=0)) @ axis
        worst = int(np.argmax(np.abs(height)))
        size = float(np.linalg.norm(np.ptp(x, axis=0)))
        if abs(height[worst]) > PLANAR * size:
            raise InputError(
                f"{what} needs edges in one plane with normal ({axis[0]:.4g}, {axis[1]:.4g}, {axis[2]:.4g}), but "
                f"({x[worst][0]:.6g}, {x[worst][1]:.6g}, {x[worst][2]:.6g}) lies "
                f"{abs(height[worst]):.3g} off the mean: split the group by planes"
            )

    def reduction(self) -> Reduction:
        """The motions left.

        Raises
        ------
        InputError
            If two conditions prescribe different displacements of the same node.
        """
        surface = self.surface
        given = np.zeros(surface.unknowns)
        fixed = np.zeros(surface.unknowns, dtype=bool)
        rows, columns, entries, count = [], [], [], 0
        if self._nodes:
            nodes, basis, rank, motion = self._node_conditions()
            triple = 3 * nodes[:, None] + np.arange(3)
            fixed[triple] = True
            given[triple] = motion
            for kept in (1, 2):  # directions left free
                some = np.flatnonzero(rank == 3 - kept)
                for k in range(kept):
                    rows.append(triple[some].ravel())
                    columns.append(np.repeat(count + np.arange(len(some)), 3))
                    entries.append(basis[some, 2 - k].ravel())
                    count += len(some)
        rotations = np.zeros(0, dtype=np.int32)
        if self._rotations:
            rotations = np.unique(np.concatenate(self._rotations)).astype(np.int32)
            fixed[rotations] = True
            for unknowns, values in zip(self._rotations, self._rotation_values, strict=True):
                given[unknowns] = values
        free = np.flatnonzero(~fixed)
        # unconstrained unknowns first, in their order, then what is left of constrained nodes
        rows = [free, *rows]
        columns = [np.arange(len(free)), *(c + len(free) for c in columns)]
        entries = [np.ones(len(free)), *entries]
        basis_matrix = sp.csc_matrix(
            (np.concatenate(entries), (np.concatenate(rows), np.concatenate(columns))),
            shape=(surface.unknowns, len(free) + count),
        )
        basis_matrix.data[np.abs(basis_matrix.data) < ROUNDING] = 0.0
        basis_matrix.eliminate_zeros()
        return Reduction(basis_matrix, given, rotations)

    def _node_conditions(self) -> tuple[NDArray, Floats, NDArray, Floats]:
        """Per constrained node: number, orthonormal frame (fixed directions first), rank, prescribed motion."""
        nodes = np.concatenate(self._nodes)
        order = np.argsort(nodes, kind="stable")
        nodes = nodes[order]
        directions, values = np.concatenate(self._directions)[order], np.concatenate(self._values)[order]
        unique, first, counts = np.unique(nodes, return_index=True, return_counts=True)
        matrix = np.zeros((len(unique), max(int(counts.max()), 3), 3))
        right = np.zeros(matrix.shape[:2])
        row = np.arange(len(nodes)) - np.repeat(first, counts)
        node = np.repeat(np.arange(len(unique)), counts)
        matrix[node, row], right[node, row] = directions, values

        u, s, v = np.linalg.svd(matrix, full_matrices=False)
        independent = s > DEPENDENT
        scaled = np.where(independent, np.einsum("nri,nr->ni", u, right) / np.where(independent, s, 1.0), 0.0)
        motion = np.einsum("ni,nix->nx", scaled, v)
        miss = np.abs(np.einsum("nrx,nx->nr", matrix, motion) - right).max(axis=1)
        worst = int(np.argmax(miss))
        if miss[worst] > 1e-6 * np.abs(right).max(initial=0.0):
            x, y, z = self.surface.nodes[unique[worst]]
            raise InputError(
                f"supports prescribe different displacements at ({x:.6g}, {y:.6g}, {z:.6g}): "
                "they differ by "
                f"{miss[worst]:.3g}; remove one of the conditions there"
            )
        return unique, v, independent.sum(axis=1), motion


def snapped(axis: Floats) -> Floats:
    """The coordinate axis next to a unit vector, or the vector itself where none is close."""
    nearest = int(np.argmax(np.abs(axis)))
    unit = np.sign(axis[nearest]) * np.eye(3)[nearest]
    return unit if np.linalg.norm(axis - unit) < ON_AXIS else axis


def edge_conormals(surface: Surface, edges: ArrayLike) -> Floats:
    """Unit vectors in the surface, across the edge and outwards from the first triangle: (n, p, 3)."""
    p = surface.order
    edges = np.asarray(edges, dtype=np.int64)
    place = first_triangle(surface).reshape(-1, p)[edges]
    x1, x2 = surface.tangents(surface.reference.edge_first)
    result = cross(surface.edge_tangents, cross(x1, x2))
    return np.moveaxis((result / norm(result)).reshape(3, -1)[:, place], 0, 2)
