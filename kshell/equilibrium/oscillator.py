"""A structure that moves by small deflections, as matrices on all unknowns.

    M x'' + d M x' + K (x + tau x') + S x = f(t) + tau f0'(t) + r,      x = T q + x0(t),      T^T r = 0

M mass, K stiffness of the material, S of elastic supports, f loads with the forces f0 of strains without stress, r what
supports exert, tau the viscosity of the material and d the drag.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Oscillator:
    """The symbols of the module's docstring at one time; matrices do not depend on it.

    Attributes
    ----------
    mass, stiffness : (unknowns, unknowns) CSR matrix
    springs : (unknowns, unknowns) CSR matrix, optional
    basis : (unknowns, free) sparse
        T.
    given : (unknowns,)
        x0.
    load : (unknowns,)
        f, with `initial`.
    initial : (unknowns,), optional
        f0.
    initial_energy : float
        Of the strains without stress, where nothing moves.
    """

    mass: sp.csr_matrix
    stiffness: sp.csr_matrix
    springs: sp.csr_matrix | None
    basis: sp.csc_matrix
    given: Floats
    load: Floats
    initial: Floats | None = None
    initial_energy: float = 0.0

    def forces(self, x: Floats) -> Floats:
        """(unknowns,) K x + S x."""
        out: Floats = self.stiffness @ x
        return out if self.springs is None else out + self.springs @ x

    def energy(self, x: Floats) -> float:
        """That of strains and springs."""
        value = 0.5 * float(x @ self.forces(x)) + self.initial_energy
        return value if self.initial is None else value - float(self.initial @ x)
