"""Piecewise polynomials along chains of edges: what a line force is that nodal forces stand for.

Nodal forces f_i are the work of a line force V and of forces R at the ends of a chain on the functions phi_i of nodes,

    int V phi_i ds + R_end phi_i(end) = f_i.

The functions that vanish at the ends are as many as continuous polynomials of the degree m of the traces whose
outermost edges have a degree less, which is the pairing of mortar methods (C. Bernardi, Y. Maday & A. T. Patera, in:
Nonlinear Partial Differential Equations and Their Applications, Collège de France Seminar XI, 1994): V is unique, and
force and moment of V and R together are those of the nodal forces wherever the phi_i contain rigid motions.

Symbols
-------
m          degree of V
s          place on an edge, from 0 at its lower to 1 at its higher vertex
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.elements.jets import legendre
from kshell.mesh.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Chain:
    """Edges one after the other.

    Attributes
    ----------
    edges : (n,) int array
    vertices : (n + 1,) int array
        From end to end; the first is the last of a closed chain.
    """

    edges: Ints
    vertices: Ints

    @property
    def closed(self) -> bool:
        """Whether it has no ends."""
        return bool(self.vertices[0] == self.vertices[-1])


def chains(mesh: Mesh, edges: Ints, stops: NDArray[np.bool_]) -> list[Chain]:
    """Edges in chains that end where they branch or end, and at vertices of `stops` (vertex,).

    A closed chain with one stop ends there on both sides.
    """
    ends = mesh.edges[edges].astype(np.int64)
    degree = np.bincount(ends.ravel(), minlength=len(mesh.points))
    stop = stops | ((degree != 2) & (degree > 0))
    at: dict[int, list[int]] = {}
    for k, pair in enumerate(ends.tolist()):
        for v in pair:
            at.setdefault(v, []).append(k)
    used = np.zeros(len(edges), dtype=bool)
    out = []

    def walk(v: int, k: int) -> None:
        first, path, way = v, [v], []
        while not used[k]:
            used[k] = True
            way.append(int(edges[k]))
            v = int(ends[k].sum()) - v
            path.append(v)
            if stop[v] or v == first:
                break
            k = next(other for other in at[v] if other != k)
        out.append(Chain(np.array(way, dtype=np.int64), np.array(path, dtype=np.int64)))

    for v in sorted(v for v in at if stop[v]):
        for k in at[v]:
            if not used[k]:
                walk(v, k)
    for k in range(len(edges)):
        if not used[k]:
            walk(int(ends[k, 0]), k)
    return out


def turns(mesh: Mesh, edges: Ints, tangents: Floats, cosine: float) -> NDArray[np.bool_]:
    """(vertex,) whether two of the edges meet there at an angle, from tangents (edge, end, k) from lower to higher."""
    ends = mesh.edges[edges]
    leaving = tangents * np.array([1.0, -1.0])[:, None]
    total = np.zeros((len(mesh.points), tangents.shape[2]))
    np.add.at(total, ends.ravel(), leaving.reshape(-1, tangents.shape[2]))
    # unit vectors a, b that leave a vertex: |a + b|^2 = 2 + 2 a.b, zero straight on
    return np.asarray((total**2).sum(axis=1) > 2.0 - 2.0 * cosine)


class ChainFunctions:
    """Continuous polynomials of degree m along chains.

    Parameters
    ----------
    stops : (vertex,) bool array
        As of `chains`.
    paired : bool
        Whether the degree is one less on the outermost edges of open chains, for functions that vanish at the ends.

    Attributes
    ----------
    edges : (n,) int array
        All edges, chain by chain.
    count : int
        Number of functions.
    """

    def __init__(
        self,
        mesh: Mesh,
        found: list[Chain],
        degree: int,
        stops: NDArray[np.bool_],
        paired: bool = True,
    ) -> None:
        self.degree = degree
        self.edges: Ints = np.concatenate([np.zeros(0, dtype=np.int64), *(c.edges for c in found)])
        columns, kept, start = [], [], 0
        for chain in found:
            n = len(chain.edges)
            round_about = chain.closed and not stops[chain.vertices[0]]
            corners = start + np.arange(n + 1)
            if round_about:
                corners[-1] = start
            bubbles = start + n + 1 + np.arange(n * (degree - 1)).reshape(n, degree - 1)
            ahead = mesh.edges[chain.edges, 0] == chain.vertices[:-1]
            pair = np.stack([corners[:-1], corners[1:]], axis=1)
            columns.append(np.concatenate([np.where(ahead[:, None], pair, pair[:, ::-1]), bubbles], axis=1))
            kept.append(_kept(corners, bubbles, n, paired and not round_about))
            start += n + 1 + n * (degree - 1)
        self.columns: Ints = np.concatenate(columns) if columns else np.zeros((0, degree + 1), dtype=np.int64)
        table = [np.concatenate([np.zeros(0, dtype=np.int64), *parts]) for parts in zip(*kept, strict=True)]
        if not table:
            table = [np.zeros(0, dtype=np.int64)] * 2
        numbers, place = np.unique(table[1], return_inverse=True)
        self.count = len(numbers)
        self._reduced = sp.csr_matrix((np.ones(len(place)), (table[0], place)), shape=(start, self.count))

    def values(self, s: Floats) -> Floats:
        """(point, m + 1) of an edge at points s: hats of its lower and higher vertex, and bubbles."""
        p = legendre(self.degree, s)
        out = [1.0 - s, s]
        out += [p[..., k] - p[..., k - 2] for k in range(2, self.degree + 1)]
        return np.stack(out, axis=-1)

    def coupled(self, rows: Ints, tests: Floats, weights: Floats, s: Floats, count: int) -> sp.csr_matrix:
        """(count, functions) integrals of test functions times functions.

        Parameters
        ----------
        rows : (edge, k) int array
            Number of each test function on an edge; -1 for none.
        tests : (edge, point, k) or (point, k) array
            Their values at s (point,).
        weights : (edge, point) array
            Lengths.
        """
        values = self.values(s)
        local = np.swapaxes(np.broadcast_to(tests, (len(self.edges), *tests.shape[-2:])), 1, 2) @ (
            weights[:, :, None] * values
        )
        i = np.broadcast_to(rows[:, :, None], local.shape)
        j = np.broadcast_to(self.columns[:, None, :], local.shape)
        good = i >= 0
        full = sp.csr_matrix((local[good], (i[good], j[good])), shape=(count, self._reduced.shape[0]))
        return full @ self._reduced

    def at(self, coefficients: Floats, s: Floats) -> Floats:
        """(edge, point, ...) values at s of functions with coefficients (functions, ...)."""
        full = self._reduced @ coefficients
        return np.einsum("qk,ek...->eq...", self.values(s), full[self.columns])


def _kept(corners: Ints, bubbles: Ints, n: int, paired: bool) -> tuple[Ints, Ints]:
    """Functions that stay, and the number of what each is part of; the lowest degree of an edge is a constant."""
    owner = {int(c): int(c) for c in [*corners, *bubbles.ravel()]}
    for edge, end, inner in ((0, 0, 1), (n - 1, n, n - 1)) if paired else ():
        left = [int(c) for c in bubbles[edge] if int(c) in owner]
        if left:
            del owner[left[-1]]
        elif owner.get(int(corners[end])) == int(corners[end]) != owner[int(corners[inner])]:
            owner[int(corners[end])] = owner[int(corners[inner])]  # constant along the edge
        else:
            for c in (corners[end], corners[inner]):
                owner.pop(int(c), None)  # no function at all: a single edge whose nodes are its ends
    keys = np.array(list(owner), dtype=np.int64)
    return keys, np.array(list(owner.values()), dtype=np.int64)
