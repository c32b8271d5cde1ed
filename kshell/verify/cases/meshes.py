"""Meshes of the verification cases: structured, so that they are the same on every machine.

Groups: the sides of a rectangle are x0, x1, y0, y1, those of other shapes are named by their builder.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.mesh.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Where = Callable[[Floats, Floats], NDArray[np.bool_]]  # of x, y

CORNER_RATIO = 0.4  # how triangles shrink from layer to layer around a refined vertex


def mesh(
    points: Floats,
    triangles: Ints,
    sides: Mapping[str, Where],
    surfaces: Mapping[str, Where] | None = None,
    true_middle: Callable[[Floats], Floats] | None = None,
) -> Mesh:
    """A mesh with named parts of the boundary, and of the surface.

    Parameters
    ----------
    points : (vertex, 2) array
    triangles : (triangle, 3) array
    sides, surfaces : dict of name to a function of x and y
        Which boundary edges, judged by the middle of the chord, and which triangles, by their centroid.
    true_middle : function, optional
        From middles of boundary chords (n, 2) to the true edge: makes a mesh of order 2.
    """
    bare = Mesh(np.column_stack([points, np.zeros(len(points))]), triangles.astype(np.int32))
    middles = points[bare.edges].mean(axis=1)
    boundary = bare.boundary_edges
    groups: dict[str, NDArray[np.integer]] = {}
    for name, where in sides.items():
        chosen = where(*middles[boundary].T)
        groups[name] = bare.edges[boundary[chosen]]
    for name, where in (surfaces or {}).items():
        groups[name] = triangles[where(*points[triangles].mean(axis=1).T)]
    nodes = None
    if true_middle is not None:
        nodes = middles.copy()
        nodes[boundary] = true_middle(middles[boundary])
        nodes = np.column_stack([nodes, np.zeros(len(nodes))])
    return Mesh.from_arrays(points, triangles, groups, nodes)


def grid(n_x: int, n_y: int, falling: bool = False) -> tuple[Floats, Ints]:
    """The unit square in n_x by n_y cells, each cut in two by a rising or a falling diagonal."""
    x, y = np.meshgrid(np.linspace(0, 1, n_x + 1), np.linspace(0, 1, n_y + 1), indexing="ij")
    number = np.arange((n_x + 1) * (n_y + 1)).reshape(n_x + 1, n_y + 1)
    a, b = number[:-1, :-1].ravel(), number[1:, :-1].ravel()
    c, d = number[1:, 1:].ravel(), number[:-1, 1:].ravel()
    cut = [(a, b, d), (b, c, d)] if falling else [(a, b, c), (a, c, d)]
    return np.column_stack([x.ravel(), y.ravel()]), np.concatenate([np.stack(t, axis=1) for t in cut])


def refined_at(points: Floats, triangles: Ints, at: ArrayLike, layers: int) -> tuple[Floats, Ints]:
    """Layers of ever smaller triangles around given vertices, for corners and point loads.

    The triangles at a vertex are cut parallel to their far edge, again and again.
    """
    for place in np.atleast_2d(np.asarray(at, dtype=float)):
        corner = int(np.linalg.norm(points - place, axis=1).argmin())
        for _ in range(layers):
            around = (triangles == corner).any(axis=1)
            old = triangles[around]
            turn = np.argmax(old == corner, axis=1)
            ring = np.take_along_axis(old, (turn[:, None] + np.array([1, 2])) % 3, axis=1)  # (n, 2)
            outer, inverse = np.unique(ring, return_inverse=True)
            inner = len(points) + inverse.reshape(ring.shape)
            points = np.concatenate(
                [points, points[corner] + CORNER_RATIO * (points[outer] - points[corner])]
            )
            tip = np.column_stack([np.full(len(old), corner), inner])
            near = np.column_stack([inner[:, 0], ring[:, 0], ring[:, 1]])
            far = np.column_stack([inner[:, 0], ring[:, 1], inner[:, 1]])
            triangles = np.concatenate([triangles[~around], tip, near, far])
    return points, triangles


def rectangle(
    a: float,
    b: float,
    n: int,
    surfaces: Mapping[str, Where] | None = None,
    refine: ArrayLike = (),
    layers: int = 0,
) -> Mesh:
    """[0, a] x [0, b] with n cells on the shorter side."""
    h = min(a, b) / n
    points, triangles = grid(round(a / h), round(b / h))
    points = points * np.array([a, b])
    if layers:
        points, triangles = refined_at(points, triangles, refine, layers)
    tiny = 1e-9 * max(a, b)
    sides: dict[str, Where] = {
        "x0": lambda x, y: x < tiny,
        "x1": lambda x, y: x > a - tiny,
        "y0": lambda x, y: y < tiny,
        "y1": lambda x, y: y > b - tiny,
    }
    return mesh(points, triangles, sides, surfaces)


def rhombus(angle: float, n: int, layers: int = 0) -> Mesh:
    """Side 1, one side along x, an acute angle (degrees) at the origin; group "edge".

    ``layers`` of smaller triangles lie around the two obtuse corners.
    """
    points, triangles = grid(n, n, falling=True)
    if layers:
        points, triangles = refined_at(points, triangles, [(1, 0), (0, 1)], layers)
    t = np.radians(angle)
    return mesh(points @ np.array([[1, 0], [np.cos(t), np.sin(t)]]), triangles, {"edge": everywhere})


def everywhere(x: Floats, y: Floats) -> NDArray[np.bool_]:
    """True at all points."""
    return np.ones(x.shape, dtype=bool)


def triangle(corners: Sequence[tuple[float, float]], n: int) -> Mesh:
    """A triangle with n * n equal triangles; group "edge"."""
    points, triangles = _fan(np.array([corners], dtype=float), n)
    return mesh(points, triangles, {"edge": everywhere})


def regular_polygon(sides: int, n: int, layers: int = 0) -> Mesh:
    """A regular polygon with a corner at (1, 0), each side cut in n; group "edge".

    ``layers`` of smaller triangles lie around the corners.
    """
    t = 2 * np.pi * np.arange(sides + 1) / sides
    corners = np.column_stack([np.cos(t), np.sin(t)])
    fan = np.stack([np.zeros((sides, 2)), corners[:-1], corners[1:]], axis=1)
    points, triangles = _fan(fan, n)
    if layers:
        points, triangles = refined_at(points, triangles, corners[:-1], layers)
    return mesh(points, triangles, {"edge": everywhere})


def _fan(parts: Floats, n: int) -> tuple[Floats, Ints]:
    """Triangles (part, 3, 2), each cut into n * n, joined where they touch."""
    ij = [(i, j) for i in range(n + 1) for j in range(n + 1 - i)]
    number = {place: k for k, place in enumerate(ij)}
    up = [(number[i, j], number[i + 1, j], number[i, j + 1]) for i, j in ij if i + j < n]
    down = [(number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]) for i, j in ij if i + j < n - 1]
    local = np.array(up + down)
    weight = np.array([(n - i - j, i, j) for i, j in ij]) / n
    points = (weight @ parts).reshape(-1, 2)
    _, first, inverse = np.unique(np.round(points, 9) + 0.0, axis=0, return_index=True, return_inverse=True)
    triangles = (local + len(ij) * np.arange(len(parts))[:, None, None]).reshape(-1, 3)
    return points[first], inverse.ravel()[triangles]


def l_shape(n: int, layers: int) -> Mesh:
    """[0, 1]^2 without [1/2, 1]^2, n cells on the long side, refined at (1/2, 1/2); group "edge"."""
    points, triangles = grid(n, n)
    centre = points[triangles].mean(axis=1)
    triangles = triangles[~((centre > 0.5).all(axis=1))]
    used = np.unique(triangles)
    number = np.full(len(points), -1)
    number[used] = np.arange(len(used))
    points, triangles = refined_at(points[used], number[triangles], (0.5, 0.5), layers)
    return mesh(points, triangles, {"edge": everywhere})


def ellipse(n: int, order: int = 1, b: float = 1.0, quarter: bool = False, layers: int = 0) -> Mesh:
    """Semi-axes 1 and b around the origin, in n rings of triangles; group "edge".

    A quarter has x, y >= 0 and the groups "x0", "y0" too. ``layers`` refine the centre.
    """
    sectors = 6 if not quarter else 2  # of the full turn, or of a right angle
    total = 2 * np.pi if not quarter else np.pi / 2
    points, rings = [np.zeros((1, 2))], [np.zeros(1, dtype=np.int64)]
    count = 1
    for k in range(1, n + 1):
        nodes = sectors * k + (1 if quarter else 0)
        t = total * np.arange(nodes) / (sectors * k)
        points.append(k / n * np.column_stack([np.cos(t), np.sin(t)]))
        rings.append(count + np.arange(nodes))
        count += nodes
    triangles = []
    for k in range(1, n + 1):
        inner, outer = rings[k - 1], rings[k]
        for s in range(sectors):
            for j in range(k):
                a, b0 = outer[(s * k + j) % len(outer)], outer[(s * k + j + 1) % len(outer)]
                c = inner[(s * (k - 1) + j) % len(inner)]
                triangles.append((c, a, b0))
                if j < k - 1:
                    triangles.append((c, b0, inner[(s * (k - 1) + j + 1) % len(inner)]))
    xy, cells = np.concatenate(points), np.array(triangles)
    if layers:
        xy, cells = refined_at(xy, cells, (0.0, 0.0), layers)
    sides = _curved_sides(quarter, {"edge": lambda x, y: np.hypot(x, y) > 0.5})
    return _stretched(xy, cells, sides, order, b)


def annulus(inner: float, n: int, order: int = 1, quarter: bool = False) -> Mesh:
    """Radii ``inner`` and 1 around the origin, n rings; groups "inner" and "outer" (and "x0", "y0")."""
    total = np.pi / 2 if quarter else 2 * np.pi
    n_t = round(n * np.pi / 2 / np.log(1 / inner)) * (1 if quarter else 4)  # cells about as long as wide
    xy, cells = grid(n, n_t)
    radius = inner ** (1 - xy[:, 0])
    t = total * xy[:, 1]
    points = radius[:, None] * np.column_stack([np.cos(t), np.sin(t)])
    if not quarter:  # the last ray is the first
        last = np.arange(len(points)) % (n_t + 1) == n_t
        number = np.arange(len(points))
        number[last] -= n_t
        kept = np.flatnonzero(~last)
        place = np.full(len(points), -1)
        place[kept] = np.arange(len(kept))
        points, cells = points[kept], place[number[cells]]
    middle = (1 + inner) / 2
    rims: dict[str, Where] = {
        "inner": lambda x, y: np.hypot(x, y) < middle,
        "outer": lambda x, y: np.hypot(x, y) > middle,
    }
    return _stretched(points, cells, _curved_sides(quarter, rims), order, 1.0)


def _curved_sides(quarter: bool, rims: Mapping[str, Where]) -> dict[str, Where]:
    """Rims, and the straight sides of a quarter, which are no part of a rim."""
    if not quarter:
        return dict(rims)

    def on_rim(where: Where) -> Where:
        return lambda x, y: where(x, y) & (np.minimum(x, y) > 1e-9)

    straight: dict[str, Where] = {"x0": lambda x, y: np.abs(x) < 1e-9, "y0": lambda x, y: np.abs(y) < 1e-9}
    return {**{name: on_rim(where) for name, where in rims.items()}, **straight}


def _stretched(points: Floats, cells: Ints, sides: Mapping[str, Where], order: int, b: float) -> Mesh:
    """A mesh between circles, stretched along y by b; the mid-edge nodes at order 2 are on the true edge."""
    circles = _onto_circle(points, straight="x0" in sides) if order == 2 else None
    round_one = mesh(points, cells, sides, true_middle=circles)
    if b == 1.0:
        return round_one
    scale = np.array([1.0, b, 1.0])
    middle = None if round_one.midpoints is None else round_one.midpoints * scale
    groups = {name: round_one.edges[group.members] for name, group in round_one.groups.items()}
    return Mesh.from_arrays(round_one.points * scale, round_one.triangles, groups, middle)


def _onto_circle(points: Floats, straight: bool) -> Callable[[Floats], Floats]:
    """Middles of chords moved out to the circle; those on the axes stay where these are ``straight`` sides."""
    radii = np.hypot(*points.T)
    extremes = np.array([radii.min(), radii.max()])

    def move(middles: Floats) -> Floats:
        radius = np.hypot(*middles.T)
        nearest = extremes[np.argmin(np.abs(extremes - radius[:, None]), axis=1)]
        stay = straight & (np.abs(middles).min(axis=1) < 1e-9)
        return middles * np.where(stay, 1.0, nearest / np.where(stay, 1.0, radius))[:, None]

    return move
