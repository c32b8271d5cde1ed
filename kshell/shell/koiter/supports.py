"""Kinematic conditions on a shell, in the words of engineers: clamped, supported, symmetric.

Each adds directions in which the translation of nodes is given, and rotations of edges; `free_motions` says what is
left free.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.equilibrium.reduction import Reduction
from kshell.errors import InputError
from kshell.shell.koiter.conormal import across_line, edge_conormals
from kshell.shell.koiter.free_motions import Conditions, free_motions
from kshell.shell.koiter.surface import Surface
from kshell.shell.planes import plane_normal, require_plane, within
from kshell.shell.vectors import AXES

Floats = NDArray[np.float64]

# degrees by which a surface may miss the right angle to its plane of symmetry; coarse facets miss it by some
LARGEST_SLANT = 30.0


class Supports:
    """Conditions on the motion of a surface; every method adds some.

    Parameters
    ----------
    surface : Surface
    """

    def __init__(self, surface: Surface) -> None:
        self.surface = surface
        self._conditions = Conditions()

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
        self._conditions.nodes.append(nodes)
        self._conditions.directions.append(directions / np.linalg.norm(directions, axis=1, keepdims=True))
        self._conditions.values.append(np.broadcast_to(np.asarray(values, dtype=float), (len(nodes),)))

    def rotation(self, edges: ArrayLike, values: ArrayLike = 0.0) -> None:
        """Prescribe the rotation about edges, from the lower to the higher vertex, in radians.

        `values` is a number or one per Gauss point, (rotations of the edges,).
        """
        unknowns = self.surface.rotations_of_edges(edges)
        self._conditions.rotations.append(unknowns)
        self._conditions.rotation_values.append(
            np.broadcast_to(np.asarray(values, dtype=float), unknowns.shape)
        )

    def translation(self, nodes: ArrayLike, axes: str = "xyz", value: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """Prescribe components, named by letters, of the displacement `value` (3,) or (n, 3)."""
        nodes = np.atleast_1d(np.asarray(nodes, dtype=np.int64))
        value = np.broadcast_to(np.asarray(value, dtype=float), (len(nodes), 3))
        if set(axes) == set("xyz"):
            self._conditions.groups.append(nodes)
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

    def symmetry(self, edges: ArrayLike, normal: ArrayLike | None = None) -> Floats:
        """The edges lie in a plane of symmetry: no translation across it, no rotation about the edges.

        Parameters
        ----------
        normal : (3,), optional
            Normal of the plane. Absent: that of the plane of a curve, and at a straight line the direction in which the
            surface leaves it.

        Returns
        -------
        (3,) unit normal of the plane.

        Raises
        ------
        InputError
            If the edges do not lie in one plane, or the surface does not meet it at a right angle.
        """
        conormals = edge_conormals(self.surface, edges)
        x = self.surface.nodes[self.surface.nodes_of_edges(edges)]
        axis = plane_normal(x, "a symmetry plane", normal, lambda: across_line(self.surface, edges))
        require_plane(x, axis, "a symmetry plane")
        slope = np.min(np.abs(conormals @ axis))
        if slope < np.cos(np.radians(LARGEST_SLANT)):
            raise InputError(
                f"symmetry: the surface meets the plane with normal ({axis[0]:.4g}, {axis[1]:.4g}, {axis[2]:.4g}) "
                f"{np.degrees(np.arccos(slope)):.3g} degrees off the right angle: half of a smooth symmetric surface "
                "meets its plane of symmetry at a right angle"
            )
        self.along(self.surface.nodes_of_edges(edges), axis)
        self.rotation(edges)
        return axis

    def diaphragm(self, edges: ArrayLike, normal: ArrayLike | None = None) -> None:
        """A wall in the plane of the edges, rigid in its plane and soft across it; rotation free.

        Raises
        ------
        InputError
            If the edges lie in no plane, or in many (a straight line) and `normal` is not given.
        """
        nodes = self.surface.nodes_of_edges(edges)
        axis = plane_normal(self.surface.nodes[nodes], "a diaphragm", normal)
        require_plane(self.surface.nodes[nodes], axis, "a diaphragm")
        for direction in within(axis):
            self.along(nodes, direction)

    def reduction(self) -> Reduction:
        """The motions left. See `free_motions`."""
        return free_motions(self.surface, self._conditions)
