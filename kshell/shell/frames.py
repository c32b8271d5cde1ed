"""Orthonormal frames on the surface, and tensors carried between them and the element coordinates.

Symbols
-------
g_a, g^a   tangents X,a and their reciprocals, a = 1, 2
e_i        orthonormal frame of the tangent plane; e_1 is the projection of a given direction
f_ia       g_a . e_i
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.shell.vectors import cross, dot, norm

Floats = NDArray[np.float64]

# below this length the projection of the global x says nothing; about 0.06 degrees from normal
SHORTEST_PROJECTION = 1e-3


def tangent_frame(
    x: Floats, direction: Floats | None = None, angle: Floats | float = 0.0
) -> tuple[Floats, Floats, Floats]:
    """Orthonormal frame e_1, e_2 and normal, each (3, ...), from tangents x (2, 3, ...).

    Parameters
    ----------
    direction : (3,) or (triangle, 3), optional
        Projected onto the tangent plane to give e_1. Without it, and where it is NaN, the global x, or y where x is
        normal. One per triangle where the first axis after the components counts triangles.
    angle : float or array
        Turns the frame about the normal, in radians.

    Raises
    ------
    InputError
        If the given direction is normal to the surface somewhere.
    """
    n = cross(x[0], x[1])
    n = n / norm(n)
    column = (3, *(1,) * (n.ndim - 1))

    def project(axis: Floats) -> Floats:
        a = np.reshape(axis, column)
        return a - n * dot(a, n)

    def default() -> Floats:
        first = project(np.array([1.0, 0.0, 0.0]))
        second = project(np.array([0.0, 1.0, 0.0]))
        return np.where(norm(first) < SHORTEST_PROJECTION, second, first)

    if direction is None:
        first = default()
    else:
        unit = np.asarray(direction, float) / np.linalg.norm(direction, axis=-1, keepdims=True)
        if unit.ndim == 2:
            unit = unit.T.reshape(3, -1, *(1,) * (n.ndim - 2))
            first = unit - n * dot(unit, n)
            first = np.where(np.isnan(first), default(), first) if np.isnan(unit).any() else first
        else:
            first = project(unit)
        size = norm(first)
        if np.min(size) < SHORTEST_PROJECTION:
            bad = np.broadcast_to(unit.reshape(3, *unit.shape[1:] or (1,) * (n.ndim - 1)), n.shape)
            x, y, z = bad.reshape(3, -1)[:, int(np.argmin(size))]
            raise InputError(
                f"the reference direction ({x:g}, {y:g}, {z:g}) of the material "
                "axes is normal to the surface somewhere: choose another direction for that part"
            )
    first = first / norm(first)
    second = cross(n, first)
    c, s = np.cos(angle), np.sin(angle)
    return c * first + s * second, c * second - s * first, n


def components(x: Floats, e1: Floats, e2: Floats) -> Floats:
    """f_ia = e_i . x,a: (2, 2, ...)."""
    return np.stack([np.stack([dot(e, x[0]), dot(e, x[1])]) for e in (e1, e2)])


def contravariant_to_frame(f: Floats) -> Floats:
    """Matrix (3, 3, ...) from (T^11, T^22, T^12) to (T_11, T_22, T_12) in the frame: T_ij = f_ia f_jb T^ab."""
    (a, b), (c, d) = f
    return np.stack(
        [
            np.stack([a * a, b * b, 2 * a * b]),
            np.stack([c * c, d * d, 2 * c * d]),
            np.stack([a * c, b * d, a * d + b * c]),
        ]
    )


def covariant_to_frame(f: Floats) -> Floats:
    """Matrix (3, 3, ...) from strains (E_11, E_22, E_12) along g_a to (E_11, E_22, 2 E_12) in the frame.

    E_ij = h_ia h_jb E_ab with h the inverse transpose of f.
    """
    (a, b), (c, d) = f
    determinant = a * d - b * c
    h = np.stack([np.stack([d, -c]), np.stack([-b, a])]) / determinant
    result = contravariant_to_frame(h)
    result[2] *= 2
    return result


def plane_tangents(normal: Floats) -> tuple[Floats, Floats]:
    """Any two tangents, each (3, ...), whose cross product points along unit normals (3, ...)."""
    across = np.abs(normal[0]) < 0.9
    zero = np.zeros_like(normal[0])
    first = cross(np.stack([np.where(across, 1.0, 0.0), np.where(across, 0.0, 1.0), zero]), normal)
    return first, cross(normal, first)


def in_space(tensor: Floats, axes: Floats) -> Floats:
    """Components xx yy zz yz xz xy (..., 6) in space of plane tensors (..., 3) in frames with rows e_1, e_2, n."""
    a, b = axes[..., 0, :], axes[..., 1, :]
    t11, t22, t12 = (tensor[..., k, None] for k in range(3))
    i, j = np.array([0, 1, 2, 1, 0, 0]), np.array([0, 1, 2, 2, 2, 1])
    return (
        t11 * a[..., i] * a[..., j]
        + t22 * b[..., i] * b[..., j]
        + t12 * (a[..., i] * b[..., j] + b[..., i] * a[..., j])
    )


def in_frame(spatial: Floats, axes: Floats) -> Floats:
    """Components 11, 22, 12 (..., 3) in frames of tensors in space (..., 6)."""
    full = spatial[..., np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])]
    plane = axes[..., :2, :] @ full @ axes[..., :2, :].swapaxes(-1, -2)
    return np.stack([plane[..., 0, 0], plane[..., 1, 1], plane[..., 0, 1]], axis=-1)


def frames_of_normals(normal: Floats) -> Floats:
    """Frames (..., 3, 3), rows e_1, e_2, n, on planes with normals (..., 3) of any length."""
    n = np.moveaxis(normal / np.linalg.norm(normal, axis=-1, keepdims=True), -1, 0)
    return np.moveaxis(np.stack(tangent_frame(np.stack(plane_tangents(n)))), (0, 1), (-2, -1))
