"""A triangle mesh with named groups: the data every other part of kshell starts from."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from kshell.errors import InputError
from kshell.mesh.arrays import mesh_from_arrays
from kshell.mesh.higher import order_of
from kshell.mesh.triangulation import EDGE_VERTICES, KIND_OF_DIMENSION, Group, Triangulation

if TYPE_CHECKING:
    import skfem

__all__ = ["EDGE_VERTICES", "KIND_OF_DIMENSION", "Group", "Mesh"]


class Mesh(Triangulation):
    """Triangles in space with named groups, made by `from_arrays` or `kshell.mesh.read_mesh`.

    Attributes
    ----------
    points : (vertex, 3) float array
    triangles : (triangle, 3) int array
        Vertex indices, consistently oriented within each connected sheet.
    midpoints : (edge, 3) float array or None
        Where the node on each edge lies, for a mesh of order 2.
    groups : dict of str to Group
    notes : tuple of str
        What was repaired or is worth knowing, in words for the user.
    source : str
        Where the mesh came from, for messages.
    curving : Curving or None
        Of flat triangles that stand for a curved surface.
    higher : Higher or None
        All nodes of triangles of order 3 and 4 of a file: their geometry has that order.
    parts : (triangle,) int array or None
        Of a file that gmsh has divided: the part of each triangle, from 0, which is the process that has it if there
        are as many.
    """

    @classmethod
    def from_arrays(
        cls,
        points: ArrayLike,
        triangles: ArrayLike,
        groups: dict[str, Any] | None = None,
        midpoints: ArrayLike | None = None,
    ) -> Mesh:
        """A mesh from plain arrays, checked like one that is read from a file.

        Parameters
        ----------
        points : (vertex, 2 or 3) array
        triangles : (triangle, 3) or (triangle, 6) int array
            Six nodes: corners, then the nodes on edges (0, 1), (1, 2), (2, 0).
        groups : dict, optional
            Name to (n, 3) triangles, (n, 2) edges or (n,) vertices, all as vertex indices.
        midpoints : (edge, 3) array, optional
            Mid-edge nodes in the order of `edges`, instead of six-node triangles.

        Raises
        ------
        InputError
            If an index is out of range, an array has the wrong shape, or the mesh is unusable.
        """
        return mesh_from_arrays(cls, points, triangles, groups, midpoints)

    def __repr__(self) -> str:
        order = order_of(self)
        return (
            f"<Mesh {self.source}: {len(self.points)} vertices, {len(self.triangles)} triangles of order {order}, "
            f"{len(self.groups)} groups>"
        )

    def _repr_html_(self) -> str:
        """Sizes and groups, for notebooks."""
        rows = "".join(
            f"<tr><td>{escape(name)}</td><td>{KIND_OF_DIMENSION[group.dimension]}</td>"
            f"<td>{len(group.members)}</td></tr>"
            for name, group in self.groups.items()
        )
        return f"<p>{escape(repr(self))}</p><table><tbody>{rows}</tbody></table>"

    def to_skfem(self) -> skfem.MeshTri:
        """The same triangles as a scikit-fem mesh of the plane.

        Groups of curves become its boundaries, groups of surfaces its subdomains. Edges and facets have the
        same numbers. Of a mesh of order 2 the vertices alone are taken.

        Raises
        ------
        InputError
            If the z coordinate is not constant.
        """
        import skfem

        z = self.points[:, 2]
        if np.ptp(z) > 1e-9 * self.size:
            raise InputError(
                f"{self.source}: not planar (z from {z.min():g} to {z.max():g}), so it has no scikit-fem "
                "equivalent: scikit-fem drops z silently"
            )
        return skfem.MeshTri(
            np.ascontiguousarray(self.points[:, :2].T),
            np.ascontiguousarray(self.triangles.T.astype(np.int64)),
            {name: group.members for name, group in self.groups.items() if group.dimension == 1},
            {name: group.members for name, group in self.groups.items() if group.dimension == 2},
            sort_t=False,
            validate=False,
        )
