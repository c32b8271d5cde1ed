"""Stiffness times a deflection through its strains: accurate where the entries of the matrix no longer are.

The entries of the stiffness matrix are of order 1/h^2, the curvature of a smooth deflection makes up h^2 of the
differences between its values: on fine meshes the rounding of the entries alone, eps/h^4, exceeds the error of
Argyris (4e-8 in the centre deflection of a square at 4e5 unknowns). A plane bends nothing, so here the plane
through its three vertices is first taken off the deflection of each triangle. What is left is of order h^2,
and the products are as accurate as the curvatures.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.plate.assembly import assemble
from kshell.plate.pattern import Pattern
from kshell.plate.problem import PlateProblem

Floats = NDArray[np.floating[Any]]


def strain_product(problem: PlateProblem) -> Callable[[Floats], Floats]:
    """The function q -> K q on the unknowns of a plate problem, formed triangle by triangle.

    One product takes about as long as the assembly.
    """
    mesh, layout, domain = problem.mesh, problem.layout, problem.domain
    space = problem.space
    reduction = space.reduction.tocsr()
    springs = [form for form in problem.forms if form is not problem.bending]
    elastic = None
    if springs:
        elastic = assemble(springs, [], domain, problem.reduction, Pattern(problem.reduction)).matrix
    step = layout.per_vertex
    points = domain.points

    def product(q: Floats) -> Floats:
        d = reduction @ q
        out = np.zeros(layout.count)
        for block in domain.blocks():
            dofs = layout.triangle_dofs(block)
            local = d[dofs]
            slope = plane_slopes(points[mesh.triangles[block]], local[:, : 3 * step : step])
            local[:, : 3 * step : step] = 0.0
            if step > 1:
                for k in range(3):
                    local[:, k * step + 1 : k * step + 3] -= slope
            normals = space.edge_normals[mesh.triangle_edges[block]]  # (triangle, edge, xy)
            local[:, 3 * step :] -= np.sum(normals * slope[:, None], axis=2)
            transform = layout.element.transformation(domain.affine(block))
            force = problem.bending.matrices(block, transform) @ local[:, :, None]
            out += np.bincount(dofs.ravel(), force.ravel(), layout.count)
        result = reduction.T @ out
        return result if elastic is None else result + elastic @ q

    return product


def plane_slopes(corners: Floats, values: Floats) -> Floats:
    """Gradients (n, xy) of the planes through values (n, 3) at corners (n, 3, xy)."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    u, v = values[:, 1] - values[:, 0], values[:, 2] - values[:, 0]
    twice_area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return np.stack([u * b[:, 1] - v * a[:, 1], v * a[:, 0] - u * b[:, 0]], axis=1) / twice_area[:, None]
