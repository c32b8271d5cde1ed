"""Deflection of one degree more than the element's, triangle by triangle: for values between vertices.

The element's deflection w_h is closer to what its unknowns are of the true one (values at vertices, moments along edges
to degree p - 2 and inside to degree p - 3: I w) than to w itself, and its moments m know curvatures to degree p - 1. So
in every triangle v of degree p + 1 is taken with

    I v = I w_h,    int_T C (kappa(v) - C^-1 m - kappa_0) : kappa(b) = 0   for all b of that degree with I b = 0.

At vertices it is w_h itself; across edges and along held ones it jumps by less than its error. Of order 1 it would be
no better than w_h. Source: R. Stenberg, RAIRO M2AN 25 (1991) 151-167; Comodi, Math. Comp. 52 (1989) 17-29.

Symbols
-------
psi        orthonormal functions of degree p + 1 (N of them); those of degree p and p - 1 (k of them) are the first
K          (N, p + 2) the functions b
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kshell.elements.hierarchic import orthonormal, orthonormal_jets, polynomial_count
from kshell.elements.jets import legendre
from kshell.elements.quadrature import interval_rule, triangle_rule
from kshell.elements.reference import VERTICES
from kshell.plate.hhj.arcs import BEYOND
from kshell.plate.hhj.state import HHJSolution
from kshell.plate.hhj.system import HHJSystem
from kshell.plate.hhj.tables import edge_points

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

BLOCK = 512  # triangles treated at a time


@dataclass(frozen=True)
class FinerTables:
    """What does not depend on the mesh.

    Attributes
    ----------
    first : (2, N, N) array
        Derivatives of psi along the reference axes, in psi.
    second : (3, k, N) array
        Second derivatives 11, 22, 12.
    kernel : (N, p + 2) array
        K of triangles with straight edges.
    """

    first: Floats
    second: Floats
    kernel: Floats


@lru_cache(maxsize=16)
def finer_tables(order: int) -> FinerTables:
    """The tables of an order."""
    points, weights = triangle_rule(2 * order + 2)
    jets = orthonormal_jets(order + 1, points)
    test = (weights[:, None] * jets[0]).T
    k = polynomial_count(order - 1)
    along = _along_edge(order)
    rows = [orthonormal(order + 1, VERTICES)]
    for edge in range(3):
        rows.append(along[1].T @ orthonormal(order + 1, edge_points(edge, along[0])))
    rows.append(np.eye(polynomial_count(order - 3), polynomial_count(order + 1)))
    return FinerTables(test @ jets[1:3], test[:k] @ jets[3:], _kernel(np.concatenate(rows)))


def _along_edge(order: int) -> tuple[Floats, Floats]:
    """Points (s,) of an edge, and (s, p - 1) weights times Legendre polynomials of degree p - 2 at most."""
    s, weights = interval_rule(order + BEYOND)
    return s, weights[:, None] * legendre(max(order - 2, 0), s)[:, : order - 1]


def _kernel(rows: Floats) -> Floats:
    """(..., N, N - r) orthonormal columns that rows (..., r, N) do not see."""
    return np.asarray(np.linalg.svd(rows)[2][..., rows.shape[-2] :, :].swapaxes(-1, -2))


class FinerDeflection:
    """v in triangles.

    Parameters
    ----------
    local : (T, m) array
        Coefficients of w_h: unknowns, at curved edges those of straight triangles.
    """

    def __init__(self, system: HHJSystem, solution: HHJSolution, local: Floats) -> None:
        self.system, self.solution, self.local = system, solution, local
        self.tables = finer_tables(system.order)

    def coefficients(self, chosen: Ints) -> Floats:
        """(n, N) v in psi, of some triangles."""
        parts = [self._block(chosen[start : start + BLOCK]) for start in range(0, len(chosen), BLOCK)]
        return np.concatenate(parts) if parts else np.zeros((0, self.tables.first.shape[1]))

    def _block(self, chosen: Ints) -> Floats:
        system, t = self.system, self.tables
        strains = self.solution.strains[chosen]
        if self.solution.load.initial is not None:
            strains = strains + self.solution.load.initial[chosen]
        k = strains.shape[2]
        # B times curvatures of the moments, in psi: (n, component, k)
        wanted = strains / system.root[chosen, None, None]
        kernel = np.broadcast_to(t.kernel, (len(chosen), *t.kernel.shape))
        arcs = system.arcs
        place = np.full(len(chosen), -1) if arcs is None else arcs.place[chosen]
        at = np.flatnonzero(place >= 0)
        if arcs is not None and len(at):
            up = arcs.up[place[at]]
            wanted[at] = strains[at] @ up
            kernel = kernel.copy()
            kernel[at] = self._kernels(place[at])
        out = np.zeros((len(chosen), t.first.shape[1]))
        inside = system.tables.jets[0]
        out[:, : len(inside)] = self.local[chosen] @ inside.T
        factor = system.factor if system.factor.ndim == 2 else system.factor[chosen]
        to_strain = (factor @ system.triangles.curvature_map[chosen])[:, None]  # (n, 1, component, ab)
        second = t.second.transpose(1, 0, 2)  # (k, ab, N)
        missing = wanted.swapaxes(1, 2)[..., None] - to_strain @ (second @ out[:, None, :, None])
        of_kernel = to_strain @ (second @ kernel[:, None])  # (n, k, component, p + 2)
        if len(at):  # psi are not orthonormal over the true region
            down = np.linalg.inv(up).swapaxes(1, 2)
            for part in (missing, of_kernel):
                part[at] = (down @ part[at].reshape(len(at), k, -1)).reshape(part[at].shape)
        a = of_kernel.reshape(len(chosen), 3 * k, -1)
        r = missing.reshape(len(chosen), 3 * k, 1)
        y = np.linalg.solve(a.swapaxes(1, 2) @ a, a.swapaxes(1, 2) @ r)
        return np.asarray(out + (kernel @ y)[..., 0])

    def _kernels(self, place: Ints) -> Floats:
        """(n, N, p + 2) K of triangles at curved edges."""
        arcs, order = self.system.arcs, self.system.order
        assert arcs is not None
        straight, chosen = arcs.straight, arcs.triangles[place]
        s, test = _along_edge(order)
        count = polynomial_count(order - 3)
        rows = [
            np.broadcast_to(orthonormal(order + 1, VERTICES), (len(place), 3, self.tables.first.shape[1]))
        ]
        for edge in range(3):
            xy = arcs.domain.edge_motion(straight.edges[chosen, edge], s)[0]
            rows.append(test.T @ orthonormal(order + 1, straight.reference(xy, chosen)))
        patch, xi = arcs.patch(place, 2 * order)
        psi = orthonormal(order + 1, xi)
        rows.append((psi[..., :count] * patch.weights[..., None]).swapaxes(1, 2) @ psi)
        return _kernel(np.concatenate(rows, axis=1))
