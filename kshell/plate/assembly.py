"""From forms and loads to one reduced system, in blocks of triangles.

Element matrices are made directly in the unknowns (``transform`` carries scaling and supports) and added
into a pattern found beforehand. Peak memory is the matrix and one block.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.plate.domain import BLOCK, Domain
from kshell.plate.forms import Form
from kshell.plate.loading import LinearForm
from kshell.plate.pattern import Pattern
from kshell.plate.reduction import Reduction

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Assembled:
    """A reduced system.

    Attributes
    ----------
    matrix : (unknown, unknown) CSR matrix
    fixed_load : (unknown,) array
        What prescribed motion contributes to the right-hand side.
    fixed_energy : float
        Twice the energy of the prescribed motion alone, g^T K g.
    """

    matrix: sp.csr_matrix
    fixed_load: Floats
    fixed_energy: float


def assemble_matrix(forms: Sequence[Form], domain: Domain, reduction: Reduction, pattern: Pattern) -> Assembled:
    """Sum of forms as a matrix on the unknowns, and what prescribed values contribute."""
    data = np.zeros(pattern.entries + 1)
    fixed_load = np.zeros(reduction.count)
    fixed_energy = 0.0
    moved = _moved_triangles(reduction)
    for form in forms:
        for positions, triangles in _chunks(form):
            transform = reduction.layout.element.transformation(domain.affine(triangles))
            reduced, unknown = reduction.local_transform(triangles, transform)
            where = pattern.positions(triangles, unknown)
            np.add.at(data, where.ravel(), form.matrices(positions, reduced).ravel())
            if moved is not None and moved[triangles].any():
                here = np.flatnonzero(moved[triangles])
                g = reduction.particular[reduction.layout.triangle_dofs(triangles[here])]
                extra = transform[here] @ g[:, :, None]
                both = form.matrices(positions[here], np.concatenate([reduced[here], extra], axis=2))
                add_to(fixed_load, unknown[here], -both[:, :-1, -1])
                fixed_energy += float(both[:, -1, -1].sum())
    matrix = sp.csr_matrix(
        (data[:-1], pattern.indices, pattern.indptr), shape=(reduction.count, reduction.count)
    )
    matrix.has_sorted_indices = True
    return Assembled(matrix, fixed_load, fixed_energy)


def assemble_load(loads: Sequence[LinearForm], domain: Domain, reduction: Reduction) -> tuple[Floats, float]:
    """Sum of loads on the unknowns, and their work on the prescribed motion."""
    out = np.zeros(reduction.count)
    work = 0.0
    moved = _moved_triangles(reduction)
    for load in loads:
        for positions, triangles in _chunks(load):
            transform = reduction.layout.element.transformation(domain.affine(triangles))
            reduced, unknown = reduction.local_transform(triangles, transform)
            add_to(out, unknown, load.vectors(positions, reduced))
            if moved is not None and moved[triangles].any():
                g = reduction.particular[reduction.layout.triangle_dofs(triangles)]
                work += float(load.vectors(positions, transform @ g[:, :, None]).sum())
    return out, work


def residual(
    forms: Sequence[Form], loads: Sequence[LinearForm], domain: Domain, reduction: Reduction, d: Floats, where: Ints
) -> Floats:
    """K d - f on all (physical) degrees of freedom, summed over some triangles only.

    Parameters
    ----------
    d : (dof,) array
        Physical degrees of freedom.
    where : (n,) int array
        Triangles to sum over; entries of degrees of freedom that other triangles share are incomplete.
    """
    layout = reduction.layout
    out = np.zeros(layout.count)
    wanted = np.zeros(len(layout.mesh.triangles), dtype=bool)
    wanted[where] = True
    for form in forms:
        for positions, triangles in _chunks(form, wanted):
            transform = layout.element.transformation(domain.affine(triangles))
            dofs = layout.triangle_dofs(triangles)
            both = np.concatenate([transform, transform @ d[dofs][:, :, None]], axis=2)
            np.add.at(out, dofs, form.matrices(positions, both)[:, :-1, -1])
    for load in loads:
        for positions, triangles in _chunks(load, wanted):
            transform = layout.element.transformation(domain.affine(triangles))
            np.add.at(out, layout.triangle_dofs(triangles), -load.vectors(positions, transform))
    return out


def add_to(out: Floats, unknown: NDArray[np.int32], values: Floats) -> None:
    """Add element vectors (n, local), leaving out fixed columns (unknown = -1)."""
    free = unknown >= 0
    np.add.at(out, unknown[free], values[free])


def _chunks(form: Form | LinearForm, wanted: NDArray[np.bool_] | None = None):  # type: ignore[no-untyped-def]
    """The batches of a form, restricted to wanted triangles, none longer than a block."""
    for positions, triangles in form.blocks():
        if wanted is not None:
            keep = wanted[triangles]
            positions, triangles = positions[keep], triangles[keep]
        for start in range(0, len(triangles), BLOCK):
            yield positions[start : start + BLOCK], triangles[start : start + BLOCK]


def _moved_triangles(reduction: Reduction) -> NDArray[np.bool_] | None:
    """Which triangles have prescribed values that are not zero; None when there are none."""
    if not np.any(reduction.particular):
        return None
    dofs = reduction.layout.triangle_dofs(slice(None))
    return np.any(reduction.particular[dofs] != 0.0, axis=1)
