"""The motions of a chart surface that conditions on its vertices and edges leave free: x = T q + x0.

The conditions at each vertex are linear equations for the 18 unknowns of each of its fans, among them those that tie
fans on both sides of a line; their null space is what is left free. A rotation adds one equation at the midpoint of
the edge, on each of its sides.

Symbols as in `kshell.shell.chart.edges`.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.reduction import Reduction
from kshell.errors import InputError
from kshell.shell.chart.edges import across, coefficients_across, coefficients_along, vertex_sizes
from kshell.shell.chart.surface import ChartSurface

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# equations on scaled unknowns count as dependent below this singular value
DEPENDENT = 1e-8


@dataclass
class Conditions:
    """What is prescribed, one array after the other.

    Attributes
    ----------
    fans, rows, values : lists of (n,), (n, 18) and (n,)
        rows @ unknowns of the fan = values.
    slopes : list of (edges, side, directions)
        At the midpoints of edges, on one of their sides, the derivative across has no part along directions (k, 3);
        None: along the normal.
    """

    fans: list[NDArray] = field(default_factory=list)
    rows: list[Floats] = field(default_factory=list)
    values: list[Floats] = field(default_factory=list)
    slopes: list[tuple[NDArray, int, Floats | None]] = field(default_factory=list)

    def add(self, fans: NDArray, rows: Floats, values: Floats) -> None:
        """Equations for the unknowns of fans, one each."""
        self.fans.append(fans)
        self.rows.append(rows)
        self.values.append(values)


def free_motions(surface: ChartSurface, conditions: Conditions, tied: bool = True) -> Reduction:
    """The motions left.

    Parameters
    ----------
    tied : bool
        Whether the sides of all lines are tied, too, not only those at vertices with conditions.

    Raises
    ------
    InputError
        If two conditions prescribe different displacements of the same vertex.
    """
    sizes = vertex_sizes(surface.mesh)
    rows, columns, entries, count = [], [], [], 0
    given = np.zeros(surface.unknowns)
    fixed = np.zeros(surface.unknowns, dtype=bool)
    for vertex, fans, equations, values in _by_vertex(surface, conditions, tied):
        scalars = surface.nodes.fan_scalars(fans).ravel()
        unknowns = (3 * scalars[:, None] + np.arange(3)).ravel()
        fixed[unknowns] = True
        free, motion = _null_space(surface, vertex, equations, values, sizes[vertex])
        given[unknowns] = motion
        rows.append(np.repeat(unknowns, free.shape[1]))
        columns.append(np.tile(count + np.arange(free.shape[1]), len(unknowns)))
        entries.append(free.ravel())
        count += free.shape[1]
    carried = sp.csr_matrix((surface.unknowns, surface.unknowns))
    if conditions.slopes or (tied and len(surface.nodes.second)):
        unknowns, free, kept, carried = _midpoints(surface, conditions.slopes, tied)
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
    # twice: one side of a line may follow the other, which follows the vertices
    basis = (basis + carried @ (basis + carried @ basis)).tocsc()
    given = given + carried @ (given + carried @ given)
    return Reduction(basis, given, np.zeros(0, dtype=np.int32))


def _by_vertex(
    surface: ChartSurface, conditions: Conditions, tied: bool
) -> list[tuple[int, Ints, Floats, Floats]]:
    """Each vertex, its fans, its equations for the unknowns of all of them, and their right-hand sides."""
    nodes = surface.nodes
    none = np.zeros(0, dtype=np.int64)
    # two fans an equation; the second has no part in those of supports
    first = np.concatenate([none, *conditions.fans]).astype(np.int64)
    rows = np.concatenate([np.zeros((0, 18)), *conditions.rows])
    values = np.concatenate([np.zeros(0), *conditions.values])
    second, ties = first, _tie_rows(surface)
    if len(ties[0]):
        wanted = np.ones(len(ties[0]), dtype=bool)
        if not tied:
            wanted = np.isin(nodes.vertex[ties[0][:, 0]], nodes.vertex[first])
        pairs, tie_rows = ties[0][wanted], ties[1][wanted]
        first, second = np.concatenate([first, pairs[:, 0]]), np.concatenate([second, pairs[:, 1]])
        rows = np.concatenate([rows, tie_rows])
        values = np.concatenate([values, np.zeros(len(tie_rows))])
    vertices = nodes.vertex[first]
    order = np.argsort(vertices, kind="stable")
    unique, start = np.unique(vertices[order], return_index=True)
    parts = np.split(order, start[1:]) if len(unique) else []
    further = np.arange(len(surface.mesh.points), len(nodes.vertex))
    out = []
    for v, mine in zip(unique.tolist(), parts, strict=True):
        fans = np.concatenate([[v], further[nodes.vertex[further] == v]]).astype(np.int64)
        here = np.zeros((len(mine), len(fans), 18))
        each = np.arange(len(mine))
        here[each, np.searchsorted(fans, first[mine])] = rows[mine]
        pair = second[mine] != first[mine]
        here[each[pair], np.searchsorted(fans, second[mine][pair])] = -rows[mine][pair]
        out.append((v, fans, here.reshape(len(mine), -1), values[mine]))
    return out


def _tie_rows(surface: ChartSurface) -> tuple[Ints, Floats]:
    """(n, 2) pairs of fans, and the functions (n, 18) of their unknowns that are the same on both sides."""
    ties = surface.nodes.ties
    t = ties.tangent
    if not len(t):
        return ties.fans, np.zeros((0, 18))
    every = [np.broadcast_to(e, (len(t), 3)) for e in np.eye(3)]
    functions = [np.einsum("nk,nx->nkx", c, e) for c in coefficients_along(t) for e in every]
    pairs = [ties.fans] * len(functions)
    n, n_t, m, m_t, _ = across(surface.chart, surface.mesh.points[ties.vertex, :2], t)
    turned = ~ties.hinge
    functions += [f[turned] for f in coefficients_across(t, m, m_t, n, n_t)]
    pairs += [ties.fans[turned]] * 2
    smooth = ~ties.line
    if smooth.any():
        for e in every:
            functions += [f[smooth] for f in coefficients_across(t, m, m_t, e, np.zeros_like(e))]
            pairs += [ties.fans[smooth]] * 2
    return np.concatenate(pairs), np.concatenate(functions).reshape(-1, 18)


def _null_space(
    surface: ChartSurface, vertex: int, rows: Floats, values: Floats, size_there: float
) -> tuple[Floats, Floats]:
    """Free directions (18 f, k) and the prescribed motion (18 f,) of f fans, with the size of the edges there."""
    one = np.repeat(size_there ** np.array([0.0, -1, -1, -2, -2, -2]), 3)  # unknowns of one size
    scale = np.tile(one, rows.shape[1] // 18)
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
    surface: ChartSurface, slopes: list[tuple[NDArray, int, Floats | None]], tied: bool
) -> tuple[NDArray, Floats, NDArray, sp.csr_matrix]:
    """Unknowns (side, 3) of edge midpoints with conditions, directions (side, 3, 3) of which the last `kept`
    (side,) are free, and what the vertices, or the other side, say about the others.

    With m = m_nu nu + m_tau T a condition is c . u,nu = -(m_tau / m_nu) c . u,T, and u,T at the midpoint of
    a quintic is 15/8 [u] / L - 7/16 (u,T + u,T) + L/32 [u,TT]. What is tied on both sides of a line has the same u,T.
    """
    mesh, nodes = surface.mesh, surface.nodes
    scalar = [nodes.side_scalars(some, side) for some, side, _ in slopes]
    given = np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *scalar]))
    # of the sides of lines the second follows the first, or the one without conditions the other
    held = [np.isin(nodes.side_scalars(nodes.second, side), given) for side in range(2)]
    loose = nodes.hinged[nodes.second] | (held[0] & held[1])
    follow = nodes.second[~loose & (tied | held[0] | held[1])]
    follower = np.where(np.isin(follow, nodes.second[held[1]]), 0, 1)
    scalars = np.concatenate([given, nodes.side_scalars(follow, follower)])
    edges = np.where(scalars < nodes.first_fan, scalars - 6 * len(mesh.points), -1)
    later = edges < 0
    edges[later] = nodes.second[scalars[later] - nodes.first_side]
    ends = mesh.edges[edges]
    a, b = mesh.points[ends[:, 0], :2], mesh.points[ends[:, 1], :2]
    length = np.linalg.norm(b - a, axis=1)
    t = (b - a) / length[:, None]
    nu = np.stack([t[:, 1], -t[:, 0]], axis=1)  # the normal of kshell.elements.affine
    n, _, m, _, _ = across(surface.chart, 0.5 * (a + b), t)
    slant = -np.sum(m * t, axis=1) / np.sum(m * nu, axis=1)
    unknowns = 3 * scalars[:, None] + np.arange(3)
    conditions = np.zeros((len(scalars), 3 * max(len(slopes), 1), 3))
    for k, (mine, (_, _, fixed)) in enumerate(zip(scalar, slopes, strict=True)):
        mine = np.searchsorted(given, mine)
        directions = n[mine, None] if fixed is None else fixed[None]
        conditions[mine, 3 * k : 3 * k + directions.shape[1]] = directions
    conditions[len(given) :, 0] = n[len(given) :]
    _, size, directions = np.linalg.svd(conditions, full_matrices=False)
    independent = size > 1e-6
    onto = np.einsum("ei,eix,eiy->exy", independent, directions, directions)
    row, column, entry = [], [], []
    own, tie = slice(0, len(given)), slice(len(given), None)
    fans = np.where(later[:, None], nodes.fans_at(edges, 1), nodes.fans_at(edges, 0))
    for end, sign in ((0, -1.0), (1, 1.0)):
        tx, ty = t[own].T
        along = length[own]
        second_derivative = sign * along / 32
        parts = np.stack(
            [
                15 / 8 * sign / along,
                -7 / 16 * tx,
                -7 / 16 * ty,
                second_derivative * tx**2,
                2 * second_derivative * tx * ty,
                second_derivative * ty**2,
            ],
            axis=1,
        )
        block = np.einsum("e,exy,ek->exky", slant[own], onto[own], parts)
        at = nodes.fan_scalars(fans[own, end])
        where = (3 * at[:, :, None] + np.arange(3)).reshape(len(at), 18)
        row.append(np.repeat(unknowns[own], 18, axis=1).ravel())
        column.append(np.repeat(where[:, None], 3, axis=1).ravel())
        entry.append(block.ravel())
    other = 3 * nodes.side_scalars(follow, 1 - follower)[:, None] + np.arange(3)
    row.append(np.repeat(unknowns[tie], 3, axis=1).ravel())
    column.append(np.repeat(other[:, None], 3, axis=1).ravel())
    entry.append(onto[tie].ravel())
    shape = (surface.unknowns, surface.unknowns)
    place = (np.concatenate(row), np.concatenate(column))
    carried = sp.csr_matrix((np.concatenate(entry), place), shape=shape)
    return unknowns, directions, 3 - independent.sum(axis=1), carried
