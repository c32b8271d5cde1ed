"""A mesh from plain arrays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError
from kshell.mesh.build import M, build
from kshell.mesh.raw import RawGroup, RawMesh
from kshell.mesh.triangulation import EdgeTable, Triangulation
from kshell.mesh.words import count

Ints = NDArray[np.int64]


def mesh_from_arrays(
    kind: type[M],
    points: ArrayLike,
    triangles: ArrayLike,
    groups: Mapping[str, Any] | None = None,
    midpoints: ArrayLike | None = None,
    source: str = "mesh",
) -> M:
    """A mesh of the given class. See `Mesh.from_arrays`."""
    x = np.asarray(points, dtype=float)
    if x.ndim != 2 or x.shape[1] not in (2, 3):
        raise InputError(f"{source}: points must be an array (vertex, 2 or 3), not of shape {x.shape}")
    if x.shape[1] == 2:
        x = np.column_stack([x, np.zeros(len(x))])
    t = _indices(triangles, "triangles", source)
    if t.size == 0:
        t = t.reshape(0, 3)
    if t.ndim != 2 or t.shape[1] not in (3, 6):
        raise InputError(f"{source}: triangles must be an array (triangle, 3 or 6), not of shape {t.shape}")
    if t.size and (t.min() < 0 or t.max() >= len(x)):
        bad = int(t.min()) if t.min() < 0 else int(t.max())
        raise InputError(
            f"{source}: a triangle names vertex {bad}, but there are vertices 0 to {len(x) - 1} only"
        )
    table = None
    if midpoints is not None and t.size:
        x, t, table = _with_midpoints(x, t, midpoints, source)

    raw_groups = [_group(name, cells, t, len(x), source) for name, cells in (groups or {}).items()]
    mesh = build(RawMesh(x, t, raw_groups, source, edge_table=table), kind)
    for name, group in mesh.groups.items():
        if group.lost:
            what = "vertices of triangles" if group.dimension == 0 else "edges of triangles"
            raise InputError(
                f"{source}: group '{name}': {count(group.lost, 'entry', 'entries')} are no {what}"
            )
    return mesh


def _indices(values: ArrayLike, what: str, source: str) -> Ints:
    array = np.asarray(values)
    if array.size and not np.issubdtype(array.dtype, np.integer):
        raise InputError(f"{source}: {what} must be integer indices, not {array.dtype}")
    return array.astype(np.int64)


def _with_midpoints(
    x: NDArray[np.float64], t: Ints, midpoints: ArrayLike, source: str
) -> tuple[NDArray[np.float64], Ints, EdgeTable]:
    """Six-node triangles from nodes given by edge, with the table of these."""
    if t.shape[1] == 6:
        raise InputError(f"{source}: give either six-node triangles or midpoints, not both")
    bare = Triangulation(x, t.astype(np.int32))
    middle = np.asarray(midpoints, dtype=float)
    if middle.shape != (len(bare.edges), 3):
        raise InputError(
            f"{source}: midpoints must be an array of shape ({len(bare.edges)}, 3), one row per edge in the "
            f"order of Mesh.edges, not {middle.shape}"
        )
    six = np.concatenate([t, len(x) + bare.triangle_edges.astype(np.int64)], axis=1)
    return np.concatenate([x, middle]), six, bare.edge_table


def _group(name: str, cells: Any, triangles: Ints, n_points: int, source: str) -> RawGroup:
    array = _indices(cells, f"the entries of group '{name}'", source)
    if array.ndim == 1:
        dimension = 0
    elif array.ndim == 2 and array.shape[1] in (2, 3):
        dimension = array.shape[1] - 1
    else:
        raise InputError(
            f"{source}: group '{name}' must be an array of vertices (n,), edges (n, 2) or triangles (n, 3), "
            f"not of shape {array.shape}"
        )
    if array.size and (array.min() < 0 or array.max() >= n_points):
        raise InputError(f"{source}: group '{name}' names a vertex outside 0 to {n_points - 1}")
    if dimension == 2:
        array = _rows_of(array, triangles, name, source)
    return RawGroup(name, dimension, array)


def _rows_of(cells: Ints, triangles: Ints, name: str, source: str) -> Ints:
    """Which row of `triangles` has the corners of each cell."""
    both = np.sort(np.concatenate([triangles[:, :3], cells]), axis=1)
    _, inverse = np.unique(both, axis=0, return_inverse=True)
    inverse = inverse.ravel()
    row = np.full(inverse.max() + 1, -1, dtype=np.int64)
    row[inverse[: len(triangles)]] = np.arange(len(triangles))
    found = row[inverse[len(triangles) :]]
    if (found < 0).any():
        first = cells[np.flatnonzero(found < 0)[0]].tolist()
        raise InputError(f"{source}: group '{name}': {first} is no triangle of the mesh")
    return found
