"""Loads and springs that change faster inside triangles and along edges than they are integrated: what is missed.

The elements integrate loads and the stiffness of springs by rules that are exact for polynomials of a degree. Where one
jumps or peaks inside a triangle the same rule on its parts gives another value: the difference is about the error. So
does a rule that is fine beside the rim, where values just inside it are not what those inside are continued by.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.scene.exact_supports import Elastic
from kshell.scene.jump_rules import DEGREES, Look, beyond_parts, just_inside, looks
from kshell.scene.load import Load
from kshell.scene.loads import InitialCurvature, InitialStrain, Temperature
from kshell.scene.normals import beside
from kshell.values.degree import IN_SPACE, polynomial_degree
from kshell.values.varying import is_constant

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

ROUGH = 3e-3  # of the load, from which it is said; less stands in the budget, and in the intervals, alone
UNSEEN = 0.3 * ROUGH  # of the mean size, what parts may miss of smooth formulas where words alone are wanted
STANDS_OUT = (
    1e-3  # of the mean size of the load: what values just inside the rim may differ by from those inside
)
SMOOTH = 1e-9  # of the size of the load: differences that are left to rounding and to smooth loads
MOST = 5_000  # triangles that are looked at together
FEW = 100  # of which most loads act on one


def missed_forces(
    load: Load | Elastic, space: Mesh, members: Ints, dimension: int, words_only: bool = False
) -> tuple[float, Floats]:
    """The share of a load, or of a spring, that is missed or added, and (n,) the size of what is by triangle, or edge.

    The share is that of the resultant, of the moments over the size of its place, or of twice the root of the sum of
    squares of single triangles, which do not cancel: the largest of them.

    Parameters
    ----------
    members : (n,) int array
        Triangles or edges it acts on.
    dimension : int
        2 or 1; at points nothing is missed.
    words_only : bool
        Whether what is missed of a smooth formula may be known to `UNSEEN` of the load, as `rough_words` need it.
    """
    none = 0.0, np.zeros(len(members))
    if not _varies(load, dimension) or _is_exact(load):
        return none
    cells = space.triangles if dimension == 2 else space.edges
    found = _Missed(load, space, members, space.points[cells[members]], words_only)
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


def _is_exact(load: Load | Elastic) -> bool:
    """Whether all rules integrate it exactly: a polynomial of the place, whatever the mesh."""
    if not isinstance(load, Load) or type(load).at is not Load.at or load.needs_normal:
        return False
    degrees = [polynomial_degree(getattr(load, key, 0.0), IN_SPACE) for key in load.scaling]
    return all(degree is not None and degree <= DEGREES[0] for degree in degrees)


def acts_nowhere(load: Load, space: Mesh, members: Ints, dimension: int) -> bool:
    """Whether a load that varies is zero on all triangles or edges it acts on, as a patch beside the surface."""
    if not _varies(load, dimension):
        return False
    cells = space.triangles if dimension == 2 else space.edges
    begin, count = 0, FEW
    while begin < len(members):
        some = members[begin : begin + count]
        corners = space.points[cells[some]]
        if np.any(_values(load, space, _beside(space, some, dimension), corners.mean(axis=1)[:, None])):
            return False
        if _Missed(load, space, some, corners).gross != 0.0:
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

    def __init__(
        self,
        load: Load | Elastic,
        space: Mesh,
        members: Ints,
        corners: Floats,
        words_only: bool = False,
    ) -> None:
        self.load, self.space = load, space
        k = self.k = corners.shape[1]
        first, second = looks(k)
        whole, _, rim = first.slices
        centre, size = corners.mean(axis=(0, 1)), float(np.ptp(corners, axis=(0, 1)).max())
        moments: Any = 0.0  # (rule, force and arms, component)
        self.gross, off, taken = 0.0, [], len(second.slices) - 2

        def sums(look: Look, at: Floats, values: Floats, sizes: Floats) -> Floats:
            """(n, force and arms, rule, component)."""
            arm = np.ones((len(at), 4, at.shape[1]))
            arm[:, 1:] = ((at - centre) / size).swapaxes(1, 2)
            return np.asarray(
                (look.by_rule @ (arm[..., None] * values[:, None])) * sizes[:, None, None, None]
            )

        for begin in range(0, len(corners), MOST):
            chosen, some = members[begin : begin + MOST], corners[begin : begin + MOST]
            sizes = (space.areas if k == 3 else space.edge_lengths)[chosen]
            places = first.places @ some
            values = self._values(chosen, places)
            one, of_parts = (sizes[:, None] * (first.by_rule[rule] @ values) for rule in range(2))
            gross = sizes * (_lengths(values) @ first.by_rule[1])
            missed = _lengths(of_parts - one)
            rough = missed > SMOOTH * gross.max(initial=0.0)
            continued = just_inside(k)[1] @ values[:, whole]
            beside_rim = _lengths(values[:, rim] - continued).max(axis=1)
            rough |= beside_rim > STANDS_OUT * (gross / sizes).mean()
            self.gross += float(gross.sum())
            each = np.repeat(missed[:, None], taken, axis=1)
            if words_only and rough.any():
                parts_tell = rough & (_unseen(load, some) <= UNSEEN * (gross / sizes).mean())
                if parts_tell.any():
                    found = sums(first, places[parts_tell], values[parts_tell], sizes[parts_tell])
                    moments = moments + (found[:, :, 1] - found[:, :, 0]).sum(axis=0)[None]
                    rough &= ~parts_tell
            here = rough.nonzero()[0]
            count = -(-len(here) // max(1, MOST * FEW // len(second.shares)))
            for turn in range(count):
                part = here[turn::count]
                at = second.places @ some[part]
                values = self._values(chosen[part], at)
                of_rules = sums(second, at, values, sizes[part])
                # of two rules that are fine, the one that is farther off
                farther = _lengths(of_rules[:, 0, 1] - one[part]) > _lengths(of_rules[:, 0, 0] - one[part])
                found = np.where(farther[:, None, None], of_rules[:, :, 1], of_rules[:, :, 0])
                both = sizes[part, None] * (_lengths(values) @ second.by_rule[:2].T)
                self.gross += float((np.where(farther, both[:, 1], both[:, 0]) - gross[part]).sum())
                left = found[:, :, None] - of_rules[:, :, 2:]
                each[part] = _lengths(left[:, 0])
                moments = moments + left.sum(axis=0).swapaxes(0, 1)
            off.append(each)
        self.moments: Floats = (
            np.abs(moments).max(axis=(1, 2)) * np.ones(taken) if np.ndim(moments) else np.zeros(taken)
        )
        self.off: Floats = np.concatenate(off) if off else np.zeros((0, taken))

    def _values(self, members: Ints, points: Floats) -> Floats:
        """(n, point, component)."""
        return _values(self.load, self.space, _beside(self.space, members, self.k - 1), points)


def _beside(space: Mesh, members: Ints, dimension: int) -> Ints:
    """The triangles, or one at each edge."""
    return members if dimension == 2 else space.edge_owner[members, 0]


def _values(load: Any, space: Mesh, triangles: Ints, points: Floats) -> Floats:
    """(n, point, component) at points (n, point, 3) of triangles."""
    places = points
    if getattr(load, "needs_normal", False):
        flat = beside(space, triangles, points.reshape(-1, 3))
        places = flat.reshape(*points.shape[:2], 6)
    values = load.stiffness_at(places) if isinstance(load, Elastic) else load.at(places)
    return np.asarray(values if values.ndim == 3 else values[..., None])


def _unseen(load: Any, corners: Floats) -> Floats:
    """(n,) what parts may miss of a load over the size of its triangles or edges (n, k, 3); infinite if not known."""
    plain = isinstance(load, Load) and type(load).at is Load.at and not load.needs_normal
    found = beyond_parts(load.value, corners) if plain else None
    return np.full(len(corners), np.inf) if found is None else found


def _lengths(vectors: Floats) -> Floats:
    """(...) lengths of vectors (..., component)."""
    if vectors.shape[-1] == 1:
        return np.abs(vectors[..., 0])
    return np.asarray(np.sqrt((vectors * vectors).sum(axis=-1)))
