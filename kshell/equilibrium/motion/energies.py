"""Strain energies of one time step, which take the place of that of the material in an equilibrium.

Viscosity. A material of Kelvin and Voigt has the stress K (e + tau de/dt) with the elastic strain e. With the rate
(e1 - e0) / h and q = tau / h that is

    (1 + q) K (e1 - q / (1 + q) e0):

a stiffer material with another strain free of stress, K (c e1 - f).
It resists changes of the strains, so turning as a rigid body
is not damped.

Energy and momentum. With the strains of both ends, s' their derivative in the middle xm = (x0 + x1) / 2, the forces

    s'(xm)^T K (e0 + e1) / 2,      M (2 / h^2) (x1 - x0 - h v0),

conserve momentum and angular momentum, and the energy of strains that are quadratic in x, as membrane strains are (Simo
and Tarnow, ZAMP 43, 1992); that of bending up to terms of the third order in the step.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.energy import StrainEnergy, inelastic_of
from kshell.equilibrium.evaluated import Asked, Energy, Evaluated
from kshell.equilibrium.reduction import Reduction

Floats = NDArray[np.float64]


class OfStep(Evaluated):
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


class Shifted(OfStep):
    """The energy of a stress K (c e1 - f) at the end of the step, with the elastic strain e1 there.

    Parameters
    ----------
    material : StrainEnergy
    strain : (triangle, r)
        e0.
    viscosity : float
        q.
    fading : Fading, optional
        Of a material whose stress relaxes.
    """

    def __init__(
        self, material: StrainEnergy, strain: Floats, viscosity: float, fading: Fading | None = None
    ) -> None:
        super().__init__(material, strain, viscosity)
        self.fading = fading
        self.shift = viscosity * strain  # f
        if fading is None:
            self.scale = 1.0 + viscosity  # c
            self.free = self.shift / self.scale
        else:  # c is one of each triangle: a material as much stiffer
            scale = viscosity + fading.scale
            self.scale, self.material = 1.0, fading.material.scaled(scale)
            self.free = (self.shift + fading.shift) / scale[:, None]

    def _energy(self, asked: Asked) -> Energy:
        x, derivatives, memory, stress, initial, projected = asked
        free = self.free
        if initial is not None:
            free = free + initial
        stays = inelastic_of(memory)
        if stays is not None:
            free = free - stays  # which the material takes off by itself
        found = self.material.energy(x, derivatives, memory, stress, free, projected)
        gradient = None if found.gradient is None else self.scale * found.gradient
        if found.hessian is not None and self.scale != 1.0:
            found.hessian.data *= self.scale
        return found._replace(value=self.scale * found.value, gradient=gradient)

    def settle(
        self, x: Floats, memory: Any, reduction: Reduction, initial: Floats | None = None
    ) -> tuple[Floats, Any]:
        """As `StrainEnergy.settle`; the material fades, too."""
        x, memory = self.material.settle(x, memory, reduction, initial)
        if self.fading is None:
            return x, memory
        strain = self.material.strain(x, memory)
        return x, self.fading.settled(memory, strain if initial is None else strain - initial)


class Fading:
    """How the stress of a material relaxes in one step, as its strain grows in proportion to the time.

    Of each term of the Prony series the strain q that has not relaxed yet, with the time tau:

        q1 = d q0 + w (e1 - e0),   d = exp(-h / tau),   w = (1 - d) tau / h,

    which is exact (Simo and Hughes, Computational Inelasticity, 1998, section 10.3), and the stress is
    K ((1 - sum g) e1 + sum g q1). In the first step the strain is taken to jump at its begin, w = d, as under a
    load that is there at once.

    Parameters
    ----------
    material : StrainEnergy
        With its `relaxation`.
    memory : Remembered
        At the start of the step.
    step : float
    first : bool
    """

    def __init__(self, material: Any, memory: Any, step: float, first: bool) -> None:
        self.material, self.step = material, step
        self.share = np.array([g for g, _ in material.relaxation])  # (k, triangle)
        self.time = np.array([tau for _, tau in material.relaxation])
        self.decay = np.exp(-step / self.time)  # d
        self.weight = self.decay if first else -np.expm1(-step / self.time) * self.time / step  # w
        self.before, self.strain = memory.inner[:-1], memory.inner[-1]
        left = self.weight @ self.share  # (triangle,)
        self.scale = 1.0 - self.share.sum(axis=0) + left
        self.shift = left[:, None] * self.strain - np.einsum(
            "kt,k,ktr->tr", self.share, self.decay, self.before
        )

    def settled(self, memory: Any, strain: Floats) -> Any:
        """The memory at the end of the step, with an elastic strain (triangle, r)."""
        change = strain - self.strain
        begun = self.before + (1.0 if self.weight is self.decay else 0.0) * change
        left = self.decay[:, None, None] * self.before + self.weight[:, None, None] * change
        lost = memory.lost.copy()
        for g, tau, start, end in zip(self.share, self.time, begun, left, strict=True):
            for part in (start, end):
                energy = np.sum(part * self.material.stress(part), axis=1)
                lost += 0.5 * g * min(self.step / tau, 1.0) * energy
        crept = np.einsum("kt,ktr->tr", self.share, strain - left)
        return replace(memory, inelastic=crept, inner=np.concatenate([left, strain[None]]), lost=lost)


def stored(material: Any, memory: Any) -> float:
    """Energy that a material that relaxes stores in a settled state, which it could give back at once."""
    total = 0.0
    share = [g for g, _ in material.relaxation]
    for g, part in zip([1.0 - sum(share), *share], [memory.inner[-1], *memory.inner[:-1]], strict=True):
        total += 0.5 * float(g @ np.sum(part * material.stress(part), axis=1))
    return total


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

    def _energy(self, asked: Asked) -> Energy:
        """As `energy`; strains of the answer, and `stress`, are the mean ones."""
        x, derivatives, memory, stress, initial, projected = asked
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
        # the derivative of s' is by x / 2, of the mean strain by 1/2 + q
        found = material.energy(middle, derivatives, memory, 0.5 / (0.5 + q) * acts, None, projected)
        gradient = material.forces(found.linear, acting)
        if found.hessian is not None:
            found.hessian.data *= 0.5 + q
        gradients = [(0.5 + q) * part for part in found.linear.gradients]
        return Energy(value, gradient, found.hessian, found.linear._replace(strain=mean, gradients=gradients))
