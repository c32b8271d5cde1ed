"""Loads and springs that change faster inside triangles and along edges than they are integrated: what is missed.

The elements integrate loads and the stiffness of springs by rules that are exact for polynomials of a degree. Where one
jumps or peaks inside a triangle the same rule on its parts gives another value: the difference is about the error. So
does a rule that is fine beside the rim, where values just inside it are not what those inside are continued by.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.scene.exact_supports import Elastic
from kshell.scene.jump_rules import Rule, just_inside, layered, rules, rules_of_elements
from kshell.scene.load import Load
from kshell.scene.loads import InitialCurvature, InitialStrain, Temperature
from kshell.scene.normals import beside
from kshell.values.varying import is_constant

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

ROUGH = 3e-3  # of the load, from which it is said; less stands in the budget, and in the intervals, alone
STANDS_OUT = (
    1e-3  # of the mean size of the load: what values just inside the rim may differ by from those inside
)
SMOOTH = 1e-9  # of the size of the load: differences that are left to rounding and to smooth loads
MOST = 5_000  # triangles that are looked at together
FEW = 100  # of which most loads act on one


def missed_forces(load: Load | Elastic, space: Mesh, members: Ints, dimension: int) -> tuple[float, Floats]:
    """The share of a load, or of a spring, that is missed or added, and (n,) the size of what is by triangle, or edge.

    The share is that of the resultant, of the moments over the size of its place, or of twice the root of the sum of
    squares of single triangles, which do not cancel: the largest of them.

    Parameters
    ----------
    members : (n,) int array
        Triangles or edges it acts on.
    dimension : int
        2 or 1; at points nothing is missed.
    """
    none = 0.0, np.zeros(len(members))
    if not _varies(load, dimension):
        return none
    cells = space.triangles if dimension == 2 else space.edges
    found = _Missed(load, space, members, space.points[cells[members]])
    if found.gross == 0.0:
        return none
    largest = np.maximum(found.moments, 2.0 * np.sqrt((found.off**2).sum(axis=0)))
    share, single = float(largest.max()) / found.gross, found.off.max(axis=1)
    return (share, single) if share > SMOOTH else none


def _varies(load: Load | Elastic, dimension: int) -> bool:
    """Whether its size is another one from place to place."""
    if dimension == 0 or isinstance(load, Temperature | InitialCurvature | InitialStrain):
        return False
    keys, placing = (("stiffness",), ()) if isinstance(load, Elastic) else (load.scaling, load.placing)
    return bool(placing) or not all(is_constant(getattr(load, key, 0.0)) for key in keys)


def acts_nowhere(load: Load, space: Mesh, members: Ints, dimension: int) -> bool:
    """Whether a load that varies is zero on all triangles or edges it acts on, as a patch beside the surface."""
    if not _varies(load, dimension):
        return False
    cells = space.triangles if dimension == 2 else space.edges
    begin, count = 0, FEW
    while begin < len(members):
        some = members[begin : begin + count]
        if _Missed(load, space, some, space.points[cells[some]]).gross != 0.0:
            return False
        begin, count = begin + count, MOST
    return True


def missed_on_the_way(states: Iterable[Load], space: Mesh, members: Ints) -> float:
    """The share that is missed of a load on triangles at the worst of some times, of what acts when most of it does."""
    missed = gross = 0.0
    for load in states:
        found = _Missed(load, space, members, space.points[space.triangles[members]])
        largest = np.maximum(found.moments, 2.0 * np.sqrt((found.off**2).sum(axis=0)))
        missed, gross = max(missed, float(largest.max())), max(gross, found.gross)
    return missed / gross if missed > SMOOTH * gross else 0.0


def rough_words(load: Load | Elastic, missed: float, dimension: int, moves: bool = False) -> str:
    """What a share that is missed of a load or a spring means, in words; nothing where that is little."""
    if missed < ROUGH:
        return ""
    inside = "triangles" if dimension == 2 else "edges"
    mend = "let edges of the mesh follow its jumps, or make triangles smaller there"
    if moves:
        mend = "make triangles smaller on its way, or let its rim move from edges of the mesh to edges in every step"
    return (
        f"{load} changes faster inside {inside} than it is integrated: about {float(f'{100 * missed:.1g}'):g} % of it "
        f"are missed or added; {mend}"
    )


class _Missed:
    """Differences of two rules.

    Attributes
    ----------
    off : (n, rule) array
        Sizes of the forces of triangles or edges that are missed, by each of `rules_of_elements`.
    moments : (rule,) array
        The largest component of the resultant of these, and of its moments over the size of the place.
    gross : float
        Integral of the size of the load.
    """

    def __init__(self, load: Load | Elastic, space: Mesh, members: Ints, corners: Floats) -> None:
        self.load, self.space = load, space
        k = self.k = corners.shape[1]
        coarse, parts, finest = rules(k)
        self.centre, self.size = corners.mean(axis=(0, 1)), float(np.ptp(corners, axis=(0, 1)).max())
        taken = rules_of_elements(k)
        moments: list[Any] = [np.zeros(1)] * len(taken)
        self.gross, off = 0.0, []
        for begin in range(0, len(corners), MOST):
            chosen, some = members[begin : begin + MOST], corners[begin : begin + MOST]
            sizes = _sizes(some)
            one, _ = self._forces(chosen, some, sizes, coarse)
            two, gross = self._forces(chosen, some, sizes, parts)
            difference = two.sum(axis=1) - one.sum(axis=1)
            least = SMOOTH * gross.max(initial=0.0)
            rough = np.linalg.norm(difference, axis=1) > least
            rough |= self._stands_out(
                chosen, some, one / (sizes[:, None] * coarse[1])[..., None], gross / sizes
            )
            self.gross += float(gross.sum())
            each = np.repeat(np.linalg.norm(difference, axis=1)[:, None], len(taken), axis=1)
            here = np.flatnonzero(rough)
            for part in np.array_split(here, 1 + len(here) * len(parts[1]) // (MOST * len(coarse[1]))):
                where = chosen[part], some[part], sizes[part]
                found, its = self._best(one[part].sum(axis=1), [finest, layered(k)], *where)
                self.gross += float((its - gross[part]).sum())
                for number, rule in enumerate(taken):
                    missed = found - self._moments(rule, *where)[0]
                    each[part, number] = np.linalg.norm(missed[:, 0], axis=1)
                    moments[number] = moments[number] + missed.sum(axis=0)
            off.append(each)
        self.moments = np.array([float(np.abs(of).max()) for of in moments])
        self.off: Floats = np.concatenate(off) if off else np.zeros((0, len(taken)))

    def _stands_out(self, members: Ints, corners: Floats, inside: Floats, mean: Floats) -> NDArray[np.bool_]:
        """(n,) whether values just inside the rim are not those that the values inside are continued by."""
        places, continued = just_inside(self.k)
        beside_rim = self._values(members, np.einsum("qb,nbi->nqi", places, corners))
        off = np.linalg.norm(beside_rim - np.einsum("pq,nqc->npc", continued, inside), axis=2).max(axis=1)
        return np.asarray(off > STANDS_OUT * mean.mean())

    def _best(self, one: Floats, fine: Sequence[Rule], *where: Any) -> tuple[Floats, Floats]:
        """Of the moments by some rules, and their gross, those that are farthest off forces (n, component)."""
        found = [self._moments(rule, *where) for rule in fine]
        best = np.argmax([np.linalg.norm(m[:, 0] - one, axis=1) for m, _ in found], axis=0)
        every = np.arange(len(one))
        return np.stack([m for m, _ in found])[best, every], np.stack([g for _, g in found])[best, every]

    def _moments(self, rule: Rule, members: Ints, corners: Floats, sizes: Floats) -> tuple[Floats, Floats]:
        """(n, 1 + 3, component) forces and their moments over the size of the place, and the gross (n,)."""
        force, gross = self._forces(members, corners, sizes, rule)
        at = (np.einsum("qb,nbi->nqi", rule[0], corners) - self.centre) / self.size
        arm = np.concatenate([np.ones((*at.shape[:2], 1)), at], axis=2)
        return np.asarray(np.einsum("nqc,nqm->nmc", force, arm)), gross

    def _forces(self, members: Ints, corners: Floats, sizes: Floats, rule: Rule) -> tuple[Floats, Floats]:
        """(n, point, component) forces of points, and (n,) integrals of their sizes."""
        places, shares = rule
        at = np.einsum("qb,nbi->nqi", places, corners)
        force = self._values(members, at) * (sizes[:, None] * shares)[..., None]
        return force, np.linalg.norm(force, axis=2).sum(axis=1)

    def _values(self, members: Ints, points: Floats) -> Floats:
        """(n, point, component)."""
        load: Any = self.load
        places = points
        if getattr(load, "needs_normal", False):
            triangles = members if self.k == 3 else self.space.edge_owner[members, 0]
            flat = beside(self.space, triangles, points.reshape(-1, 3))
            places = flat.reshape(*points.shape[:2], 6)
        values = load.stiffness_at(places) if isinstance(load, Elastic) else load.at(places)
        return np.asarray(values if values.ndim == 3 else values[..., None])


def _sizes(corners: Floats) -> Floats:
    """(n,) areas of triangles, or lengths of edges."""
    a = corners[:, 1] - corners[:, 0]
    if corners.shape[1] == 2:
        return np.asarray(np.linalg.norm(a, axis=1))
    return np.asarray(0.5 * np.linalg.norm(np.cross(a, corners[:, 2] - corners[:, 0]), axis=1))
