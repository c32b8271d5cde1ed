"""Force and moment per length that supports exert on a plate along lines, and what is concentrated at ends and corners.

For every deflection v of the element,

    a(w, v) - f(v) = int V v ds - int M v_n ds + sum R v(end),

with V = Q_n + dM_nt/ds and M = M_nn of the exact solution. V and M are piecewise polynomials for which this holds
(`kshell.elements.along`): V of degree 3 for the quintic traces of Argyris elements, M of degree 2, which follows the
slopes of degree 4 in the mean and has no waves of the mesh; of degree 1 and 0 for Morley's values at vertices and
slopes of edges. They converge faster than derivatives of the deflection, and together with R they have force and moment
of all supports exactly, on quintics by the smallest change that gives them.

Symbols
-------
B          (dof, c) work of the unknowns c = (V, M, R) on the degrees of freedom of the element
r          (dof,) the work of K d - f on them
G, g       work of c on the three rigid motions of the plate, and what supports do on them
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.elements.along import ChainFunctions, chains, turns
from kshell.elements.quadrature import interval_rule
from kshell.plate.domain import Domain, EdgePatch
from kshell.plate.forms import edge_rows
from kshell.plate.held import Supports
from kshell.plate.layout import Layout
from kshell.plate.linear_form import LinearForm
from kshell.plate.loading import PointLoad

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# edges that turn by more meet in a corner; chords of a curve turn, too
CORNER, CORNER_OF_CHORDS = np.radians(0.1), np.radians(25.0)
POINTS = 8  # Gauss points of an edge
SOFT = 1e-12  # weight of the size of c against that of what B c misses
ROUNDS = 4  # of corrections, after which the weight is not felt


def union(*parts: Any) -> Ints:
    """Sorted numbers of several arrays, without repetition."""
    none = np.zeros(0, dtype=np.int64)
    return np.unique(np.concatenate([none, *(np.ravel(part) for part in parts)])).astype(np.int64)


class Lines:
    """Where the supports of a plate hold it along lines.

    Attributes
    ----------
    held, turned : (n,) int arrays
        Edges along which the deflection, and whose slope is held.
    stops : (vertex,) bool array
        Corners of lines, points that are held alone, and points that bear forces.
    ends : (n,) int array
        Vertices with a concentrated force: ends of chains, and held points.
    """

    def __init__(self, domain: Domain, supports: Supports, loads: Sequence[LinearForm]) -> None:
        mesh, groups = domain.mesh, supports.held
        self.held, self.turned = union(*(g.line for g in groups)), union(*(g.edges for g in groups))
        edges, points = union(self.held, self.turned), union(*(g.points for g in groups))
        corner = CORNER if len(domain.boundary.edges) else CORNER_OF_CHORDS
        self.stops = turns(mesh, edges, domain.tangents(edges), float(np.cos(corner)))
        self.stops[points] = True
        for load in loads:
            if isinstance(load, PointLoad):
                self.stops[int(np.linalg.norm(domain.points - load.xy, axis=1).argmin())] = True
        self.held_chains = chains(mesh, self.held, self.stops)
        self.turned_chains = chains(mesh, self.turned, self.stops)
        ends = [c.vertices[[0, -1]] for c in self.held_chains if not c.closed or self.stops[c.vertices[0]]]
        self.ends = union(points, *ends)


class LineForces:
    """V, M and R of all supports, found together: at corners they share degrees of freedom.

    Parameters
    ----------
    r : (dof,)
    centre : (2,)
        About which the rigid motions turn.
    wanted : (3,)
        g.
    """

    def __init__(
        self, domain: Domain, layout: Layout, lines: Lines, r: Floats, centre: Floats, wanted: Floats
    ) -> None:
        self.domain, self.layout, self.lines = domain, layout, lines
        self.mesh, self.element = domain.mesh, layout.element
        self._r, self._centre, self._wanted = r, centre, wanted
        self._quintic = self.element.maxdeg > 2
        degree = 3 if self._quintic else 1
        self._v = ChainFunctions(self.mesh, lines.held_chains, degree, lines.stops)
        self._m = ChainFunctions(self.mesh, lines.turned_chains, 2, lines.stops, paired=False)

    def force(self, s: Floats) -> Floats:
        """(edge, point) V at points s of every edge of the mesh, zero on those that are not held."""
        out = np.zeros((len(self.mesh.edges), len(s)))
        out[self._v.edges] = self._v.at(self._found[0], s)
        return out

    def moment(self, s: Floats) -> Floats:
        """(edge, point) M, in the sense of an edge moment on the first triangle of each edge."""
        out = np.zeros((len(self.mesh.edges), len(s)))
        m = self._found[1]
        out[self._m.edges] = self._m.at(m, s) if self._quintic else m[:, None]
        return out

    @property
    def at_ends(self) -> Floats:
        """(end,) R."""
        return self._found[2]

    @cached_property
    def _found(self) -> tuple[Floats, Floats, Floats]:
        return self._quintics() if self._quintic else self._lumped()

    def _lumped(self) -> tuple[Floats, Floats, Floats]:
        """Of Morley's element, whose values at vertices are those of hats along the edges."""
        layout, mesh, r = self.layout, self.mesh, self._r
        s, w = interval_rule(2)
        rows = mesh.edges[self._v.edges].astype(np.int64)
        weights = mesh.edge_lengths[self._v.edges][:, None] * w
        b = self._v.coupled(rows, self._v.values(s), weights, s, len(mesh.points))
        at_vertices = r[layout.vertex_dofs(np.arange(len(mesh.points)))[:, 0]]
        inner = np.setdiff1d(rows, self.lines.ends)
        from scipy.sparse.linalg import spsolve  # not loaded by what solves nothing

        v = np.asarray(spsolve(b[inner].tocsc(), at_vertices[inner])) if len(inner) else np.zeros(0)
        # the slope of an edge is along its tangent turned by -90 degrees, M is for the outward normal
        edges = self._m.edges
        normal = self._patch(edges, np.array([0.5]), np.ones(1)).normal[:, 0]
        ends = self.domain.points[mesh.edges[edges]]
        chord = ends[:, 1] - ends[:, 0]
        sense = np.sign(chord[:, 1] * normal[:, 0] - chord[:, 0] * normal[:, 1])
        m = -sense * r[layout.edge_dofs(edges)] / mesh.edge_lengths[edges]
        return v, m, np.asarray((at_vertices - b @ v)[self.lines.ends])

    def _quintics(self) -> tuple[Floats, Floats, Floats]:
        layout, ends = self.layout, self.lines.ends
        places = (layout.vertex_dofs(ends)[:, 0], np.arange(len(ends)))
        at_ends = sp.csr_matrix((np.ones(len(ends)), places), shape=(layout.count, len(ends)))
        b = sp.hstack([self._work(self._v, False), self._work(self._m, True), at_ends]).tocsr()
        vertices = union(self.mesh.edges[union(self.lines.held, self.lines.turned)], ends)
        fans = np.flatnonzero(np.isin(layout.fans.vertex, vertices))
        dofs = union(layout.fan_dofs(fans), layout.edge_dofs(self.lines.turned))
        scale = layout.scale[dofs]
        c = _least(sp.diags(scale) @ b[dofs], scale * self._r[dofs], self._rigid(), self._wanted)
        v, m = self._v.count, self._m.count
        return c[:v], c[v : v + m], c[v + m :]

    def _patch(self, edges: Ints, s: Floats, w: Floats, side: int = 0) -> EdgePatch:
        return self.domain.edge_points(edges, s, w, side)

    def _work(self, functions: ChainFunctions, slope: bool) -> sp.csr_matrix:
        """(dof, functions) of V on w, or of M on -w_n; along lines inside the mean of both sides."""
        layout, edges = self.layout, functions.edges
        out = sp.csr_matrix((layout.count, functions.count))
        if not len(edges):
            return out
        s, w = interval_rule(POINTS)
        inside = self.mesh.edge_counts[edges] > 1
        for side in range(1 + int(inside.any())):
            patch = self._patch(edges, s, w, side)
            affine = self.domain.affine(patch.triangles)
            rows = edge_rows(
                self.element, affine, patch, slice(None), slope, self.element.transformation(affine)
            )[:, :, 0]
            if slope and side == 0:
                rows = -rows  # seen from the other side the normal is the opposite one
            weights = patch.weights * np.where(inside, 0.5, 1.0 - side)[:, None]
            out = out + functions.coupled(
                layout.triangle_dofs(patch.triangles), rows, weights, s, layout.count
            )
        return out

    def _rigid(self) -> Floats:
        """G (3, c): w = 1, y, -x about the centre, and -w_n of these."""
        s, w = interval_rule(POINTS)
        parts = []
        for functions, slope in ((self._v, False), (self._m, True)):
            patch = self._patch(functions.edges, s, w)
            arm, n = patch.xy - self._centre, patch.normal
            one, turn = (0.0 * n[..., 0], -n[..., ::-1]) if slope else (1.0 + 0.0 * n[..., 0], arm[..., ::-1])
            tests = np.stack([one, turn[..., 0], -turn[..., 1]], axis=-1)
            rows = np.broadcast_to(np.arange(3), (len(functions.edges), 3))
            parts.append(functions.coupled(rows, tests, patch.weights, s, 3).toarray())
        arm = self.domain.points[self.lines.ends] - self._centre
        parts.append(np.stack([np.ones(len(arm)), arm[:, 1], -arm[:, 0]]))
        return np.concatenate(parts, axis=1)


def _least(b: sp.csr_matrix, r: Floats, g: Floats, wanted: Floats) -> Floats:
    """c with the least misfit of B c = r among those of G c = g; of several the smallest."""
    size = np.sqrt(np.asarray(b.multiply(b).sum(axis=0)).ravel())
    size[size == 0.0] = 1.0
    b, g = (b @ sp.diags(1.0 / size)).tocsr(), g / size
    from scipy.sparse.linalg import splu

    factors = splu((b.T @ b + SOFT * sp.identity(b.shape[1])).tocsc())
    c = np.zeros(b.shape[1])
    for _ in range(ROUNDS):
        c += factors.solve(b.T @ (r - b @ c))
    # the nearest c, in the misfit, with the resultants of the supports
    ways = np.stack([factors.solve(row) for row in g], axis=1)
    return np.asarray((c + ways @ np.linalg.lstsq(g @ ways, wanted - g @ c, rcond=1e-12)[0]) / size)
