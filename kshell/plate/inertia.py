"""Mass and membrane forces of a plate as quadratic forms: what vibration and buckling need beside the stiffness.

Only translation has inertia, int mu v w: the rotary inertia mu t^2 / 12 of the normals is of the order of the
transverse shear that Kirchhoff's plate leaves out, and is left out with it. Membrane forces N, positive in tension,
give

    G(v, w) = int  grad v . N grad w.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.elements import PlateElement
from kshell.material.section import Section
from kshell.plate.domain import Domain
from kshell.plate.forms import AreaForm, Weights

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
# N (n, point, 2, 2) at reference points (n, point, 2) of triangles (n,)
MembraneForce = Callable[[Ints, Floats], Floats]

VARIABLE = 3  # further degrees of quadrature where the mass varies in a triangle


@dataclass
class Mass(AreaForm):
    """Integral of mass per area times v w."""

    everywhere = True

    domain: Domain
    element: PlateElement
    section: Section

    def weights(self, triangles: Ints) -> Weights:
        constant = self.section.constant_per_triangle
        if constant and not self.domain.is_curved[triangles[0]]:
            centres = self.domain.mesh.points[self.domain.mesh.triangles[triangles]].mean(axis=1)
            return Weights(0, self.section.mass(triangles, centres[:, None])[..., None])
        degree = 2 * self.element.maxdeg + (0 if constant else VARIABLE)
        patch = next(self.domain.patches(degree, triangles))
        z = np.broadcast_to(self.domain.mesh.points[0, 2], (*patch.xy.shape[:2], 1))
        density = self.section.mass(triangles, np.concatenate([patch.xy, z], axis=2))
        return Weights(0, (patch.weights * density)[..., None, None], patch.xi)


@dataclass
class Membrane(AreaForm):
    """Integral of grad v . N grad w: the geometric stiffness of membrane forces N.

    Attributes
    ----------
    force : function
        N in global components at points of triangles.
    degree : int
        Of N as a polynomial in each triangle.
    """

    everywhere = True

    domain: Domain
    element: PlateElement
    force: MembraneForce
    degree: int

    def weights(self, triangles: Ints) -> Weights:
        if self.degree == 0 and not self.domain.is_curved[triangles[0]]:
            centre = np.full((len(triangles), 1, 2), 1 / 3)
            return Weights(1, self.force(triangles, centre)[:, 0])
        patch = next(self.domain.patches(2 * (self.element.maxdeg - 1) + self.degree, triangles))
        xi = np.broadcast_to(patch.xi, patch.xy.shape)
        return Weights(1, patch.weights[..., None, None] * self.force(triangles, xi), patch.xi)
