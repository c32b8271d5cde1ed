"""Rigid links: nodes and edges of a shell that move with a point as one rigid body, for small displacements.

Symbols
-------
R       (unknowns, 6) motions of the unknowns of a link under unit translations of its point and unit turns about it,
        as large as the link (`Discretisation.rigid_motions`); zero elsewhere
q       (6,) translation of the point, and its rotation times that size
F, M    force and moment at the point; their work on q is (F, M / size)

The unknowns of the link move as R q. A force on the unknowns is felt only through R^T f, so the smallest f with
R^T f = (F, M / size) stands for a force at the point.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.reduction import Reduction
from kshell.errors import InputError
from kshell.mesh.select import Selection
from kshell.scene.supports import RigidLink
from kshell.shell.discretisation import Discretisation

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# part of the largest motion, or of a force, that is nothing but rounding
ROUNDING = 1e-9
SMALL_ONLY = (
    "its turns are small ones: rigid links are for small deflections (large_deflection = false), and not for buckling, "
    "prestress or motion with large deflections; a thick, stiff sheet of shell in its place turns as far as it likes"
)


@dataclass
class Link:
    """A rigid link of a shell.

    Attributes
    ----------
    item : RigidLink
    rows : (n,) int
        Its unknowns.
    motions : (n, 6)
        R on its unknowns.
    size : float
    held : set of int
        Components of q that are prescribed.
    value : (6,)
        By how much.
    """

    item: RigidLink
    rows: Ints
    motions: Floats
    size: float
    held: set[int]
    value: Floats

    @classmethod
    def of(cls, item: RigidLink, chosen: Selection, discretisation: Discretisation) -> Link:
        """The link, its point free."""
        rows = np.unique(discretisation.moved_rigidly(chosen, str(item)))
        _, size = discretisation.extent()
        motions = discretisation.rigid_motions(np.array(item.to), size)[rows]
        return cls(item, rows, motions, size, set(), np.zeros(6))

    def hold(self, letters: str, value: Floats) -> None:
        """Prescribe components of the translation (3,) of the point; "r" holds its rotation."""
        for axis, letter in enumerate("xyz"):
            if letter in letters:
                self.held.add(axis)
                self.value[axis] = value[axis]
        if "r" in letters:
            self.held |= {3, 4, 5}

    def force(self, unknowns: int, force: Floats, moment: Floats) -> Floats:
        """(unknowns,) forces that stand for one at the point.

        Raises
        ------
        InputError
            If the link does not carry it, as a straight line of hinged nodes no moment about itself.
        """
        wanted = np.concatenate([force, moment / self.size])
        found = np.linalg.lstsq(self.motions.T, wanted, rcond=ROUNDING)[0]
        if np.abs(self.motions.T @ found - wanted).max() > ROUNDING * np.abs(wanted).max():
            raise InputError(
                f"{self.item}: it cannot carry the force or moment at its point: it turns freely about it"
            )
        out = np.zeros(unknowns)
        out[self.rows] = found
        return out

    def reduction(self, unknowns: int) -> Reduction:
        """What it holds by itself: all of its unknowns."""
        free = np.setdiff1d(np.arange(unknowns), self.rows)
        basis = sp.csc_matrix((np.ones(len(free)), (free, np.arange(len(free)))), shape=(unknowns, len(free)))
        return Reduction(basis, np.zeros(unknowns), np.zeros(0, dtype=np.int32))


@dataclass
class LinkConditions:
    """A link whose point is held, as conditions that reactions are found from."""

    link: Link
    unknowns: int

    def reduction(self) -> Reduction:
        """Everything but the link."""
        return self.link.reduction(self.unknowns)

    def alone(self) -> Reduction:
        """The same; nothing else is tied."""
        return self.reduction()


def with_links(reduction: Reduction, links: list[Link]) -> Reduction:
    """The motions left by supports and rigid links.

    Raises
    ------
    InputError
        If supports, or other links, hold unknowns of a link.
    """
    for link in links:
        reduction = _with_link(reduction, link)
    return reduction


def _with_link(reduction: Reduction, link: Link) -> Reduction:
    basis = reduction.basis.tocsr()
    part = basis[link.rows].tocoo()
    alone = np.diff(basis.tocsc().indptr) == 1
    single = np.bincount(part.row, minlength=len(link.rows)) == 1
    if not single.all() or not alone[part.col].all() or not np.all(part.data == 1.0):
        raise InputError(
            f"{link.item}: a support, a hinge or another link holds nodes of it: hold its point instead, "
            f'for example kind = "clamped" on = "{link.item.name or "NAME"}" with name = "NAME" in the link'
        )
    free = [k for k in range(6) if k not in link.held]
    moved, size, _ = np.linalg.svd(link.motions[:, free], full_matrices=False)
    moved = moved[:, size > ROUNDING * size.max(initial=0.0)]
    given = reduction.given.copy()
    given[link.rows] = link.motions @ link.value
    keep = np.setdiff1d(np.arange(basis.shape[1]), part.col)
    columns = np.tile(np.arange(moved.shape[1]), len(link.rows))
    rows = np.repeat(link.rows, moved.shape[1])
    own = sp.csc_matrix((moved.ravel(), (rows, columns)), shape=(basis.shape[0], moved.shape[1]))
    return Reduction(sp.hstack([basis.tocsc()[:, keep], own]).tocsc(), given, reduction.rotations)
