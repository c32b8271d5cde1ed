"""Curvature at points of a mesh, as one object."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kshell.geometry.components import Floats


@dataclass(frozen=True)
class VertexCurvature:
    """Curvature at the vertices of a mesh.

    Attributes
    ----------
    principal_curvatures : (vertex, 2) array
        k1 >= k2, positive where the surface bends toward its normal.
    principal_directions : (vertex, 2, 3) array
        Unit vectors d1, d2 with d1 x d2 = normal.
    normal : (vertex, 3) array
    area : (vertex,) array
        Area over which each value was found.
    """

    principal_curvatures: Floats
    principal_directions: Floats
    normal: Floats
    area: Floats

    @cached_property
    def mean_curvature(self) -> Floats:
        """(vertex,) H."""
        return self.principal_curvatures.mean(axis=1)

    @cached_property
    def gaussian_curvature(self) -> Floats:
        """(vertex,) K."""
        return self.principal_curvatures.prod(axis=1)

    @cached_property
    def tensor(self) -> Floats:
        """(vertex, 3, 3) k1 d1 d1^T + k2 d2 d2^T."""
        return np.einsum(
            "nk,nki,nkj->nij", self.principal_curvatures, self.principal_directions, self.principal_directions
        )
