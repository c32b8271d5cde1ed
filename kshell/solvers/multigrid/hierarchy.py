"""The multigrid hierarchy of a plate.

Level 0 is the element, level 1 for Argyris the vertex space, all others are reduced-HCT spaces on ever fewer
vertices; every coarse matrix is the Galerkin product R A P with R = P^T. Smoothing is Gauss-Seidel,
forward before and backward after the coarse correction, so the cycle is symmetric. Everything is in double
precision. Single precision was tried: up to 7e5 unknowns the same iterations, 1.3 to 1.8 times faster each, with two
thirds of the memory. But the rounded matrices are indefinite once their smallest eigenvalues, which fall like
(mesh size / length)^4, are below the rounding: the iteration broke down on a cantilever of 1.1e6 unknowns.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import reduce
from operator import matmul
from typing import Any

import numpy as np

from kshell.errors import SolveError
from kshell.solvers.backends import SUPERLU, Singular
from kshell.solvers.checks import free_motion_error, softest_vector
from kshell.solvers.memory import give_back
from kshell.solvers.multigrid.cloud import Cloud
from kshell.solvers.multigrid.coarsen import coarsen
from kshell.solvers.multigrid.cycle import Coarsest
from kshell.solvers.multigrid.galerkin import entries, galerkin
from kshell.solvers.multigrid.interpolate import interpolation
from kshell.solvers.multigrid.levels import Level, RelaxedLevel, level_of
from kshell.solvers.multigrid.smoothers import patch_smoothers
from kshell.solvers.multigrid.vertex_space import element_interpolation
from kshell.solvers.system import PlateSpace

SMALL_LEVELS = 2  # from this level on, with less than a tenth of the unknowns
COARSEST = 3000  # unknowns that are left to the factorisation
STALL = 0.6  # vertices left by a coarsening, as part of those before, above which it does not work
LARGEST_FACTOR = 60_000  # unknowns of a level that is factorised where coarsening stalls
SOFT = 1e-12  # stiffness of a free motion on the coarsest level, where regular ones stay above 1e-8


@dataclass(frozen=True, eq=False)
class Hierarchy:
    """Levels with their smoothers.

    Attributes
    ----------
    levels : tuple of Level
        All but the coarsest.
    coarsest : function
        The solution there.
    vertices : tuple of int
        Vertices of each vertex level.
    notes : tuple of str
        Where coarsening did not work and what was done instead.
    """

    levels: tuple[Level, ...]
    coarsest: Coarsest
    vertices: tuple[int, ...]
    notes: tuple[str, ...]


class Descent:
    """The interpolations from the finest to the coarsest level, one after the other, without any matrix of the problem.

    Parameters
    ----------
    space : PlateSpace

    Attributes
    ----------
    vertices : list of int
        Of each vertex level that has been reached.
    notes : list of str
    cloud : Cloud
        The coarsest of them.
    """

    def __init__(self, space: PlateSpace) -> None:
        self.space, self.cloud = space, Cloud.of_space(space)
        self.vertices, self.notes = [len(self.cloud.points)], list[str]()

    def __iter__(self) -> Iterator[tuple[Any, ...]]:
        """The factors of each, BSR matrices of which nothing is kept here.

        Those of the first level, (unknowns, 3 vertices), have 1 x 3 blocks, all others 3 x 3 blocks, for (w, w_x, w_y)
        of active vertices; columns that the supports forbid are zero.
        """
        first = self.space.element != "argyris"
        if not first:
            yield (element_interpolation(self.space, self.cloud),)
        keep_corners = True
        while 3 * int(self.cloud.active.sum()) > COARSEST:
            fine = self.cloud
            coarsening = coarsen(fine, keep_corners)
            if len(coarsening.chosen) > STALL * len(fine.points) and keep_corners:
                keep_corners = False
                coarsening = coarsen(fine, keep_corners)
            if len(coarsening.chosen) > STALL * len(fine.points) or not coarsening.cloud.active.any():
                self.notes.append(
                    f"coarsening stalls at {len(fine.points)} vertices, {len(coarsening.chosen)} of which could "
                    "not be merged: too many single supported points, or corners of supports"
                )
                break
            factors: tuple[Any, ...] = (interpolation(fine, coarsening),)
            self.cloud = coarsening.cloud
            self.vertices.append(len(self.cloud.points))
            del coarsening
            if first:  # Morley goes from the element to the first coarse level at once
                give_back()
                factors = (element_interpolation(self.space, fine), *factors)
            first = False
            del fine
            yield factors
            give_back()
        if first:
            yield (element_interpolation(self.space, self.cloud),)


def prolongations(space: PlateSpace) -> tuple[list[Any], list[int], list[str], Cloud]:
    """All interpolations of `Descent` at once, as one matrix each.

    Returns
    -------
    matrices : list of BSR matrices
    vertices : list of int
    notes : list of str
    cloud : Cloud
    """
    descent = Descent(space)
    matrices = [reduce(matmul, factors) for factors in descent]
    return matrices, descent.vertices, descent.notes, descent.cloud


def build(matrix: Any, space: PlateSpace) -> Hierarchy:
    """The hierarchy for one matrix.

    Raises
    ------
    SolveError
        If the structure can move freely; `state` is a `FreeMotion` on the unknowns of the matrix.
    """
    import scipy.sparse as sp

    blocks, vertices, notes, cloud = prolongations(space)
    levels: list[Level] = []
    product = sp.bsr_matrix((matrix.data[:, None, None], matrix.indices, matrix.indptr), shape=matrix.shape)
    while blocks:
        coarser = galerkin(product, blocks[0])
        patches = None if levels else patch_smoothers(matrix, space, Cloud.of_space(space))
        # after the product: both at once would be the peak
        levels.append(level_of(product, blocks.pop(0), _sweeps(len(levels)), patches))
        product = coarser
    a = entries(product)
    del product, coarser
    if a.shape[0] <= LARGEST_FACTOR:
        coarsest = _coarse_solver(a, levels, matrix, space)
    else:
        below, coarsest = _aggregate(a, len(levels), cloud)
        levels += below
        notes.append(f"below {a.shape[0]} unknowns smoothed aggregation takes over, with more iterations")
    return Hierarchy(tuple(levels), coarsest, tuple(vertices), tuple(notes))


def _sweeps(level: int) -> int:
    """One on the large levels, two on the small ones.

    There they cost little, and the correction from below is poorer the more interpolations lie above it.
    """
    return 1 if level < SMALL_LEVELS else 2


def _coarse_solver(a: Any, levels: list[Level], matrix: Any, space: PlateSpace) -> Coarsest:
    """The factorised coarsest level; a motion that is free there is free everywhere."""
    try:
        solve, _ = SUPERLU.factorise(a)
    except Singular as error:
        shifted = (a + 1e-12 * _diagonal(a)).tocsr()
        try:
            solve, _ = SUPERLU.factorise(shifted)
        except Singular:
            raise SolveError(f"the coarsest matrix of the multigrid is singular ({error})") from error
    vector, stiffness = softest_vector(a, solve)
    if not stiffness > SOFT:
        for level in levels[::-1]:
            vector = level.interpolate(vector)
        raise free_motion_error(matrix, vector / np.abs(vector).max(), stiffness, space)
    return solve


def _diagonal(a: Any) -> Any:
    import scipy.sparse as sp

    return sp.diags(a.diagonal())


def _aggregate(a: Any, level: int, cloud: Cloud) -> tuple[list[Level], Coarsest]:
    """PyAMG's smoothed aggregation from a level on, with the rigid motions of the plate."""
    from pyamg import smoothed_aggregation_solver

    centred = cloud.points - cloud.points.mean(axis=0)
    rigid = np.zeros((len(centred), 3, 3))  # (vertex, component, motion)
    rigid[:, 0, 0] = 1.0
    rigid[:, 0, 1:] = centred
    rigid[:, 1, 1] = rigid[:, 2, 2] = 1.0
    rigid = cloud.columns.transpose(0, 2, 1) @ rigid
    near_null = rigid[cloud.active].reshape(-1, 3)
    below = smoothed_aggregation_solver(a, B=near_null, coarse_solver="splu")
    *upper, last = below.levels
    levels: list[Level] = [
        RelaxedLevel(each.A.tocsr(), each.P.tocsr(), _sweeps(level + k)) for k, each in enumerate(upper)
    ]
    return levels, lambda rhs: np.asarray(below.coarse_solver(last.A, rhs))
