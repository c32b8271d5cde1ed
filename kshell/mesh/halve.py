"""Every triangle cut into four alike ones, groups with it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kshell.mesh.mesh import Mesh
from kshell.mesh.triangulation import Group


def halved(mesh: Mesh) -> Mesh:
    """A straight mesh (order 1) with the middle of each edge as a new vertex.

    Vertices keep their numbers; the middle of edge e is the vertex (number of vertices) + e. Children keep the sense of
    their parent.
    """
    count = len(mesh.points)
    points = np.concatenate([mesh.points, mesh.points[mesh.edges].mean(axis=1)])
    a, b, c = mesh.triangles.T
    ab, bc, ca = (
        count + mesh.triangle_edges[:, 0],
        count + mesh.triangle_edges[:, 1],
        count + mesh.triangle_edges[:, 2],
    )
    children = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    triangles = np.stack([np.stack(corners, axis=1) for corners in children], axis=1).reshape(-1, 3)
    fine = Mesh(points, triangles.astype(np.int32), source=mesh.source)
    groups: dict[str, Group] = {}
    for name, group in mesh.groups.items():
        members = group.members.astype(np.int64)
        if group.dimension == 2:
            members = (4 * members[:, None] + np.arange(4)).ravel()
        elif group.dimension == 1:
            ends = mesh.edges[members]
            middle = count + members
            halves = np.concatenate([np.stack([end, middle], axis=1) for end in ends.T])
            members = fine.edge_index(halves).astype(np.int64)
        groups[name] = replace(group, members=np.sort(members).astype(group.members.dtype))
    return replace(fine, groups=groups, notes=mesh.notes)
