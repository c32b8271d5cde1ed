"""Transverse shear of layers: its stiffness, and the shear stresses between them.

Shear stresses follow from equilibrium with bending moments that grow along x and y, in cylindrical bending each, and
the shear stiffness from their energy (Rohwer, Composite Structures 10 (1988) 11-25). One homogeneous layer has the
parabola with 3/2 of the mean, and 5/6 G t.

Symbols
-------
z           height above the middle of the stack
Q, G        plane-stress (3, 3) and transverse shear stiffness (2, 2) of a layer in global axes
A, B, D     as in `kshell.material.laminate`; D* = D - B A^-1 B
a, b        integrals of Q and z Q from the bottom to z
F           (a A^-1 B - b) D*^-1: a growth M' of the moments has the shear stress F M'
f           (2, 2) with (tau_xz, tau_yz) = f (Q_x, Q_y), where M_xx grows along x and M_yy along y alone
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

POINTS = 3  # f is a parabola in each layer, the energy of degree 4


class TransverseShear:
    """Shear stresses through a stack.

    Parameters
    ----------
    z : (layer + 1,)
        Heights of the interfaces, bottom to top.
    Q : (layer, 3, 3)
    """

    def __init__(self, z: Floats, Q: Floats) -> None:
        self.z, self.Q = z, Q
        A, B, D = (np.tensordot(np.diff(z**k) / k, Q, axes=1) for k in (1, 2, 3))
        self._from_strain = np.linalg.solve(A, B)
        self._from_moment = np.linalg.inv(D - B @ self._from_strain)
        below = [np.diff(z**k)[:, None, None] / k * Q for k in (1, 2)]
        self._below = [np.concatenate([np.zeros((1, 3, 3)), np.cumsum(part, axis=0)]) for part in below]

    def profile(self, layer: int, z: float) -> Floats:
        """f (2, 2) at a height in a layer."""
        start, Q = self.z[layer], self.Q[layer]
        a = self._below[0][layer] + (z - start) * Q
        b = self._below[1][layer] + 0.5 * (z * z - start * start) * Q
        F = (a @ self._from_strain - b) @ self._from_moment
        return np.array([[F[0, 0], F[2, 1]], [F[2, 0], F[1, 1]]])

    def stiffness(self, G: Sequence[Floats]) -> Floats:
        """S (2, 2) from the stiffness of the layers: S^-1 = int f^T G^-1 f dz."""
        s, w = np.polynomial.legendre.leggauss(POINTS)
        s, w = 0.5 * (1.0 + s), 0.5 * w
        flexibility = np.zeros((2, 2))
        for layer, (low, high) in enumerate(zip(self.z[:-1], self.z[1:], strict=True)):
            for point, weight in zip(s, w, strict=True):
                f = self.profile(layer, low + point * (high - low))
                flexibility += (high - low) * weight * f.T @ np.linalg.solve(G[layer], f)
        return np.asarray(np.linalg.inv(flexibility))
