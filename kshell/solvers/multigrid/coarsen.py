"""A coarser level from a finer one: choose vertices, merge the others into them, keep what triangles remain.

The chosen vertices are an independent set, found along the lines (boundaries, interfaces, supports) first and
between them second, so that lines coarsen to lines. Next to a free line a vertex is chosen only where
otherwise vertices would be left alone: chosen there, it makes flat triangles with the line, whose functions
are so stiff at free edges that they slowed everything down (on the L with free edges 23 iterations instead of
18 at 7e5 unknowns). Next to a supported line it is chosen wherever no chosen neighbour lies off the line:
what moves little or not at all on a support says nothing about the vertices beside it, and gaps there, wide
or narrow as chance had it, made a clamped ring take 15 to 19 iterations instead of 10 to 12. Every other
vertex joins the nearest chosen neighbour, or the one that a neighbour joined. A triangle whose corners join
three different vertices survives between these three. All this follows the edges of the mesh: slits and holes
are never bridged, graded meshes stay graded, thin triangles are coarsened across their thin direction first.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kshell.solvers import kernels
from kshell.solvers.multigrid.cloud import TIE, Bools, Cloud, Turns, neighbours, shuffled
from kshell.solvers.system import Floats, Ints

CORNER = np.sin(np.radians(30.0) / 2) ** 2  # a line that turns by more than 30 degrees has a corner there


@dataclass(frozen=True, eq=False)
class Coarsening:
    """What became of a finer level.

    Attributes
    ----------
    chosen : (coarse vertex,) int array
        Vertices of the finer level that stay.
    region : (vertex,) int array
        The coarse vertex that each vertex of the finer level joined.
    cloud : Cloud
        The coarser level.
    """

    chosen: Ints
    region: Ints
    cloud: Cloud


def coarsen(fine: Cloud, keep_corners: bool = True) -> Coarsening:
    """One level coarser.

    ``keep_corners`` keeps all corners of lines and all ends of supports, for meshes where these are few.
    """
    n = len(fine.points)
    chosen = choose_vertices(fine, keep_corners)
    region = join_regions(fine, chosen)
    ids = np.flatnonzero(chosen)
    number = np.full(n, -1)
    number[ids] = np.arange(len(ids))
    region = number[region]

    corners = region[fine.triangles]
    left = (
        (corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2]) & (corners[:, 0] != corners[:, 2])
    )
    left = np.flatnonzero(left)
    a, b, c = np.sort(corners[left], axis=1).T
    order = np.lexsort((c, b, a)) if fine.stiffness is None else np.lexsort((-fine.stiffness[left], c, b, a))
    new = np.ones(len(order), dtype=bool)
    new[1:] = (
        (a[order[1:]] != a[order[:-1]]) | (b[order[1:]] != b[order[:-1]]) | (c[order[1:]] != c[order[:-1]])
    )
    kept = left[order[new]]
    cloud = Cloud(
        fine.points[ids],
        corners[kept],
        fine.basis[ids],
        fine.mask[ids],
        None if fine.stiffness is None else fine.stiffness[kept],
        shuffled(fine.turn[ids]),
    )
    return Coarsening(ids, region, cloud)


def choose_vertices(fine: Cloud, keep_corners: bool) -> Bools:
    """(vertex,) which vertices stay."""
    n = len(fine.points)
    edges, line = fine.edges
    on_line = np.zeros(n, dtype=bool)
    on_line[edges[line]] = True
    on_line |= ~fine.plain
    along = edges[line & fine.strong]
    strong = edges[fine.strong]

    chosen = np.zeros(n, dtype=bool)
    # a support at a single vertex: no coarse function knows of it unless that vertex stays
    single = ~fine.plain
    single[edges[line]] = False
    chosen |= single
    if keep_corners:
        chosen |= _corners(fine, edges[line]) | _ends_of_supports(fine, edges[line])
    chosen |= independent(fine.turn, along, on_line & ~chosen & ~_touched(n, along, chosen))
    next_to_line = _touched(n, strong, on_line)
    chosen |= independent(fine.turn, strong, ~on_line & ~next_to_line & ~_touched(n, strong, chosen))
    beside_support = ~on_line & next_to_line & ~_touched(n, strong, on_line & fine.plain)
    alone = beside_support & ~_touched(n, strong, chosen & ~on_line)
    chosen |= independent(fine.turn, strong, alone)
    covered = chosen | _touched(n, strong, chosen)
    # who is left can still join what a neighbour joined, unless that lies on a line
    covered |= _touched(n, strong, covered & (chosen | ~on_line))
    chosen |= independent(fine.turn, strong, ~on_line & ~covered)
    return chosen


def _corners(fine: Cloud, lines: Ints) -> Bools:
    """Vertices where a line turns: both eigenvalues of the sum of t t^T over its edges are large."""
    n = len(fine.points)
    t = fine.points[lines[:, 1]] - fine.points[lines[:, 0]]
    t /= np.maximum(np.linalg.norm(t, axis=1), 1e-300)[:, None]
    products = (t[:, 0] ** 2, t[:, 0] * t[:, 1], t[:, 1] ** 2)
    xx, xy, yy = (
        np.bincount(lines[:, 0], product, n) + np.bincount(lines[:, 1], product, n) for product in products
    )
    trace = xx + yy
    smaller = (trace - np.sqrt((xx - yy) ** 2 + 4 * xy**2)) / 2
    return (trace > 0) & (smaller > CORNER * (1 + TIE) * np.maximum(trace, 1e-300))


def _ends_of_supports(fine: Cloud, lines: Ints) -> Bools:
    """The more constrained end of each edge along a line where the kind of support changes."""
    kind = fine.mask.sum(axis=1) + 4 * fine.mask[:, 0]
    change = lines[kind[lines[:, 0]] != kind[lines[:, 1]]]
    first = kind[change[:, 0]] < kind[change[:, 1]]
    ends = np.zeros(len(fine.points), dtype=bool)
    ends[np.where(first, change[:, 0], change[:, 1])] = True
    return ends


def _touched(n: int, edges: Ints, chosen: Bools) -> Bools:
    touched = np.zeros(n, dtype=bool)
    touched[edges[chosen[edges[:, 0]], 1]] = True
    touched[edges[chosen[edges[:, 1]], 0]] = True
    return touched


def independent(turn: Turns, edges: Ints, allowed: Bools) -> Bools:
    """A maximal independent set among the allowed vertices.

    They are taken by turns, in random order (always the same): that leaves 1/4.3 of the vertices of a triangle
    mesh, where the order of a mesh generator leaves up to 1/3.
    """
    n = len(turn)
    ids = np.flatnonzero(allowed)
    ids = ids[np.argsort(turn[ids])]
    result = np.zeros(n, dtype=bool)
    if len(ids) and kernels.cycles is not None:
        kernels.cycles.independent(
            np.ascontiguousarray(edges, dtype=np.int32),
            kernels.contiguous(ids, np.int64),
            allowed.view(np.uint8),
            result.view(np.uint8),
        )
    elif len(ids):
        from pyamg.graph import maximal_independent_set

        number = np.empty(n, dtype=np.int32)
        number[ids] = np.arange(len(ids), dtype=np.int32)
        inside = edges[allowed[edges[:, 0]] & allowed[edges[:, 1]]]
        result[ids[maximal_independent_set(neighbours(len(ids), number[inside]), algo="serial") == 1]] = True
    return result


def join_regions(fine: Cloud, chosen: Bools) -> Ints:
    """(vertex,) the chosen vertex that each joins: the nearest neighbour, for those on a line along it.

    Vertices without a chosen neighbour join the nearest vertex that a neighbour joined.
    """
    edges, line = fine.edges
    region = np.where(chosen, np.arange(len(fine.points)), -1)
    for allowed in (line & fine.strong, fine.strong):
        pairs = np.concatenate([edges[allowed], edges[allowed][:, ::-1]])
        lengths = np.tile(fine.squared_lengths[allowed], 2)
        use = chosen[pairs[:, 1]] & (region[pairs[:, 0]] < 0)
        _join_nearest(region, pairs[use, 0], pairs[use, 1], lengths[use], fine.turn)
    pairs = np.concatenate([edges[fine.strong], edges[fine.strong][:, ::-1]])
    pairs = pairs[(region[pairs[:, 0]] < 0) & (region[pairs[:, 1]] >= 0)]
    joined = region[pairs[:, 1]]
    lengths = np.sum((fine.points[pairs[:, 0]] - fine.points[joined]) ** 2, axis=1)
    _join_nearest(region, pairs[:, 0], joined, lengths, fine.turn)
    return region


def _join_nearest(region: Ints, vertices: Ints, to: Ints, squared_lengths: Floats, turn: Turns) -> None:
    """Let vertices join the nearest of what is offered to them; among equally near ones the turn decides."""
    shortest = np.full(len(region), np.inf)
    np.minimum.at(shortest, vertices, squared_lengths)
    near = np.flatnonzero(squared_lengths <= (1 + TIE) * shortest[vertices])
    near = near[np.argsort(turn[to[near]])[::-1]]
    region[vertices[near]] = to[near]  # the last one written is the first in turn
