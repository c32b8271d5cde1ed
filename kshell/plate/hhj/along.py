"""Force and moment per length of supports, from the work that this element's unknowns along edges lack.

w is a polynomial of degree p on every edge, by its values at vertices and bubbles, and a slope is length w_n = sum_m
alpha_m P_m with Legendre polynomials P_m: V is of degree p (`kshell.elements.along`), M is sum_m -(2 m + 1) r_m P_m
with the work r_m on alpha_m. Along arcs both are as accurate as the element.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kshell.elements.along import ChainFunctions
from kshell.elements.jets import legendre
from kshell.elements.quadrature import interval_rule
from kshell.plate.domain import Domain
from kshell.plate.hhj.system import HHJSystem
from kshell.plate.line_forces import Lines

Floats = NDArray[np.float64]


class HHJLineForces:
    """V, M and R of all supports.

    Parameters
    ----------
    residual : (count,)
        What the unknowns lack to equilibrium.
    """

    def __init__(self, domain: Domain, system: HHJSystem, lines: Lines, residual: Floats) -> None:
        self._domain, self._system, self._lines, self._residual = domain, system, lines, residual
        self._v = ChainFunctions(domain.mesh, lines.held_chains, system.order, lines.stops)

    def force(self, s: Floats) -> Floats:
        """(edge, point) V at points s of every edge of the mesh, zero on those that are not held."""
        out = np.zeros((len(self._domain.mesh.edges), len(s)))
        out[self._v.edges] = self._v.at(self._found[0], s)
        return out

    def moment(self, s: Floats) -> Floats:
        """(edge, point) M, in the sense of an edge moment on the first triangle of each edge."""
        mesh, order, edges = self._domain.mesh, self._system.order, self._lines.turned
        out = np.zeros((len(mesh.edges), len(s)))
        r = self._residual[self._system.numbering.slope_start :].reshape(-1, order)[edges]
        # w_n of the unknowns is along the tangent turned by -90 degrees, M is for the outward normal
        normal = self._domain.edge_points(edges, np.array([0.5]), np.ones(1)).normal[:, 0]
        ends = mesh.points[mesh.edges[edges], :2]
        chord = ends[:, 1] - ends[:, 0]
        sense = np.sign(chord[:, 1] * normal[:, 0] - chord[:, 0] * normal[:, 1])
        out[edges] = -sense[:, None] * ((r * (2 * np.arange(order) + 1)) @ legendre(order - 1, s).T)
        return out

    @property
    def at_ends(self) -> Floats:
        """(end,) R."""
        return self._found[1]

    @cached_property
    def _found(self) -> tuple[Floats, Floats]:
        numbering, order, edges = self._system.numbering, self._system.order, self._v.edges
        bubbles = numbering.vertices + edges[:, None] * (order - 1) + np.arange(order - 1)
        rows = np.concatenate([self._domain.mesh.edges[edges].astype(np.int64), bubbles], axis=1)
        s, w = interval_rule(order + 4)
        tables = self._system.tables
        tests = tables.on_edge(0, s)[:, [0, 1, *range(tables.bubbles(0).start, tables.bubbles(0).stop)]]
        weights = self._domain.edge_points(edges, s, w).weights
        r = self._residual[: numbering.slope_start]
        b = self._v.coupled(rows, tests, weights, s, len(r))
        inner = np.setdiff1d(rows, self._lines.ends)
        from scipy.sparse.linalg import spsolve  # not loaded by what solves nothing

        v = np.asarray(spsolve(b[inner].tocsc(), r[inner])) if len(inner) else np.zeros(0)
        return v, np.asarray((r - b @ v)[self._lines.ends])
