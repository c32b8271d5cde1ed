"""What the solvers are told about the plate's finite element space."""

from __future__ import annotations

import numpy as np

from kshell.plate.conditions import Conditions
from kshell.plate.domain import Domain
from kshell.plate.layout import Layout
from kshell.plate.reduction import DEPENDENT, Reduction
from kshell.solvers import PlateSpace


def plate_space(domain: Domain, layout: Layout, conditions: Conditions, reduction: Reduction) -> PlateSpace:
    """Positions, numbering and, per vertex, the directions of (w, w_x, w_y) that the supports admit."""
    mesh = domain.mesh
    n = len(mesh.points)
    gram = np.zeros((n, 3, 3))
    for fans, rows in zip(conditions.fans, conditions.rows, strict=True):
        # rows on second derivatives leave (w, w_x, w_y) free
        here = np.abs(rows[:, 3:]).max(axis=1, initial=0.0) == 0.0
        row = np.zeros((int(here.sum()), 3))
        row[:, : min(3, rows.shape[1])] = rows[here, :3]
        np.add.at(gram, layout.fans.vertex[fans[here]], row[:, :, None] * row[:, None, :])
    for vertices, slopes in conditions.vanishing_slopes():
        row = np.concatenate([np.zeros((len(vertices), 1)), slopes], axis=1)
        np.add.at(gram, vertices, row[:, :, None] * row[:, None, :])
    value, basis = np.tile(np.zeros(3), (n, 1)), np.tile(np.eye(3), (n, 1, 1))
    held = np.flatnonzero(np.abs(gram).max(axis=(1, 2)) > 0)
    value[held], basis[held] = np.linalg.eigh(gram[held])
    vector = domain.points[mesh.edges[:, 1]] - domain.points[mesh.edges[:, 0]]
    tangent = vector / mesh.edge_lengths[:, None]
    return PlateSpace(
        element="argyris" if layout.per_vertex > 1 else "morley",
        points=domain.points,
        triangles=mesh.triangles,
        edges=mesh.edges,
        edge_normals=np.stack([tangent[:, 1], -tangent[:, 0]], axis=1),
        lengths=mesh.edge_lengths,
        reduction=reduction.matrix(),
        vertex_basis=basis,
        vertex_mask=value < DEPENDENT,
        fan_vertex=layout.fans.vertex if layout.fans.extra else None,
        corner_fan=layout.fans.corner if layout.fans.extra else None,
        second_slopes=layout.bent if len(layout.bent) else None,
    )
