"""Strains at which a shell is free of stress: temperature and initial curvature.

The membrane part goes through the same interpolation as the strain of the displacement, so a shell that
may expand freely stays free of stress.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.shell.frames import components, covariant_to_frame, tangent_frame
from kshell.shell.koiter import Koiter
from kshell.shell.loads import Value, evaluate
from kshell.shell.reference import TWICE, first_derivatives, lagrange
from kshell.shell.vectors import cross, dot

Floats = NDArray[np.float64]


def temperature_strain(
    koiter: Koiter, mean: Value, gradient: Value, expansion: float, triangles: NDArray | None = None
) -> Floats:
    """Initial strains s of a rise of temperature, zero outside `triangles`: (triangle, 2 r).

    A uniform rise scales the shell, which changes its second fundamental form: b - B = strain B.

    Parameters
    ----------
    mean : value
        At the midsurface.
    gradient : value
        Change per length towards the normal.
    expansion : float
        Strain per degree.
    """
    surface, ref = koiter.surface, koiter.surface.reference
    chosen = np.arange(len(surface.mesh.triangles)) if triangles is None else np.asarray(triangles)
    nodes = surface.nodes[surface.triangle_nodes[chosen]]
    result = np.zeros_like(koiter.initial)
    r = ref.strains

    def metric(tables: Floats) -> Floats:
        x1, x2 = surface.tangents(tables, chosen)
        return np.stack([dot(x1, x1), dot(x2, x2), dot(x1, x2)], axis=-1)  # (triangle, point, v)

    points = np.einsum("sn,tnx->tsx", lagrange(surface.order, ref.regge_points), nodes)
    strain = (
        expansion
        * evaluate(mean, points, 1)[..., None]
        * metric(first_derivatives(surface.order, ref.regge_points))
    )
    result[chosen, :r] = np.einsum("rsv,tsv->tr", ref.regge_weights, strain)

    points = np.einsum("qn,tnx->tqx", ref.values, nodes)
    curvature = expansion * evaluate(gradient, points, 1)[..., None] * metric(ref.first)
    x1, x2 = surface.tangents(ref.first, chosen)
    normal = cross(x1, x2) / surface.area_elements[chosen]
    form = np.stack([dot(normal, b) for b in surface.jets(surface.nodes, ref.second, chosen)], axis=-1)
    curvature -= expansion * evaluate(mean, points, 1)[..., None] * form
    result[chosen, r:] = _measured(koiter, curvature, chosen)
    return result


def curvature_strain(koiter: Koiter, curvature: Value, triangles: NDArray | None = None) -> Floats:
    """Initial strains s of a curvature kappa (11, 22, 12) in the frame of recovery.py: (triangle, 2 r).

    kappa > 0 makes the top longer than the bottom. `curvature` has three components: a constant or a
    callable of points.
    """
    surface, ref = koiter.surface, koiter.surface.reference
    chosen = np.arange(len(surface.mesh.triangles)) if triangles is None else np.asarray(triangles)
    points = np.einsum("qn,tnx->tqx", ref.values, surface.nodes[surface.triangle_nodes[chosen]])
    x = surface.tangents(ref.first, chosen)
    e1, e2, _ = tangent_frame(x)
    matrix = np.moveaxis(covariant_to_frame(components(x, e1, e2)), (0, 1), (2, 3))
    local = np.linalg.solve(matrix, (evaluate(curvature, points, 3) * TWICE)[..., None])[..., 0]
    result = np.zeros_like(koiter.initial)
    result[chosen, ref.strains :] = _measured(koiter, local, chosen)
    return result


def _measured(koiter: Koiter, curvature: Floats, triangles: NDArray) -> Floats:
    """l_r = int kappa : tau_r of covariant components (triangle, q, v)."""
    surface, ref = koiter.surface, koiter.surface.reference
    weighted = curvature * TWICE * (ref.weights / surface.area_elements[triangles])[..., None]
    return np.einsum("qk,tqv->tkv", ref.psi, weighted).reshape(len(triangles), -1)
