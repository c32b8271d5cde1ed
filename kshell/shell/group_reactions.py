"""Forces and moments of the supports on the shell, group by group, and the check of equilibrium.

What the unknowns lack to equilibrium, r = K x - f, is what supports exert. A node that several supports hold
gives each of them the part in the directions that it holds; directions held twice are shared equally. The
work of r on rigid motions is force and moment, without any differentiation of the solution.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.linear import LinearSolution
from kshell.equilibrium.reduction import Reduction
from kshell.mesh.select import Selection
from kshell.result.deferred import Deferred
from kshell.shell.discretisation import Discretisation
from kshell.shell.supports import ShellSupports
from kshell.solvers.nearest import beside, nearest, picked

Floats = NDArray[np.float64]

ORTHONORMAL = 1e-9


def find_reactions(
    discretisation: Discretisation,
    supports: ShellSupports,
    solution: LinearSolution,
    loads: list[Floats],
    reduction: Reduction,
    moved: Floats | None = None,
    held_back: Floats | None = None,
    loaded: NDArray[np.integer] | None = None,
) -> tuple[Deferred[dict[str, Floats]], float, Deferred[dict[str, Any]]]:
    """Reactions per group, computed when they are looked at, the relative error of equilibrium, and distributions.

    Parameters
    ----------
    reduction : Reduction
        Of all supports together.
    moved : (unknowns,), optional
        Motion to the state in which forces have their arms; the shell at rest if absent.
    held_back : (unknowns,), optional
        Forces that would hold strains without stress back: what a body that is free to take them up is compared with.
    loaded : int array, optional
        Vertices with concentrated loads.

    Returns
    -------
    groups : dict of label to {"force" (3,), "moment" (3,) about the origin of the coordinates}
    balance : float
        What loads and reactions leave over, relative to the largest of them.
    along : dict of label to dict
        Reactions along lines, as of `Result.reaction_along`.
    """
    centre, size = discretisation.extent()
    scaled = discretisation.rigid_motions(centre, size, moved)
    sizes = discretisation.unknown_sizes()
    springs = [
        (group.label, -(group.spring @ solution.x)) for group in supports.groups if group.spring is not None
    ]
    labels = [group.label for group in supports.groups if group.conditions is not None]
    labels += [label for label, _ in springs]

    @cache
    def shared() -> list[tuple[str, Floats]]:
        return _shared(supports, solution.forces, sizes)

    @cache
    def groups() -> dict[str, dict[str, Floats]]:
        about_origin = discretisation.rigid_motions(np.zeros(3), 1.0, moved)
        out: dict[str, dict[str, Floats]] = {}
        for label, forces in [*shared(), *springs]:
            total = about_origin.T @ forces
            entry = out.setdefault(label, {"force": np.zeros(3), "moment": np.zeros(3)})
            entry["force"] = entry["force"] + total[:3]
            entry["moment"] = entry["moment"] + total[3:]
        return out

    by_label = Deferred({label: partial(_entry, groups, label) for label in dict.fromkeys(labels)})
    along = _along(discretisation, supports, shared, springs, moved, loaded)
    # what all supports exert together needs no shares
    held = [_onto(reduction, solution.forces)] if len(labels) > len(springs) else []
    totals = [scaled.T @ forces for forces in [*loads, *held, *(forces for _, forces in springs)]]
    if not totals:
        return by_label, 0.0, along
    # forces and moments of supports count one by one, too: of prescribed motion and initial strains nothing is left of
    # their sum
    motion = np.abs(scaled).max(axis=1)
    acting = [*loads, *held, *([] if held_back is None else [held_back])]
    gross = max((float(np.abs(forces * motion).sum()) for forces in acting), default=0.0)
    largest = max(float(np.abs(totals).max()), gross, 1e-300)
    return by_label, float(np.abs(np.sum(totals, axis=0)).max() / largest), along


def _along(
    discretisation: Discretisation,
    supports: ShellSupports,
    shared: Callable[[], list[tuple[str, Floats]]],
    springs: list[tuple[str, Floats]],
    moved: Floats | None,
    loaded: NDArray[np.integer] | None,
) -> Deferred[dict[str, Any]]:
    """The distribution of each support that holds lines and points only, where the discretisation knows it."""
    distribute = discretisation.distribution()
    if distribute is None:
        return Deferred({})
    places: dict[str, list[Selection | None]] = {}
    for group in supports.groups:
        places.setdefault(group.label, []).append(group.place)
    mesh = discretisation.surface.mesh
    stops = np.zeros(len(mesh.points), dtype=bool)
    stops[[] if loaded is None else loaded] = True

    def members(label: str, dimension: int) -> NDArray[np.integer]:
        none = np.zeros(0, dtype=np.int32)
        chosen = (place for place in places[label] if place is not None and place.dimension == dimension)
        return np.unique(np.concatenate([none, *(place.members for place in chosen)]))

    def find(label: str) -> dict[str, Any]:
        none = np.zeros(discretisation.unknowns)
        forces, elastic = (
            np.sum([none, *(f for name, f in parts if name == label)], axis=0)
            for parts in (shared(), springs)
        )
        found = distribute(members(label, 1), members(label, 0), forces, elastic, stops.copy(), moved)
        return found[0].document(mesh, found[1])

    on_lines = [
        label
        for label, chosen in places.items()
        if all(place is not None and place.dimension < 2 for place in chosen)
    ]
    return Deferred({label: partial(find, label) for label in on_lines})


def _entry(groups: Callable[[], dict[str, dict[str, Floats]]], label: str) -> dict[str, Floats]:
    return groups()[label]


def _shared(supports: ShellSupports, forces: Floats, sizes: Floats) -> list[tuple[str, Floats]]:
    held = [group for group in supports.groups if group.conditions is not None]
    if not held:
        return []
    if len(held) == 1:
        return [(held[0].label, _onto(held[0].conditions.alone(), forces))]
    from scipy.sparse.linalg import LinearOperator, lsqr

    # unknowns of one size, so that what is held twice is shared alike in any units
    if not supports.projectors:
        supports.projectors += [_onto_held(group.conditions.alone(), sizes) for group in held]
    onto = supports.projectors
    touched = np.any([t for _, t in onto], axis=0)
    scaled = np.where(touched, sizes * forces, 0.0)

    # the share is P G^+ r; G, the sum of all P, has few different eigenvalues, so a handful of steps do
    def total(f: Floats) -> Floats:
        return np.asarray(np.sum([project(f) for project, _ in onto], axis=0))

    shape = (len(forces), len(forces))
    operator = LinearOperator(shape, matvec=total, rmatvec=total, dtype=float)
    multiplier = lsqr(operator, scaled, atol=1e-14, btol=1e-14, iter_lim=200)[0]
    return [(group.label, p(multiplier) / sizes) for group, (p, _) in zip(held, onto, strict=True)]


def _onto_held(reduction: Reduction, sizes: Floats) -> tuple[Callable[[Floats], Floats], NDArray[np.bool_]]:
    """The orthogonal projector onto what conditions hold, of forces on unknowns divided by sizes; those it touches.

    I - B (B^T B)^-1 B^T with the basis B of what they leave; almost everywhere it is the identity.
    """
    rows = picked(reduction.basis)
    if rows is not None and (reduction.basis.data == 1.0).all():
        touched = np.ones(len(sizes), dtype=bool)
        touched[rows] = False
        return lambda forces: np.where(touched, forces, 0.0), touched
    basis = (sp.diags(1.0 / sizes) @ reduction.basis).tocsr()
    touched = ~_free(reduction.basis.tocsr())
    some = basis[touched]
    columns = np.flatnonzero(np.diff(some.tocsc().indptr))
    some = some[:, columns].tocsc()
    best = nearest(some)

    def project(forces: Floats) -> Floats:
        out = np.zeros(len(forces))
        mine = forces[touched]
        out[touched] = mine - some @ best(mine)
        return out

    return project, touched


def _onto(reduction: Reduction, forces: Floats) -> Floats:
    """What of forces the conditions take, see `_projector`."""
    if picked(reduction.basis) is not None and (np.abs(reduction.basis.data) == 1.0).all():
        return beside(reduction.basis)(forces)
    return np.asarray(_projector(reduction) @ forces)


def _projector(reduction: Reduction) -> sp.csr_matrix:
    """Onto the directions that conditions hold; onto the unknowns they touch where the basis is not orthonormal."""
    basis = reduction.basis.tocsr()
    count = basis.shape[0]
    gram = basis.T @ basis - sp.identity(basis.shape[1])
    if basis.shape[1] == 0 or abs(gram).max() < ORTHONORMAL:
        out = sp.identity(count) - basis @ basis.T
        out.data[np.abs(out.data) < ORTHONORMAL] = 0.0
        out.eliminate_zeros()
        return out.tocsr()
    return sp.diags((~_free(basis)).astype(float)).tocsr()


def _free(basis: sp.csr_matrix) -> NDArray[np.bool_]:
    """Unknowns that are themselves, and that nothing else follows."""
    alone = np.diff(basis.tocsc().indptr) == 1
    free = np.diff(basis.indptr) == 1
    free[free] = (basis[free].data == 1.0) & alone[basis[free].indices]
    return np.asarray(free)
