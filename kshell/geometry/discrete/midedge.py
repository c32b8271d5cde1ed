"""The midedge second fundamental form, the curvature that the Koiter element of lowest order sees.

On a flat triangle only the turn of the normal from one edge to the next is curvature. With a director d
on each edge, it is the symmetric tensor b that satisfies, for all constant symmetric tau,

    area  tau : b  =  - sum over the edges e of  |e| theta_e  tau(mu_e, mu_e),

that is   b = - (1 / area) sum_e |e| theta_e mu_e (x) mu_e.

Symbols
-------
n        normal of the triangle             d        director, on the edge, unit
t, mu    tangent of the edge, mu = t x n    theta    atan2(d . mu, d . n), the angle from n to d

Source: Grinspun, Gingold, Reisman & Zorin 2006; Neunteufel & Schoeberl, arXiv:1904.04714, at order 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from kshell.errors import InputError
from kshell.geometry import principal_axes as axes
from kshell.geometry.components import Floats, Vector
from kshell.geometry.discrete.topology import edge_vectors, require_surface, triangle_normals
from kshell.mesh.mesh import Mesh


@dataclass(frozen=True)
class MidedgeForm:
    """The midedge form of each triangle; NaN in triangles at a boundary edge without a director.

    Attributes
    ----------
    tensor : (triangle, 3, 3) array
        b as a tensor in space, tangent to the triangle.
    second_form : (triangle, 2, 2) array
        b in the basis x_1 - x_0, x_2 - x_0, as the second form of a chart.
    normal : (triangle, 3) array
    """

    tensor: Floats
    second_form: Floats
    normal: Floats

    @cached_property
    def _basis(self) -> tuple[Floats, Floats]:
        e1 = axes.tangent_axis(self.normal)
        return e1, np.cross(self.normal, e1)

    @cached_property
    def _form(self) -> Vector:
        return axes.projected(self.tensor, *self._basis)

    @cached_property
    def principal_curvatures(self) -> Floats:
        """(triangle, 2) k1 >= k2."""
        return axes.principal_curvatures(self._form, (len(self.tensor),))

    @cached_property
    def principal_directions(self) -> Floats:
        """(triangle, 2, 3) unit vectors."""
        return axes.principal_directions(self._form, self._basis[0], self.normal)

    @cached_property
    def mean_curvature(self) -> Floats:
        """(triangle,) H."""
        return self.principal_curvatures.mean(axis=1)

    @cached_property
    def gaussian_curvature(self) -> Floats:
        """(triangle,) K = k1 k2."""
        return self.principal_curvatures.prod(axis=1)


def midedge(mesh: Mesh, directors: ArrayLike | None = None) -> MidedgeForm:
    """The midedge second fundamental form of each triangle.

    Parameters
    ----------
    mesh : Mesh
    directors : (edge, 3) array, optional
        Unit vectors on the edges, in the order of `mesh.edges`; by default the mean of the normals of the two
        triangles. With the exact normals of a surface b converges on any mesh of shape-regular triangles;
        with the mean it converges only where the mesh is symmetric to first order, which is why the Koiter
        element keeps the turn of the director as an unknown.

    Raises
    ------
    InputError
        If the mesh is no oriented surface, or the directors have the wrong shape or are not finite.
    """
    require_surface(mesh)
    normal = triangle_normals(mesh)
    if directors is None:
        total = np.zeros((len(mesh.edges), 3))
        np.add.at(total, mesh.triangle_edges, normal[:, None, :])
        total[mesh.boundary_edges] = np.nan
        d = total / np.linalg.norm(total, axis=1, keepdims=True)
    else:
        d = np.asarray(directors, dtype=np.float64)
        if d.shape != (len(mesh.edges), 3) or not np.isfinite(d).all():
            raise InputError(
                f"directors must be finite and of shape {(len(mesh.edges), 3)}, one for each edge"
            )
    # side k lies opposite vertex k; mesh.triangle_edges has (0, 1), (1, 2), (0, 2)
    side = edge_vectors(mesh)
    on_side = d[mesh.triangle_edges[:, [1, 2, 0]]]
    length = np.linalg.norm(side, axis=2)
    mu = np.cross(side / length[..., None], normal[:, None, :])
    theta = np.arctan2(np.sum(on_side * mu, axis=2), np.sum(on_side * normal[:, None, :], axis=2))
    weight = -theta * length / mesh.areas[:, None]
    tensor = np.einsum("ts,tsi,tsj->tij", weight, mu, mu)
    basis = np.stack([side[:, 2], -side[:, 1]], axis=1)  # x_1 - x_0 and x_2 - x_0
    second_form = np.einsum("tai,tij,tbj->tab", basis, tensor, basis)
    return MidedgeForm(tensor, second_form, normal)
