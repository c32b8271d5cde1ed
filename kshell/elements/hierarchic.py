"""Polynomials of any degree on the reference triangle: an orthonormal basis, and a hierarchic one for continuity.

Both come from recurrences, and no basis is inverted. The hierarchic functions are the hats of the vertices, bubbles
of the edges and bubbles of the interior; each edge runs from its lower to its higher local vertex. An affine
function is made of hats alone, so that taking it off a function costs no digits of the rest.

Symbols
-------
lambda_i   barycentric coordinates of (0, 0), (1, 0), (0, 1)
psi_k      orthonormal on the reference triangle, by total degree (Dubiner, J. Sci. Comput. 6 (1991) 345-390)
E_k        bubble k of the edge from a to b:  -lambda_a lambda_b P_k^(1,1)(lambda_b - lambda_a) / (k + 1); along the
           edge, at a + s (b - a), its derivative is the Legendre polynomial P_{k+1}(2 s - 1)
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kshell.elements import kernels
from kshell.elements.jets import (
    affine_jet,
    family_table,
    jacobi_family,
    jacobi_jets,
    scaled_legendre_jets,
    times,
)
from kshell.mesh.mesh import EDGE_VERTICES

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

BARYCENTRIC = ((1.0, (-1.0, -1.0)), (0.0, (1.0, 0.0)), (0.0, (0.0, 1.0)))  # constant and gradient of lambda_i


def polynomial_count(degree: int) -> int:
    """Dimension of the polynomials of a degree in the plane; 0 for negative degrees."""
    return (degree + 1) * (degree + 2) // 2 if degree >= 0 else 0


def orthonormal_jets(degree: int, points: Floats) -> Floats:
    """Jets (6, ..., k) of psi at points (..., 2)."""
    x = affine_jet(-1.0, (2.0, 1.0), points)  # lambda_1 - lambda_0
    t = affine_jet(1.0, (0.0, -1.0), points)  # lambda_0 + lambda_1
    y = affine_jet(-1.0, (0.0, 2.0), points)
    along = scaled_legendre_jets(degree, x, t)
    across = [jacobi_jets(degree - i, 2.0 * i + 1.0, 0.0, y) for i in range(degree + 1)]
    out = np.empty((6, *points.shape[:-1], polynomial_count(degree)))
    k = 0
    for total in range(degree + 1):
        for i in range(total, -1, -1):
            norm = np.sqrt((2 * i + 1) * (2 * total + 2))
            out[..., k] = norm * times(along[i], across[i][total - i])
            k += 1
    return out


def orthonormal(degree: int, points: Floats) -> Floats:
    """Values (..., k) of psi at points (..., 2)."""
    points = np.asarray(points, dtype=np.float64)
    i, total, norm = _members(degree)
    x0, x1 = points[..., 0].ravel(), points[..., 1].ravel()
    if kernels.compiled is not None and degree <= kernels.compiled.LARGEST_DEGREE:
        values = np.empty((len(x0), len(i)))
        kernels.compiled.orthonormal(x0, x1, *family_table(degree), norm, values)
        return values.reshape(*points.shape[:-1], len(i))
    x, t = 2.0 * x0 + x1 - 1.0, 1.0 - x1
    along = np.ones((degree + 1, len(x)))  # t^n P_n(x / t)
    if degree > 0:
        along[1] = x
        square = t * t
    for n in range(1, degree):
        along[n + 1] = ((2 * n + 1) / (n + 1)) * x * along[n] - (n / (n + 1)) * square * along[n - 1]
    out = along[i]
    out *= jacobi_family(degree, 2.0 * x1 - 1.0)[total - i, i]
    out *= norm[:, None]
    return np.ascontiguousarray(out.T).reshape(*points.shape[:-1], len(i))


@lru_cache(maxsize=32)
def _members(degree: int) -> tuple[Ints, Ints, Floats]:
    """Degree along x, total degree and norm of each psi."""
    pairs = [(i, total) for total in range(degree + 1) for i in range(total, -1, -1)]
    i, total = np.array(pairs).T
    return i, total, np.sqrt((2.0 * i + 1.0) * (2.0 * total + 2.0))


def hierarchic_jets(degree: int, points: Floats) -> Floats:
    """Jets (6, ..., n) of the hierarchic basis at points (..., 2): vertices, edges (0, 1), (1, 2), (0, 2), interior."""
    hats = [affine_jet(constant, gradient, points) for constant, gradient in BARYCENTRIC]
    parts = list(hats)
    for a, b in EDGE_VERTICES:
        bubble = times(hats[a], hats[b])
        kernels = jacobi_jets(max(degree - 2, 0), 1.0, 1.0, hats[b] - hats[a])
        parts += [times(bubble, kernels[k]) / -(k + 1.0) for k in range(degree - 1)]
    out = np.stack(parts, axis=-1)
    if degree < 3:
        return out
    bubble = times(times(hats[0], hats[1]), hats[2])
    inner = times(bubble[..., None], orthonormal_jets(degree - 3, points))
    return np.concatenate([out, inner], axis=-1)


def hierarchic(degree: int, points: Floats) -> Floats:
    """Values (..., n) of the hierarchic basis at points (..., 2)."""
    return hierarchic_jets(degree, points)[0]
