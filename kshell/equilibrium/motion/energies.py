"""Strain energies of one time step, which take the place of that of the material in an equilibrium.

Viscosity. A material of Kelvin and Voigt has the stress K (e + tau de/dt) with the elastic strain e. With the rate
(e1 - e0) / h and q = tau / h that is

    (1 + q) K (e1 - q / (1 + q) e0):

a stiffer material with another strain free of stress. It resists changes of the strains, so turning as a rigid body
is not damped.

Energy and momentum. With the strains of both ends, s' their derivative in the middle xm = (x0 + x1) / 2, the forces

    s'(xm)^T K (e0 + e1) / 2,      M (2 / h^2) (x1 - x0 - h v0),

conserve momentum and angular momentum, and the energy of strains that are quadratic in x, as membrane strains are (Simo
and Tarnow, ZAMP 43, 1992); that of bending up to terms of the third order in the step.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.energy import Energy, StrainEnergy

Floats = NDArray[np.float64]


class OfStep:
    """What both have in common: all that is not told otherwise is that of the material.

    Parameters
    ----------
    material : StrainEnergy
    strain : (triangle, r)
        Elastic strain e0 at the start of the step.
    viscosity : float
        q.
    """

    def __init__(self, material: StrainEnergy, strain: Floats, viscosity: float) -> None:
        self.material, self.strain, self.viscosity = material, strain, viscosity

    def __getattr__(self, name: str) -> Any:
        return getattr(self.material, name)


class Viscous(OfStep):
    """The energy whose stress is that of a viscous material at the end of the step."""

    def energy(
        self,
        x: Floats,
        derivatives: int = 0,
        memory: Any = None,
        stress: Floats | None = None,
        initial: Floats | None = None,
        projected: bool = False,
    ) -> Energy:
        """As `StrainEnergy.energy`."""
        scale = 1.0 + self.viscosity
        free = self.viscosity / scale * self.strain
        if initial is not None:
            free = free + initial
        found = self.material.energy(x, derivatives, memory, stress, free, projected)
        gradient = None if found.gradient is None else scale * found.gradient
        if found.hessian is not None:
            found.hessian.data *= scale
        return found._replace(value=scale * found.value, gradient=gradient)


class Middle(OfStep):
    """Mean stress of both ends with the derivative of the strains in the middle; x is the place at the end.

    Parameters
    ----------
    x : (unknowns,)
        Place at the start.
    """

    def __init__(self, material: StrainEnergy, strain: Floats, viscosity: float, x: Floats) -> None:
        super().__init__(material, strain, viscosity)
        self.x = x

    def energy(
        self,
        x: Floats,
        derivatives: int = 0,
        memory: Any = None,
        stress: Floats | None = None,
        initial: Floats | None = None,
        projected: bool = False,
    ) -> Energy:
        """As `StrainEnergy.energy`; strains of the answer, and `stress`, are the mean ones."""
        material, q = self.material, self.viscosity
        strain = material.strain(x, memory)
        if initial is not None:
            strain = strain - initial
        mean = (0.5 + q) * strain + (0.5 - q) * self.strain
        acting = material.stress(mean)
        value = 0.5 * float(np.sum(mean * acting))
        if derivatives == 0:
            return Energy(value)
        middle = 0.5 * (self.x + x)
        acts = acting if stress is None else stress
        found = material.energy(middle, derivatives, memory, acts, None, projected)
        gradient = material.forces(found.linear, acting)
        if found.hessian is not None:
            found.hessian.data *= 0.5 + q
        gradients = [(0.5 + q) * part for part in found.linear.gradients]
        return Energy(value, gradient, found.hessian, found.linear._replace(strain=mean, gradients=gradients))
