"""From forms and loads to one reduced system, in blocks of triangles.

Element matrices are made directly in the unknowns (``transform`` carries scaling and supports) and added
into a pattern found beforehand. Peak memory is the matrix and one block.

One thread. Two were tried, with blocks made by a pool and added in order (the same matrix bit by bit). On two busy
cores, runs in turn, the loop over blocks became 1.4 to 1.9 times faster for Morley and 1.1 to 1.2 times (median)
for Argyris. The loop is a third of what comes before Morley's solution, so that less than 1.2 would be won there.
Sparse products in two halves (median 0.3 and 1.0) and two sweeps of PyAMG at once (0.7 and 0.9) gained nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.plate.domain import BLOCK, Domain
from kshell.plate.forms import Bending, Form
from kshell.plate.layout import Layout
from kshell.plate.linear_form import LinearForm
from kshell.plate.pattern import FullPattern, Pattern
from kshell.plate.planes import less_planes
from kshell.plate.reduction import Reduction

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

AT_ONCE = 4_000_000  # entries of element matrices that wait to be added up


@dataclass(frozen=True, eq=False)
class Assembled:
    """A reduced system.

    Attributes
    ----------
    matrix : (unknown, unknown) CSR matrix
        Or a dense array, if that was asked for.
    load : (unknown,) array
        Of the loads alone.
    load_work : float
        Work of the loads on the prescribed motion.
    fixed_load : (unknown,) array
        What prescribed motion contributes to the right-hand side.
    fixed_energy : float
        Twice the energy of the prescribed motion alone, g^T K g.
    """

    matrix: Any
    load: Floats
    load_work: float
    fixed_load: Floats
    fixed_energy: float


def assemble(
    forms: Sequence[Form],
    loads: Sequence[LinearForm],
    domain: Domain,
    reduction: Reduction,
    pattern: Pattern | FullPattern,
) -> Assembled:
    """Sum of forms as a matrix on the unknowns, of loads as a vector, and what prescribed values contribute."""
    data = np.zeros(pattern.entries + 1)
    fixed_load, fixed_energy = np.zeros(reduction.count), 0.0
    load, load_work = np.zeros(reduction.count), 0.0
    quadratic = {id(form) for form in forms}
    for batch in _batches([*forms, *loads], domain, reduction):
        if id(batch.part) not in quadratic:
            add_to(load, batch.unknown, batch.part.vectors(batch.positions, batch.reduced))
            if batch.moved is not None:
                here = batch.part.vectors(batch.positions, batch.moved)
                load_work += float(here.sum())
            continue
        blocks = batch.part.matrices(batch.positions, batch.reduced)
        pattern.add(data, batch.triangles, batch.unknown, blocks)
        fixed_energy += _add_fixed(fixed_load, batch)
    return Assembled(pattern.matrix(data[:-1]), load, load_work, fixed_load, fixed_energy)


def assemble_terms(forms: Sequence[Form], domain: Domain, reduction: Reduction) -> sp.csr_matrix:
    """The matrix of forms that few triangles have, as those along supports, on all unknowns."""
    shape = (reduction.count, reduction.count)
    matrix, waiting = sp.csr_matrix(shape), 0
    parts: list[tuple[Any, Any, Floats]] = []

    def added() -> sp.csr_matrix:
        row, column, data = (np.concatenate(part) for part in zip(*parts, strict=True))
        return matrix + sp.csr_matrix((data, (row, column)), shape=shape)

    for batch in _batches(forms, domain, reduction):
        blocks = batch.part.matrices(batch.positions, batch.reduced)
        unknown, local = batch.unknown, batch.unknown.shape[1]
        row, column = np.repeat(unknown, local, axis=1).ravel(), np.tile(unknown, (1, local)).ravel()
        free = np.flatnonzero((row >= 0) & (column >= 0))
        parts.append((row[free], column[free], blocks.ravel()[free]))
        waiting += len(free)
        if waiting > AT_ONCE:
            matrix, waiting, parts = added(), 0, []
    return added() if parts else matrix


def assemble_fixed(forms: Sequence[Form], domain: Domain, reduction: Reduction) -> tuple[Floats, float]:
    """What prescribed motion contributes to the right-hand side, and twice its energy: of triangles that it moves."""
    load, energy = np.zeros(reduction.count), 0.0
    moved = np.zeros(len(reduction.sizes), dtype=bool)
    moved[reduction.layout.node[np.flatnonzero(reduction.particular)]] = True
    mesh = domain.mesh
    touched = (moved[mesh.triangles] | moved[len(mesh.points) + mesh.triangle_edges]).any(axis=1)
    for batch in _batches(forms, domain, reduction, np.asarray(touched)):
        energy += _add_fixed(load, batch)
    return load, energy


def _add_fixed(load: Floats, batch: _Batch) -> float:
    """Add what prescribed motion of some triangles contributes to the right-hand side; twice its energy."""
    if batch.moved is None:
        return 0.0
    both = batch.part.matrices(batch.positions, np.concatenate([batch.reduced, batch.moved], axis=2))
    add_to(load, batch.unknown, -both[:, :-1, -1])
    return float(both[:, -1, -1].sum())


def assemble_load(loads: Sequence[LinearForm], domain: Domain, reduction: Reduction) -> tuple[Floats, float]:
    """Sum of loads on the unknowns, and their work on the prescribed motion."""
    out, work = np.zeros(reduction.count), 0.0
    for batch in _batches(loads, domain, reduction):
        add_to(out, batch.unknown, batch.part.vectors(batch.positions, batch.reduced))
        if batch.moved is not None:
            work += float(batch.part.vectors(batch.positions, batch.moved).sum())
    return out, work


def assemble_loads(
    groups: Sequence[Sequence[LinearForm]], domain: Domain, reduction: Reduction
) -> tuple[Floats, Floats]:
    """`assemble_load` of several groups of loads in one pass: (group, unknown) vectors and (group,) works."""
    owner = {id(part): number for number, group in enumerate(groups) for part in group}
    out, work = np.zeros((len(groups), reduction.count)), np.zeros(len(groups))
    for batch in _batches([part for group in groups for part in group], domain, reduction):
        number = owner[id(batch.part)]
        add_to(out[number], batch.unknown, batch.part.vectors(batch.positions, batch.reduced))
        if batch.moved is not None:
            work[number] += float(batch.part.vectors(batch.positions, batch.moved).sum())
    return out, work


@dataclass(frozen=True, eq=False)
class _Batch:
    """Some triangles of a form or load, with the transforms to the unknowns.

    Attributes
    ----------
    moved : (n, reference dof, 1) array or None
        Reference degrees of freedom of the prescribed motion; None where it is zero.
    """

    part: Any
    positions: Ints
    triangles: Ints
    reduced: Floats
    unknown: NDArray[np.int32]
    moved: Floats | None


def _batches(
    parts: Sequence[Any], domain: Domain, reduction: Reduction, wanted: NDArray[np.bool_] | None = None
) -> Iterator[_Batch]:
    """All batches; parts that cover the whole plate share the transforms of each block of triangles.

    Of wanted triangles alone, where they are given.
    """
    whole = [part for part in parts if part.everywhere]
    layout, g = reduction.layout, reduction.particular
    any_moved = bool(np.any(g))

    def batches(using: list[Any], positions: Ints, triangles: Ints) -> Iterator[_Batch]:
        dofs = layout.triangle_dofs(triangles)
        transform = layout.element.transformation(domain.affine(triangles))
        reduced, unknown = reduction.local_transform(triangles, dofs, transform)
        moved = transform @ g[dofs][:, :, None] if any_moved else None
        for part in using:
            yield _Batch(part, positions, triangles, reduced, unknown, moved)

    if whole:
        for block in domain.blocks():
            mine = block if wanted is None else block[wanted[block]]
            if len(mine):
                yield from batches(whole, mine, mine)
    for part in parts:
        if not part.everywhere:
            for positions, triangles in chunks(part):
                keep = slice(None) if wanted is None else wanted[triangles]
                if len(triangles[keep]):
                    yield from batches([part], positions[keep], triangles[keep])


class Part:
    """Some triangles of a plate at least, and the batches of what acts on all of it that cover them.

    Parameters
    ----------
    where : (n,) int array
        The triangles.
    """

    def __init__(self, domain: Domain, where: Ints) -> None:
        self.domain, self.where = domain, where
        self.wanted = np.zeros(len(domain.mesh.triangles), dtype=bool)
        self.wanted[where] = True
        self._of_whole: list[tuple[Ints, Ints]] | None = None

    def chunks(self, form: Form | LinearForm) -> Iterator[tuple[Ints, Ints]]:
        """The batches of a form there."""
        if not form.everywhere:
            return chunks(form, self.wanted)
        if self._of_whole is None:
            self._of_whole = list(chunks(form, self.wanted))
            for _, triangles in self._of_whole:
                self.domain.keep(triangles)
        return iter(self._of_whole)


def residual(
    forms: Sequence[Form],
    loads: Sequence[LinearForm],
    reduction: Reduction,
    d: Floats,
    part: Part,
) -> Floats:
    """K d - f on all (physical) degrees of freedom, summed over some triangles only; bending through strains.

    Parameters
    ----------
    d : (dof,) array
        Physical degrees of freedom.
    part : Part
        Triangles to sum over at least; entries of degrees of freedom that others share are incomplete.
    """
    layout, domain = reduction.layout, part.domain
    out = np.zeros(layout.count)
    for form in forms:
        for positions, triangles in part.chunks(form):
            transform = layout.element.transformation(domain.affine(triangles))
            dofs = layout.triangle_dofs(triangles)
            local = less_planes(domain, layout, triangles, d) if isinstance(form, Bending) else d[dofs]
            np.add.at(out, dofs, form.products(positions, transform, transform @ local[:, :, None]))
    for load in loads:
        out -= works(load, layout, part)
    return out


def works(load: LinearForm, layout: Layout, part: Part) -> Floats:
    """f (dof,) of one load, summed as in `residual`."""
    out = np.zeros(layout.count)
    for positions, triangles in part.chunks(load):
        transform = layout.element.transformation(part.domain.affine(triangles))
        np.add.at(out, layout.triangle_dofs(triangles), load.vectors(positions, transform))
    return out


def add_to(out: Floats, unknown: NDArray[np.int32], values: Floats) -> None:
    """Add element vectors (n, local), leaving out fixed columns (unknown = -1)."""
    free = unknown >= 0
    np.add.at(out, unknown[free], values[free])


def chunks(form: Form | LinearForm, wanted: NDArray[np.bool_] | None = None) -> Iterator[tuple[Ints, Ints]]:
    """The batches of a form, restricted to wanted triangles, none longer than a block."""
    for positions, triangles in form.blocks():
        if wanted is not None:
            keep = wanted[triangles]
            if 2 * np.count_nonzero(keep) < len(keep):  # else the maps of the whole batch are at hand
                positions, triangles = positions[keep], triangles[keep]
        if 0 < len(triangles) <= BLOCK:
            yield positions, triangles
            continue
        for start in range(0, len(triangles), BLOCK):
            yield positions[start : start + BLOCK], triangles[start : start + BLOCK]
