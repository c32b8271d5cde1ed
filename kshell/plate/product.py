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
from kshell.plate.planes import less_planes
from kshell.plate.problem import PlateProblem

Floats = NDArray[np.floating[Any]]


def strain_product(problem: PlateProblem) -> Callable[[Floats], Floats]:
    """The function q -> K q on the unknowns of a plate problem, (q,) or (q, n), formed triangle by triangle.

    One product takes about as long as the assembly; those of several columns share what belongs to the triangles.
    """
    layout, domain = problem.layout, problem.domain
    reduction = problem.space.reduction.tocsr()
    springs = [form for form in problem.forms if form is not problem.bending]
    elastic = None
    if springs:
        elastic = assemble(springs, [], domain, problem.reduction, Pattern(problem.reduction)).matrix

    def product(q: Floats) -> Floats:
        columns = q.reshape(len(q), -1)
        motions = np.ascontiguousarray((reduction @ columns).T)
        out = np.zeros((layout.count, len(motions)))
        for block in domain.blocks():
            dofs = layout.triangle_dofs(block)
            transform = layout.element.transformation(domain.affine(block))
            local = np.stack([less_planes(domain, layout, block, d) for d in motions], axis=2)
            strained = transform @ local  # (triangle, reference dof, column)
            for number in range(len(motions)):
                force = problem.bending.products(block, transform, strained[:, :, number : number + 1])
                out[:, number] += np.bincount(dofs.ravel(), force.ravel(), layout.count)
        result = reduction.T @ out
        if elastic is not None:
            result += elastic @ columns
        return np.asarray(result).reshape(q.shape)

    return product
