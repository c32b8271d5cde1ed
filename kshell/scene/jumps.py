"""Loads and springs that change faster inside triangles and along edges than they are integrated: what is missed.

The elements integrate loads and the stiffness of springs by rules that are exact for polynomials of a degree. Where one
jumps or peaks inside a triangle the same rule on its parts gives another value: the difference is about the error.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.elements.quadrature import interval_rule, triangle_rule
from kshell.mesh.mesh import Mesh
from kshell.scene.exact_supports import Elastic
from kshell.scene.load import Load
from kshell.scene.loads import InitialCurvature, InitialStrain, Temperature
from kshell.scene.normals import beside
from kshell.values.varying import is_constant

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]
Rule = tuple[Floats, Floats]  # barycentric coordinates (q, 3 or 2) and weights (q,) of sum 1

DEGREE = 6  # of the rules of the elements, at least
ROUGH = 3e-3  # of the load, from which it is said; less stands in the budget, and in the intervals, alone
SMOOTH = 1e-9  # of the size of the load: differences that are left to rounding and to smooth loads
MOST = 5_000  # triangles that are looked at together
FEW = 100  # of which most loads act on one

# corners of the four parts of a triangle and of an edge, in their barycentric coordinates
PARTS = {
    3: 0.5
    * np.array(
        [
            [[2, 0, 0], [1, 1, 0], [1, 0, 1]],
            [[1, 1, 0], [0, 2, 0], [0, 1, 1]],
            [[1, 0, 1], [0, 1, 1], [0, 0, 2]],
            [[1, 1, 0], [0, 1, 1], [1, 0, 1]],
        ]
    ),
    2: 0.25 * np.array([[[4, 0], [3, 1]], [[3, 1], [2, 2]], [[2, 2], [1, 3]], [[1, 3], [0, 4]]]),
}


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
    single = np.linalg.norm(found.off, axis=1)
    largest = max(float(np.abs(found.moments).max()), 2.0 * float(np.sqrt((single**2).sum())))
    share = largest / found.gross
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


def rough_words(load: Load | Elastic, missed: float, dimension: int) -> str:
    """What a share that is missed of a load or a spring means, in words; nothing where that is little."""
    if missed < ROUGH:
        return ""
    inside = "triangles" if dimension == 2 else "edges"
    return (
        f"{load} changes faster inside {inside} than it is integrated: about {float(f'{100 * missed:.1g}'):g} % of it "
        "are missed or added; let edges of the mesh follow its jumps, or make triangles smaller there"
    )


class _Missed:
    """Differences of two rules.

    Attributes
    ----------
    off : (n, component) array
        Of the forces of triangles or edges.
    moments : (component, 1 + 3) array
        Of the resultant, and of its moments over the size of the place.
    gross : float
        Integral of the size of the load.
    """

    def __init__(self, load: Load | Elastic, space: Mesh, members: Ints, corners: Floats) -> None:
        self.load, self.space = load, space
        k = self.k = corners.shape[1]
        rules = _rules(k)
        centre, size = corners.mean(axis=(0, 1)), float(np.ptp(corners, axis=(0, 1)).max())
        self.gross, moments, off = 0.0, np.zeros(1), []
        for begin in range(0, len(corners), MOST):
            chosen, some = members[begin : begin + MOST], corners[begin : begin + MOST]
            sizes = _sizes(some)
            one, _ = self._forces(chosen, some, sizes, rules[0])
            two, gross = self._forces(chosen, some, sizes, rules[1])
            difference = two.sum(axis=1) - one.sum(axis=1)
            least = SMOOTH * gross.max(initial=0.0)
            rough = np.flatnonzero(np.linalg.norm(difference, axis=1) > least)
            self.gross += float(gross.sum())
            for part in np.array_split(rough, 1 + len(rough) * len(PARTS[k]) // MOST):
                fine, its = self._forces(chosen[part], some[part], sizes[part], rules[2])
                self.gross += float(its.sum() - gross[part].sum())
                difference[part] = fine.sum(axis=1) - one[part].sum(axis=1)
                for force, (places, _), sign in ((fine, rules[2], 1.0), (one[part], rules[0], -1.0)):
                    at = np.einsum("qb,nbi->nqi", places, some[part])
                    arm = np.concatenate([np.ones((*at.shape[:2], 1)), (at - centre) / size], axis=2)
                    moments = moments + sign * np.einsum("nqc,nqm->cm", force, arm)
            off.append(difference)
        self.moments = np.atleast_2d(moments)
        self.off: Floats = np.concatenate(off) if off else np.zeros((0, 1))

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


@lru_cache(maxsize=2)
def _rules(k: int) -> list[Rule]:
    """The rule of a triangle (k = 3) or an edge (2), of its parts and of theirs."""
    if k == 3:
        inner, shares = triangle_rule(DEGREE)
        places, shares = np.column_stack([1.0 - inner.sum(axis=1), inner]), 2.0 * shares
    else:
        s, shares = interval_rule(DEGREE // 2 + 1)
        places = np.column_stack([1.0 - s, s])
    out = [(places, shares)]
    for _ in range(2):
        places, shares = out[-1]
        places = np.einsum("qk,pkb->pqb", places, PARTS[k]).reshape(-1, k)
        out.append((places, np.tile(shares, len(PARTS[k])) / len(PARTS[k])))
    return out
