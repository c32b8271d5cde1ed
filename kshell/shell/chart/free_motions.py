"""The motions of a chart surface that conditions on its vertices and edges leave free: x = T q + x0.

The conditions at each vertex are linear equations for its 18 unknowns; their null space is what is left free. A
rotation adds one equation at the midpoint of the edge.

Symbols as in `kshell.shell.chart.edges`.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.reduction import Reduction
from kshell.errors import InputError
from kshell.shell.chart.edges import across, vertex_sizes
from kshell.shell.chart.surface import ChartSurface

Floats = NDArray[np.float64]

# equations on scaled unknowns count as dependent below this singular value
DEPENDENT = 1e-8


@dataclass
class Conditions:
    """What is prescribed, one array after the other.

    Attributes
    ----------
    vertices, rows, values : lists of (n,), (n, 18) and (n,)
        rows @ unknowns of the vertex = values.
    slopes : list of (edges, directions)
        At the midpoints of edges the derivative across has no part along directions (k, 3); None: along the normal.
    """

    vertices: list[NDArray] = field(default_factory=list)
    rows: list[Floats] = field(default_factory=list)
    values: list[Floats] = field(default_factory=list)
    slopes: list[tuple[NDArray, Floats | None]] = field(default_factory=list)

    def add(self, vertices: NDArray, rows: Floats, values: Floats) -> None:
        """Equations for the unknowns of vertices, one each."""
        self.vertices.append(vertices)
        self.rows.append(rows)
        self.values.append(values)


def free_motions(surface: ChartSurface, conditions: Conditions) -> Reduction:
    """The motions left.

    Raises
    ------
    InputError
        If two conditions prescribe different displacements of the same vertex.
    """
    sizes = vertex_sizes(surface.mesh)
    rows, columns, entries, count = [], [], [], 0
    given = np.zeros(surface.unknowns)
    fixed = np.zeros(surface.unknowns, dtype=bool)
    if conditions.vertices:
        for vertex, equations, values in _by_vertex(conditions):
            unknowns = 18 * vertex + np.arange(18)
            fixed[unknowns] = True
            free, motion = _null_space(surface, vertex, equations, values, sizes[vertex])
            given[unknowns] = motion
            rows.append(np.repeat(unknowns, free.shape[1]))
            columns.append(np.tile(count + np.arange(free.shape[1]), 18))
            entries.append(free.ravel())
            count += free.shape[1]
    carried = sp.csr_matrix((surface.unknowns, surface.unknowns))
    if conditions.slopes:
        unknowns, free, kept, carried = _midpoints(surface, conditions.slopes)
        fixed[unknowns] = True
        for k in range(3):  # the last directions of each midpoint are free
            some = np.flatnonzero(kept > k)
            rows.append(unknowns[some].ravel())
            columns.append(np.repeat(count + np.arange(len(some)), 3))
            entries.append(free[some, 2 - k].ravel())
            count += len(some)
    rest = np.flatnonzero(~fixed)
    basis = sp.csc_matrix(
        (
            np.concatenate([np.ones(len(rest)), *entries]),
            (
                np.concatenate([rest, *rows]),
                np.concatenate([np.arange(len(rest)), *(c + len(rest) for c in columns)]),
            ),
        ),
        shape=(surface.unknowns, len(rest) + count),
    )
    basis = (basis + carried @ basis).tocsc()
    return Reduction(basis, given + carried @ given, np.zeros(0, dtype=np.int32))


def _by_vertex(conditions: Conditions) -> list[tuple[int, Floats, Floats]]:
    """Each vertex with its equations and their right-hand sides."""
    vertices = np.concatenate(conditions.vertices)
    order = np.argsort(vertices, kind="stable")
    rows, values = np.concatenate(conditions.rows)[order], np.concatenate(conditions.values)[order]
    unique, start = np.unique(vertices[order], return_index=True)
    parts = zip(unique, np.split(rows, start[1:]), np.split(values, start[1:]), strict=True)
    return [(int(v), r, c) for v, r, c in parts]


def _null_space(
    surface: ChartSurface, vertex: int, rows: Floats, values: Floats, size_there: float
) -> tuple[Floats, Floats]:
    """Free directions (18, k) and the prescribed motion (18,) of a vertex, with the size of the edges there."""
    scale = np.repeat(size_there ** np.array([0.0, -1, -1, -2, -2, -2]), 3)  # unknowns of one size
    scaled = rows * scale
    size = np.linalg.norm(scaled, axis=1)
    scaled, right = scaled / size[:, None], values / size
    u, s, v = np.linalg.svd(scaled)
    rank = int(np.sum(s > DEPENDENT))
    motion = v[:rank].T @ ((u[:, :rank].T @ right) / s[:rank])
    if np.abs(scaled @ motion - right).max() > 1e-6 * np.abs(right).max(initial=0.0):
        x, y = surface.mesh.points[vertex, :2]
        raise InputError(f"supports prescribe different displacements at (u, v) = ({x:.6g}, {y:.6g})")
    return v[rank:].T * scale[:, None], motion * scale


def _midpoints(
    surface: ChartSurface, slopes: list[tuple[NDArray, Floats | None]]
) -> tuple[NDArray, Floats, NDArray, sp.csr_matrix]:
    """Unknowns (edge, 3) of edge midpoints with conditions, directions (edge, 3, 3) of which the last `kept`
    (edge,) are free, and what the vertices say about the others.

    With m = m_nu nu + m_tau T a condition is c . u,nu = -(m_tau / m_nu) c . u,T, and u,T at the midpoint of
    a quintic is 15/8 [u] / L - 7/16 (u,T + u,T) + L/32 [u,TT].
    """
    mesh = surface.mesh
    edges = np.unique(np.concatenate([e for e, _ in slopes]))
    ends = mesh.edges[edges]
    a, b = mesh.points[ends[:, 0], :2], mesh.points[ends[:, 1], :2]
    length = np.linalg.norm(b - a, axis=1)
    t = (b - a) / length[:, None]
    nu = np.stack([t[:, 1], -t[:, 0]], axis=1)  # the normal of kshell.elements.affine
    n, _, m, _, _ = across(surface.chart, 0.5 * (a + b), t)
    slant = -np.sum(m * t, axis=1) / np.sum(m * nu, axis=1)
    unknowns = 3 * (6 * len(mesh.points) + edges)[:, None] + np.arange(3)
    conditions = np.zeros((len(edges), 3 * len(slopes), 3))
    for k, (some, fixed) in enumerate(slopes):
        mine = np.searchsorted(edges, some)
        directions = n[mine, None] if fixed is None else fixed[None]
        conditions[mine, 3 * k : 3 * k + directions.shape[1]] = directions
    _, size, directions = np.linalg.svd(conditions, full_matrices=False)
    independent = size > 1e-6
    onto = np.einsum("ei,eix,eiy->exy", independent, directions, directions)
    row, column, entry = [], [], []
    for vertices, sign in ((ends[:, 0], -1.0), (ends[:, 1], 1.0)):
        tx, ty = t.T
        second = sign * length / 32
        parts = np.stack(
            [
                15 / 8 * sign / length,
                -7 / 16 * tx,
                -7 / 16 * ty,
                second * tx**2,
                2 * second * tx * ty,
                second * ty**2,
            ],
            axis=1,
        )
        block = np.einsum("e,exy,ek->exky", slant, onto, parts)
        where = 18 * vertices[:, None] + np.arange(18)
        row.append(np.repeat(unknowns, 18, axis=1).ravel())
        column.append(np.repeat(where[:, None], 3, axis=1).ravel())
        entry.append(block.ravel())
    shape = (surface.unknowns, surface.unknowns)
    place = (np.concatenate(row), np.concatenate(column))
    carried = sp.csr_matrix((np.concatenate(entry), place), shape=shape)
    return unknowns, directions, 3 - independent.sum(axis=1), carried
