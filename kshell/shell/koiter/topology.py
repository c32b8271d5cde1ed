"""How the triangles of a surface hang together: parts, sheets, branches, folds, boundary loops.

A part is connected through edges. A sheet is connected through edges of exactly two triangles, so a T junction
is one part of three sheets. A patch is the piece of a sheet without folds, over which fields may be averaged.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.energy import in_blocks
from kshell.mesh.connected import connected_parts
from kshell.mesh.mesh import Mesh
from kshell.shell.frames import components, covariant_to_frame, tangent_frame
from kshell.shell.koiter.surface import Surface
from kshell.shell.vectors import cross, dot, norm

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

BLOCK = 2048  # triangles looked at together


@dataclass(frozen=True)
class Sheet:
    """One sheet of a surface.

    Attributes
    ----------
    triangles : (n,) int array
    orientable : bool
        False for a Moebius strip.
    characteristic : int
        Vertices - edges + triangles: 2 for a sphere, 1 for a disc, 0 for a tube, a torus or a Moebius strip.
    """

    triangles: Ints
    orientable: bool
    characteristic: int


def edge_neighbours(mesh: Mesh) -> tuple[Ints, Ints]:
    """Edges of exactly two triangles, (n,), and (n, 2) places in the flat (triangle, 3) array of local edges."""
    flat = mesh.triangle_edges.ravel()
    order = np.argsort(flat, kind="stable")
    start = np.concatenate([[0], np.cumsum(mesh.edge_counts)[:-1]])
    edges = np.flatnonzero(mesh.edge_counts == 2)
    return edges.astype(np.int32), np.stack([order[start[edges]], order[start[edges] + 1]], axis=1).astype(
        np.int32
    )


def branch_edges(mesh: Mesh) -> Ints:
    """Edges shared by three or more triangles."""
    return np.flatnonzero(mesh.edge_counts > 2).astype(np.int32)


def parts(mesh: Mesh) -> Ints:
    """(triangle,) number of the part each triangle belongs to."""
    triangles = len(mesh.triangles)
    rows = np.repeat(np.arange(triangles), 3)
    of = connected_parts(triangles + len(mesh.edges), rows, triangles + mesh.triangle_edges.ravel())[1]
    return of[:triangles].astype(np.int32)


def _walks_ahead(mesh: Mesh) -> NDArray[np.bool_]:
    """(triangle 3,) whether the triangle walks its local edge from the lower to the higher vertex."""
    t = mesh.triangles
    return np.stack([t[:, 0] < t[:, 1], t[:, 1] < t[:, 2], t[:, 2] < t[:, 0]], axis=1).ravel()


def opposed_edges(mesh: Mesh) -> Ints:
    """Edges of two triangles with opposite normals (both walk the edge the same way)."""
    edges, places = edge_neighbours(mesh)
    ahead = _walks_ahead(mesh)
    return edges[ahead[places[:, 0]] == ahead[places[:, 1]]]


def sheets(mesh: Mesh) -> list[Sheet]:
    """The sheets of a mesh.

    A sheet is orientable if its two-sided cover, in which a step across an edge with opposite normals changes
    the side, falls into two.
    """
    _, places = edge_neighbours(mesh)
    triangles = len(mesh.triangles)
    a, b = places[:, 0] // 3, places[:, 1] // 3
    ahead = _walks_ahead(mesh)
    flip = ahead[places[:, 0]] == ahead[places[:, 1]]
    rows = np.concatenate([a, a + triangles])
    columns = np.concatenate([np.where(flip, b + triangles, b), np.where(flip, b, b + triangles)])
    _, side = connected_parts(2 * triangles, rows, columns)
    count, label = connected_parts(triangles, a, b)
    result = []
    for number in range(count):
        mine = np.flatnonzero(label == number).astype(np.int32)
        vertices, edges = np.unique(mesh.triangles[mine]), np.unique(mesh.triangle_edges[mine])
        orientable = bool(side[mine[0]] != side[mine[0] + triangles])
        result.append(Sheet(mine, orientable, len(vertices) - len(edges) + len(mine)))
    return result


def boundary_loops(mesh: Mesh) -> list[Ints]:
    """Vertices along each connected piece of the boundary, in walking order where it is a simple loop."""
    ends = mesh.edges[mesh.boundary_edges]
    if not len(ends):
        return []
    from scipy.sparse.csgraph import depth_first_order

    vertices, local = np.unique(ends, return_inverse=True)
    local = local.reshape(ends.shape)
    size = (len(vertices), len(vertices))
    graph = sp.coo_matrix((np.ones(len(ends)), local.T), shape=size).tocsr()
    graph = graph + graph.T
    count, label = connected_parts(len(vertices), *local.T)
    starts = [int(np.argmax(label == number)) for number in range(count)]
    return [
        vertices[depth_first_order(graph, start, directed=False, return_predecessors=False)].astype(np.int32)
        for start in starts
    ]


def fold_angles(surface: Surface) -> Floats:
    """(edge,) largest angle between the normals on both sides, in radians; NaN at other edges than of two triangles."""
    mesh, p = surface.mesh, surface.order
    normal = cross(*surface.tangents(surface.reference.edge_first))
    normal = (normal / norm(normal)).reshape(3, -1, p)
    edges, places = edge_neighbours(mesh)
    sign = surface.edge_sign.ravel()
    one, other = (np.where(sign[k][None, :, None] > 0, normal[:, k], normal[:, k, ::-1]) for k in places.T)
    # normals of sheets that are not oriented alike are compared as if they were
    other = other * np.where(sign[places[:, 0]] == sign[places[:, 1]], -1.0, 1.0)[:, None]
    angle = np.arctan2(norm(cross(one, other)), dot(one, other)).max(axis=1)
    result = np.full(len(mesh.edges), np.nan)
    result[edges] = angle
    return result


def smooth_patches(surface: Surface, largest: float = np.radians(10.0)) -> Ints:
    """(triangle,) number of the patch: connected through edges of two triangles that fold by less than `largest`."""
    edges, places = edge_neighbours(surface.mesh)
    smooth = fold_angles(surface)[edges] < largest
    a, b = (places[smooth] // 3).T
    return connected_parts(len(surface.mesh.triangles), a, b)[1].astype(np.int32)


def largest_curvature(surface: Surface) -> Floats:
    """(triangle,) largest principal curvature, in size, at the interior points of the rest surface.

    Flat triangles (p = 1) have none; folds are not counted.
    """
    parts = [_largest(surface, some) for some in in_blocks(len(surface.mesh.triangles), BLOCK)]
    return np.concatenate(parts)


def _largest(surface: Surface, triangles: slice) -> Floats:
    ref = surface.reference
    x = surface.tangents(ref.first, triangles)
    second = surface.jets(surface.nodes, ref.second, triangles)
    e1, e2, n = tangent_frame(x)
    b = np.stack([dot(n, second[v]) for v in range(3)])
    b11, b22, b12 = np.einsum("vwtq,wtq->vtq", covariant_to_frame(components(x, e1, e2)), b)
    middle, radius = 0.5 * (b11 + b22), np.hypot(0.5 * (b11 - b22), 0.5 * b12)
    return (np.abs(middle) + radius).max(axis=1)
