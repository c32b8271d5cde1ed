"""Principal curvatures and directions from a pair of fundamental forms.

Symbols
-------
E F G     first form                L M P     second form
p q r     second form in the orthonormal basis e1 = x_u / |x_u|, e2 = N x e1, in which it stays symmetric
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kshell.geometry.components import Component, Floats, Vector, full


def in_orthonormal_basis(first: Vector, second: Vector, area: Component) -> list[Component]:
    """p, q, r from (E, F, G), (L, M, P) and the area element sqrt(E G - F^2)."""
    E, F, _ = first
    L, M, P = second
    p = L / E
    return [p, (M - F * p) / area, (E * P - 2.0 * F * M + F * F * p) / area**2]


def principal_curvatures(form: Vector, shape: tuple[int, ...]) -> Floats:
    """(*shape, 2) the eigenvalues k1 >= k2 of p, q, r, without the cancellation of sqrt(H^2 - K)."""
    p, q, r = form
    half = np.hypot(0.5 * (p - r), q)
    out = np.empty((*shape, 2))
    out[..., 0] = 0.5 * (p + r) + half
    out[..., 1] = 0.5 * (p + r) - half
    return out


def principal_directions(form: Vector, e1: ArrayLike, normal: ArrayLike) -> Floats:
    """(..., 2, 3) unit vectors d1, d2 with d1 x d2 = N.

    Parameters
    ----------
    form : p, q, r
    e1, normal : (..., 3) arrays
        The first basis vector and the unit normal.
    """
    p, q, r = form
    e1, normal = np.asarray(e1, float), np.asarray(normal, float)
    angle = full(0.5 * np.arctan2(2.0 * q, p - r), e1.shape[:-1])[..., None]
    e2 = np.cross(normal, e1)
    d1 = np.cos(angle) * e1 + np.sin(angle) * e2
    return np.stack([d1, np.cross(normal, d1)], axis=-2)


def tangent_axis(normal: Floats) -> Floats:
    """(n, 3) some unit vector normal to each of the (n, 3) unit vectors."""
    axis = np.eye(3)[np.argmin(np.abs(normal), axis=-1)]
    across = axis - np.sum(axis * normal, axis=-1, keepdims=True) * normal
    return across / np.linalg.norm(across, axis=-1, keepdims=True)


def projected(tensor: Floats, e1: Floats, e2: Floats) -> list[Component]:
    """p, q, r of (n, 3, 3) tensors in the plane of the (n, 3) vectors e1, e2."""

    def part(a: Floats, b: Floats) -> Floats:
        return np.asarray(np.einsum("ni,nij,nj->n", a, tensor, b))

    return [part(e1, e1), part(e1, e2), part(e2, e2)]
