"""What the first fundamental form alone knows: Christoffel symbols and Gauss's theorema egregium."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kshell.geometry.components import Floats


def christoffel_symbols(metric: ArrayLike, first: ArrayLike) -> Floats:
    """Christoffel symbols of the second kind from the metric and its derivatives.

    Gamma^k_ij = sum_m g^km (g_mi,j + g_mj,i - g_ij,m) / 2

    Parameters
    ----------
    metric : (..., 2, 2) array
    first : (..., 2, 2, 2) array
        g_ij,k as [k, i, j].

    Returns
    -------
    (..., 2, 2, 2) array, [k, i, j].
    """
    g, d = np.asarray(metric, float), np.asarray(first, float)
    # lowered [m, i, j] = (g_mi,j + g_mj,i - g_ij,m) / 2
    lowered = 0.5 * (np.moveaxis(d, -3, -1) + np.swapaxes(d, -3, -2) - d)
    return np.einsum("...km,...mij->...kij", np.linalg.inv(g), lowered)


def gaussian_curvature(metric: ArrayLike, first: ArrayLike, second: ArrayLike) -> Floats:
    """Gaussian curvature from the first form and its derivatives (Brioschi's formula).

    Parameters
    ----------
    metric : (..., 2, 2) array
    first : (..., 2, 2, 2) array
        g_ij,k as [k, i, j].
    second : (..., 2, 2, 2, 2) array
        g_ij,kl as [k, l, i, j].

    Returns
    -------
    (...) array. Source: do Carmo 4-3, exercise 1 with the determinants of Brioschi 1852.
    """
    g, d, dd = np.asarray(metric, float), np.asarray(first, float), np.asarray(second, float)
    E, F, G = g[..., 0, 0], g[..., 0, 1], g[..., 1, 1]
    E_u, E_v = d[..., 0, 0, 0], d[..., 1, 0, 0]
    F_u, F_v = d[..., 0, 0, 1], d[..., 1, 0, 1]
    G_u, G_v = d[..., 0, 1, 1], d[..., 1, 1, 1]
    corner = -0.5 * dd[..., 1, 1, 0, 0] + dd[..., 0, 1, 0, 1] - 0.5 * dd[..., 0, 0, 1, 1]
    zero = np.zeros_like(E)
    first_matrix = [[corner, 0.5 * E_u, F_u - 0.5 * E_v], [F_v - 0.5 * G_u, E, F], [0.5 * G_v, F, G]]
    second_matrix = [[zero, 0.5 * E_v, 0.5 * G_u], [0.5 * E_v, E, F], [0.5 * G_u, F, G]]
    return (_determinant(first_matrix) - _determinant(second_matrix)) / (E * G - F * F) ** 2


def _determinant(m: list[list[Floats]]) -> Floats:
    (a, b, c), (d, e, f), (g, h, i) = m
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
