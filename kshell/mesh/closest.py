"""The point of a mesh closest to a point in space, for meshes of order 1 and 2, whatever the sizes of the triangles.

Every triangle lies in a ball, so it is at least as far away as the ball: all triangles whose balls come nearer than
the closest point known so far are looked at, and no others, and the answer is the closest point of the whole mesh. A
point on the surface is in the balls of its triangles; for others the balls are searched through k-d trees, one for each
class of sizes, so that one large triangle does not widen the search among the small ones.

A triangle of order 2 differs from the flat one between its corners by the bumps 4 L_i L_j of its edges, by no more
than 4/3 of the largest distance of a mid-edge node from its chord. Where f (feet.py) is convex on the whole triangle
Newton's method finds its closest point; this is known beforehand for points nearer than its radius of curvature. For
others the triangle is divided, and parts whose bound excludes them are left out, until the bumps are negligible.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.mesh import feet, quadratic
from kshell.mesh.mesh import Mesh
from kshell.mesh.near import in_balls

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FEW = 4096  # pairs of a point and a triangle that are all looked at
CLASS = 4.0  # ratio of the largest and the smallest ball of a class
BUMPS = 4.0 / 3.0  # largest sum of 4 L_i L_j
FIRST = 8  # balls asked for at once
MANY = 400_000  # pairs held at once
DIVISIONS = 6  # of triangles that bend too much: their bumps shrink by 4 each time, to 1 / 4096
TIE = 1e-12  # differences of distance, against the size of the mesh, that are rounding
# corners of the four parts of a triangle, in its barycentric coordinates: (part, corner, coordinate)
PARTS = 0.5 * np.array(
    [
        [[2, 0, 0], [1, 1, 0], [1, 0, 1]],
        [[1, 1, 0], [0, 2, 0], [0, 1, 1]],
        [[1, 0, 1], [0, 1, 1], [0, 0, 2]],
        [[1, 1, 0], [0, 1, 1], [1, 0, 1]],
    ]
)
KEPT, MANY_POINTS = 16, 1000  # times that points are asked for, which are kept; of more points one
MIDDLES = np.array([[0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]])


class Nearest(NamedTuple):
    """Points of a surface.

    Attributes
    ----------
    triangles : (n,)
    xi : (n, 2) reference coordinates
    x : (n, 3)
    distance : (n,) from the points asked for
    """

    triangles: Ints
    xi: Floats
    x: Floats
    distance: Floats


class Locator:
    """Closest points of triangles in space.

    Parameters
    ----------
    nodes : (triangle, 3 or 6, 3) array
        Corners, and of triangles of order 2 the nodes on the edges 01, 12, 02.

    Where several triangles are equally near, as along a common edge, the one with the least centroid is taken (by x,
    then y, then z): the answer does not depend on how the mesh is numbered.
    """

    def __init__(self, nodes: Floats) -> None:
        self.nodes = np.ascontiguousarray(np.moveaxis(nodes, 0, 2), dtype=float)  # (node, 3, triangle)
        self.tie = TIE * float(np.linalg.norm(np.ptp(nodes.reshape(-1, 3), axis=0)))
        centroids = self.nodes[:3].mean(axis=0)
        self.rank = np.empty(len(nodes), dtype=np.int64)
        self.rank[np.lexsort(centroids[::-1])] = np.arange(len(self.rank))
        self.bump, self.reach = _bends(self.nodes)
        self.centre, self.radius = _balls(self.nodes, self.bump)
        self._classes: list[tuple[Ints, float, object]] | None = None
        self._known: dict[bytes, Nearest] = {}

    @classmethod
    def on(cls, mesh: Mesh, group: str, points: Floats) -> Nearest:
        """The closest points of a surface group to (n, 3) points; triangles are numbered as in the mesh."""
        chosen = np.asarray(mesh.groups[group].members, dtype=np.int64)
        nodes = (
            mesh.points[mesh.triangles]
            if mesh.midpoints is None
            else quadratic.node_points(mesh, mesh.midpoints)
        )
        found = cls(nodes[chosen]).find(points)
        return found._replace(triangles=chosen[found.triangles])

    @classmethod
    def of(cls, mesh: Mesh) -> Locator:
        """Of a mesh of order 1 or 2."""
        return cls(
            mesh.points[mesh.triangles]
            if mesh.midpoints is None
            else quadratic.node_points(mesh, mesh.midpoints)
        )

    def find(self, points: Floats) -> Nearest:
        """The closest points to (n, 3) points; asked again for some of the last ones, as of probes, it knows them."""
        points = np.asarray(points, dtype=float)
        key = points.tobytes()
        if key not in self._known:
            if len(self._known) >= KEPT or len(points) > MANY_POINTS:
                self._known.clear()
            self._known[key] = self._find(points)
        return self._known[key]

    def _find(self, points: Floats) -> Nearest:
        n_triangles = len(self.rank)
        p = np.ascontiguousarray(points.T)
        if p.shape[1] * n_triangles <= FEW:
            of, triangle = np.divmod(np.arange(p.shape[1] * n_triangles), n_triangles)
            return self._closest(p, of, triangle)
        step = max(1, MANY // 64)
        parts = [
            self._closest(p[:, k : k + step], *self._candidates(p[:, k : k + step]))
            for k in range(0, p.shape[1], step)
        ]
        return Nearest(*(np.concatenate(column) for column in zip(*parts, strict=True)))

    def _candidates(self, p: Floats) -> tuple[Ints, Ints]:
        """Pairs of a point and a triangle that may be the closest: of points on the surface those whose balls hold it.

        Trees are made for points beside the surface only, and only for many.
        """
        if self._classes is not None:
            return self._near(p)
        triangle, of = in_balls(p.T, self.centre.T, self.radius * (1 + TIE) + self.tie)
        upper = np.full(p.shape[1], np.inf)
        if len(of):
            np.minimum.at(upper, of, self._distance(p, of, triangle)[0])
        beside = np.flatnonzero(upper > self.tie)
        if not len(beside):
            return of, triangle
        few = len(beside) * len(self.rank) <= MANY
        more_of, more = (self._near_all if few else self._near)(p[:, beside])
        here = upper[of] <= self.tie
        return np.concatenate([of[here], beside[more_of]]), np.concatenate([triangle[here], more])

    def _near_all(self, p: Floats) -> tuple[Ints, Ints]:
        """As `_near`, of all balls: for a few points that is quicker than to sort the balls."""
        centre = self.centre
        distance = np.sqrt(np.sum([(p[x][:, None] - centre[x]) ** 2 for x in range(3)], axis=0))
        nearest = np.argmin(distance - self.radius, axis=1)
        upper = self._distance(p, np.arange(p.shape[1]), nearest)[0]
        of, triangle = np.nonzero(distance - self.radius <= upper[:, None] + self.tie)
        return of, triangle

    def _near(self, p: Floats) -> tuple[Ints, Ints]:
        """Pairs of a point and a triangle whose ball comes as near as the closest triangle may be."""
        if self._classes is None:
            self._classes = self._trees()
        upper = np.full(p.shape[1], np.inf)
        every = np.arange(p.shape[1])
        for which, _, tree in self._classes:
            triangle = which[tree.query(p.T)[1]]  # type: ignore[attr-defined]
            upper = np.minimum(upper, self._distance(p, every, triangle)[0])
        found_of, found = [], []
        for which, largest, tree in self._classes:
            todo, k = every, min(FIRST, len(which))
            while len(todo):
                block = todo[: max(1, MANY // k)]
                distance, place = tree.query(p[:, block].T, k=k)  # type: ignore[attr-defined]
                distance, triangle = distance.reshape(len(block), k), which[place.reshape(len(block), k)]
                whole = (distance[:, -1] > upper[block] + largest) | (k == len(which))
                here = (distance - self.radius[triangle] <= upper[block, None] + self.tie) & whole[:, None]
                row, column = np.nonzero(here)
                found_of.append(block[row])
                found.append(triangle[row, column])
                todo = np.concatenate([todo[len(block) :], block[~whole]])
                k = k if whole.all() else min(4 * k, len(which))
        return np.concatenate(found_of), np.concatenate(found)

    def _trees(self) -> list[tuple[Ints, float, object]]:
        """Triangles by the size of their balls: numbers, largest radius, k-d tree of the centres."""
        from scipy.spatial import cKDTree

        size = np.floor(np.log(self.radius / self.radius.min() * (1 + 1e-9)) / np.log(CLASS)).astype(int)
        out: list[tuple[Ints, float, object]] = []
        for number in np.unique(size):
            which = np.flatnonzero(size == number)
            out.append((which, float(self.radius[which].max()), cKDTree(self.centre[:, which].T)))
        return out

    def _distance(self, p: Floats, of: Ints, triangle: Ints) -> tuple[Floats, Floats, Floats]:
        """Upper and lower bounds of the distances of pairs, and where the upper ones are reached (2, pair)."""
        q, nodes = p[:, of], self.nodes[:, :, triangle]
        rs = feet.flat_feet(q, nodes[:3])
        flat = q - feet.place(nodes[:3], rs)
        flat_distance = np.sqrt(feet.dot(flat, flat))
        if len(nodes) == 3:
            return flat_distance, flat_distance, rs
        off = q - feet.place(nodes, rs)
        return np.sqrt(feet.dot(off, off)), flat_distance - self.bump[triangle], rs

    def _closest(self, p: Floats, of: Ints, triangle: Ints) -> Nearest:
        """The closest points among pairs."""
        upper, lower, rs = self._distance(p, of, triangle)
        best = np.full(p.shape[1], np.inf)
        np.minimum.at(best, of, upper)
        keep = lower <= best[of] + self.tie
        of, triangle, upper, rs = of[keep], triangle[keep], upper[keep], rs[:, keep]
        if len(self.nodes) == 6:
            rs = feet.curved_feet(p[:, of], self.nodes[:, :, triangle], rs)
            # of points on the surface there is nothing closer to look for
            aside = self._least(p, of, triangle, rs)[1] > self.tie
            bent = np.flatnonzero((upper > self.reach[triangle]) & aside[of])
            if len(bent):
                of, triangle, rs = self._divided(p, of, triangle, rs, bent)
        distance, best = self._least(p, of, triangle, rs)
        tied = distance > best[of] + self.tie
        order = np.lexsort((distance, self.rank[triangle], tied, of))
        first = order[np.searchsorted(of[order], np.arange(p.shape[1]))]
        x = feet.place(self.nodes[:, :, triangle[first]], rs[:, first])
        return Nearest(triangle[first], rs[:, first].T, x.T, distance[first])

    def _least(self, p: Floats, of: Ints, triangle: Ints, rs: Floats) -> tuple[Floats, Floats]:
        """Distances of places (2, pair) in triangles, and the least of each point."""
        off = p[:, of] - feet.place(self.nodes[:, :, triangle], rs)
        distance = np.sqrt(feet.dot(off, off))
        best = np.full(p.shape[1], np.inf)
        np.minimum.at(best, of, distance)
        return distance, best

    def _divided(
        self, p: Floats, of: Ints, triangle: Ints, rs: Floats, bent: Ints
    ) -> tuple[Ints, Ints, Floats]:
        """The pairs, and more of them: feet found from parts of triangles on which f may have several minima."""
        best = self._least(p, of, triangle, rs)[1]
        pair, corners = bent, np.broadcast_to(np.eye(3), (len(bent), 3, 3))  # (part, corner, barycentric)
        for _ in range(DIVISIONS):
            corners = np.einsum("pcb,nbd->npcd", PARTS, corners).reshape(-1, 3, 3)
            pair = np.repeat(pair, 4)
            at = np.concatenate([corners, np.einsum("mc,ncd->nmd", MIDDLES, corners)], axis=1)[..., 1:]
            whole = self.nodes[:, :, triangle[pair]]
            nodes = np.stack([feet.place(whole, at[:, k].T) for k in range(6)])
            q = p[:, of[pair]]
            local = feet.flat_feet(q, nodes[:3])
            flat, true = q - feet.place(nodes[:3], local), q - feet.place(nodes, local)
            np.minimum.at(best, of[pair], np.sqrt(feet.dot(true, true)))
            lower = np.sqrt(feet.dot(flat, flat)) - _bends(nodes)[0]
            keep = lower <= best[of[pair]] + self.tie
            pair, corners, local = pair[keep], corners[keep], local[:, keep]
        weight = np.stack([1 - local.sum(axis=0), local[0], local[1]], axis=1)
        start = np.einsum("nc,ncd->nd", weight, corners)[:, 1:].T
        more = feet.curved_feet(p[:, of[pair]], self.nodes[:, :, triangle[pair]], start)
        return (
            np.concatenate([of, of[pair]]),
            np.concatenate([triangle, triangle[pair]]),
            np.concatenate([rs, more], axis=1),
        )


def _bends(nodes: Floats) -> tuple[Floats, Floats]:
    """(triangle,) by how much triangles differ from flat ones, and from how far f is convex on all of them.

    With n the normal of the flat triangle, and second derivatives by lengths along the tangents at the centroid split
    into their part M_n along n and the rest M_t, f_ab = x_a . x_b - (p - x) . x_ab is positive definite where

        (|p - x| + 2 bump) |M_n| + (|p - x| + diameter) |M_t| < (1 - diameter |M_t|)^2,

    |p - x| the distance of the triangle: elsewhere on it p - x is longer by as much as the diameter, but not along n.
    """
    if len(nodes) == 3:
        return np.zeros(nodes.shape[2]), np.full(nodes.shape[2], np.inf)
    bows = [nodes[m] - 0.5 * (nodes[a] + nodes[b]) for a, b, m in feet.EDGES]
    bump = BUMPS * np.sqrt(np.max([feet.dot(bow, bow) for bow in bows], axis=0))
    rr, ss, rs = feet.second_derivatives(nodes)
    u, v = nodes[1] - nodes[0], nodes[2] - nodes[0]
    n = np.cross(u, v, axis=0)
    n /= np.sqrt(feet.dot(n, n))
    xr, xs = u + rs / 3 - rr / 6, v + rs / 3 - ss / 6  # at the centroid
    e1 = xr - feet.dot(xr, n) * n
    a = np.sqrt(feet.dot(e1, e1))
    e1 /= a
    e2 = np.cross(n, e1, axis=0)
    b, c = feet.dot(xs, e1), feet.dot(xs, e2)
    norms = []
    for axis in (n, e1, e2):
        r11, r22, r12 = feet.dot(rr, axis), feet.dot(ss, axis), feet.dot(rs, axis)
        m11, m12 = r11 / a**2, (r12 - b / a * r11) / (a * c)
        m22 = (r22 - 2 * b / a * r12 + (b / a) ** 2 * r11) / c**2
        norms.append(np.sqrt(m11**2 + m22**2 + 2 * m12**2))
    along_n, along_t = norms[0], np.hypot(norms[1], norms[2])
    sides = [nodes[j] - nodes[i] for i, j, _ in feet.EDGES]
    diameter = np.sqrt(np.max([feet.dot(side, side) for side in sides], axis=0)) + 2 * bump
    stretch = np.maximum(1 - diameter * along_t, 0.0) ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = (stretch - 2 * bump * along_n - diameter * along_t) / (along_n + along_t)
    return bump, np.where(along_n + along_t > 0, reach, np.inf)


def _balls(nodes: Floats, bump: Floats) -> tuple[Floats, Floats]:
    """Balls that hold triangles: about the middle of the longest side or the circumcentre, whichever suffices."""
    a, b, c = nodes[:3]
    sides = np.stack([feet.dot(b - c, b - c), feet.dot(a - c, a - c), feet.dot(a - b, a - b)])
    weight = sides * (sides.sum(axis=0) - 2 * sides)  # barycentric coordinates of the circumcentre
    obtuse = (weight <= 0).any(axis=0)
    longest = sides.argmax(axis=0)
    middle = 0.5 * (np.arange(3)[:, None] != longest)
    weight = np.where(obtuse, middle, weight / np.where(obtuse, 1.0, weight.sum(axis=0)))
    centre = np.einsum("kt,kxt->xt", weight, nodes[:3])
    radius = np.sqrt(np.max([feet.dot(x - centre, x - centre) for x in nodes[:3]], axis=0))
    return centre, radius + bump
