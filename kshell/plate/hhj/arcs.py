"""Triangles at curved edges, on their true region.

They keep the polynomials of the straight triangle, extended to the edge gamma(s), and are integrated over the region
that the edge bounds (`kshell.plate.domain`). Their unknowns are those of straight triangles but for a curved edge:

- bubble k is (2 k + 3) int d/ds w(gamma(s)) P_{k+1}(s) ds, on straight edges the coefficient of the bubble itself. With
  w at the ends these are its moments along the arc to degree order - 2: a supported arc holds them, and at the usual
  orders that is as good as w = 0 (w at points of the arc is not).
- slopes are coefficients of alpha(s) = |gamma'| dw/dn, where supports hold it; elsewhere of what alpha has beyond the
  plane through the vertices, so that rigid motions have no strains at all.

Symbols
-------
c          coefficients of hierarchic functions and slopes; the unknowns are u = G c
L          factor of the mass matrix of psi over the true region, L L^T; the root of J on straight triangles
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kshell.elements.hierarchic import orthonormal, polynomial_count
from kshell.elements.jets import legendre
from kshell.elements.quadrature import interval_rule
from kshell.plate.domain import Patch
from kshell.plate.hhj.geometry import GRADIENTS, TURN, Triangles
from kshell.plate.hhj.tables import Tables, tables

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

BLOCK = 256  # triangles whose functions are tabulated at a time
BEYOND = 8  # points along an arc more than the order


@dataclass(frozen=True)
class Alongside:
    """Points along curved edges.

    Attributes
    ----------
    speed : (n, point, 2) array
        gamma'.
    psi : (n, point, k) array
        Of the degree of w.
    polynomials : (point, order + 1) array
        Legendre's.
    weights : (point,) array
    tables : Tables
    inverse : (n, 2, 2) array
        Of the triangles.
    """

    speed: Floats
    psi: Floats
    polynomials: Floats
    weights: Floats
    tables: Tables
    inverse: Floats

    @cached_property
    def gradient(self) -> Floats:
        """(2, n, point, m) of w's functions, by reference coordinates."""
        return self.psi @ self.tables.jets[1:3, None]

    def derivative(self, direction: Floats) -> Floats:
        """(n, point, m) derivatives of w along vectors (n, point, 2)."""
        a, b = (direction @ self.inverse.swapaxes(1, 2)).transpose(2, 0, 1)[..., None]
        return a * self.gradient[0] + b * self.gradient[1]


class Arcs:
    """The triangles at curved edges of a domain.

    Parameters
    ----------
    triangles : Triangles
        With a domain.
    order : int
    held_slopes : (n,) int array
        Edges whose slope is held.
    degree : int
        Of polynomials that are integrated later: the same points are taken for all.

    Attributes
    ----------
    triangles : (c,) int array
    bent : (c, 3) bool array
        Which edges are curved.
    pure : (c, 3) bool array
        Which of them have alpha itself as their slope.
    pairs, pair_edges : (pair,) int arrays
        Places of triangles and local edges of all curved edges.
    back : (c, m, m) array
        Inverse of G.
    planes : (c, m, 3) array
        Unknowns of the plane through given values at the vertices.
    """

    def __init__(self, triangles: Triangles, order: int, held_slopes: Ints, degree: int = 0) -> None:
        self.degree = degree
        self._latest: tuple[Patch, Floats] | None = None
        assert triangles.domain is not None
        self.straight, self.domain, self.order = triangles, triangles.domain, order
        self.tables = tables(order)
        self.triangles: Ints = self.domain.curved_triangles
        self.place = np.full(len(triangles), -1)
        self.place[self.triangles] = np.arange(len(self.triangles))
        edges = triangles.edges[self.triangles]
        curves = self.domain.curves
        where = np.minimum(curves.place(edges), len(curves.edges) - 1)
        self.bent = (curves.edges[where] == edges) & curves.curved[where]
        held = np.zeros(len(triangles.mesh.edges), dtype=bool)
        held[held_slopes] = True
        self.pure = self.bent & held[edges]
        self.pairs, self.pair_edges = np.nonzero(self.bent)
        self._functionals()

    def _functionals(self) -> None:
        """G of each triangle, its inverse, and the unknowns of planes."""
        t, n = self.tables, len(self.triangles)
        g = np.repeat(np.eye(t.count)[None], n, axis=0)
        self.planes = np.zeros((n, t.count, 3))
        self.planes[:, :3] = np.eye(3)
        self.planes[:, 3 * self.order :: self.order][:, :3] = self.straight.plane_slopes[self.triangles]
        at, edges, along = self.pairs, self.pair_edges, self._alongside
        k = np.arange(self.order)
        polynomials = along.polynomials[:, : self.order] * along.weights[:, None]
        bubbles = at[:, None], 3 + edges[:, None] * (self.order - 1) + k[:-1]
        by_s = along.derivative(along.speed)  # (pair, point, m)
        g[bubbles] = (2 * k[1:, None] + 1) * (polynomials[:, 1:].T @ by_s)
        self.planes[bubbles] = g[bubbles][..., :3]
        slopes = at[:, None], 3 * self.order + edges[:, None] * self.order + k
        self.planes[slopes] = 0.0
        pure = np.flatnonzero(self.pure[at, edges])
        if len(pure):
            slope = self._plane(at[pure], along.speed[pure])
            self.planes[at[pure, None], slopes[1][pure]] = (2 * k[:, None] + 1) * (polynomials.T @ slope)
        # all rows but those of the bubbles are those of the identity
        own = slice(3, 3 * self.order)
        inverse: Floats = np.linalg.inv(g[:, own, own]).astype(np.float64)
        rows = g[:, own]
        rows[..., own] = 0.0
        self.back: Floats = np.repeat(np.eye(t.count)[None], n, axis=0)
        self.back[:, own] = inverse @ -rows
        self.back[:, own, own] = inverse

    @cached_property
    def _alongside(self) -> Alongside:
        """Gauss points of all curved edges, for `_functionals` and `rows`."""
        s, weights = interval_rule(self.order + BEYOND)
        return self._along(self.pairs, self.pair_edges, s, weights)

    def _along(self, here: Ints, edge: Ints | int, s: Floats, weights: Floats) -> Alongside:
        """Points of curved edges of some triangles."""
        chosen = self.triangles[here]
        xy, speed = self.domain.edge_motion(self.straight.edges[chosen, edge], s)[:2]
        psi = orthonormal(self.order, self.straight.reference(xy, chosen))
        return Alongside(
            speed, psi, legendre(self.order, s), weights, self.tables, self.straight.inverse[chosen]
        )

    def _plane(self, here: Ints, speed: Floats) -> Floats:
        """(n, point, 3) alpha of the hats along curved edges."""
        gradient = GRADIENTS @ self.straight.inverse[self.triangles[here]]  # (n, vertex, xy)
        return _across(speed) @ gradient.swapaxes(1, 2)

    def slope_rows(self, here: Ints, edge: int, s: Floats) -> Floats:
        """(n, point, m) alpha at points of a curved edge, from c."""
        t = self.tables
        speed = self.domain.edge_motion(self.straight.edges[self.triangles[here], edge], s)[1]
        out = np.zeros((len(here), len(s), t.count))
        out[..., t.slopes(edge)] = legendre(self.order - 1, s)
        free = ~self.pure[here, edge]
        out[free, :, :3] = self._plane(here, speed)[free]
        return out

    def deflection_rows(self, here: Ints, edge: int, s: Floats) -> Floats:
        """(n, point, m) w at points of a curved edge, from c."""
        return self._along(here, edge, s, s).psi @ self.tables.jets[0]

    def patch(self, place: Ints, degree: int) -> tuple[Patch, Floats]:
        """Quadrature over the true region of some of the triangles, and its reference coordinates here."""
        chosen = self.triangles[place]
        patch = self.domain.curved_patch(chosen, degree)
        return patch, self.straight.reference(patch.xy, chosen)

    def tabulated(self, place: Ints, degree: int) -> tuple[Patch, Floats]:
        """The same with psi of the degree of w there; of all triangles, where these are few, what is at hand."""
        patch = self.domain.curved_patch(self.triangles[place], degree)
        if self._latest is not None and self._latest[0] is patch:
            return self._latest
        found = patch, orthonormal(self.order, self.straight.reference(patch.xy, patch.triangles))
        if len(place) == len(self.triangles) <= BLOCK:
            self._latest = found
        return found

    @cached_property
    def _bulk(self) -> tuple[Floats, Floats, Floats]:
        """L^-1 (c, k, k), (c, 3, k, m) integrals of psi with second derivatives 11, 22, 12, and (c, m) of w, from c."""
        t, n, k = self.tables, len(self.triangles), polynomial_count(self.order - 1)
        mass = np.empty((n, k, polynomial_count(self.order)))
        for start in range(0, n, BLOCK):
            place = np.arange(start, min(start + BLOCK, n))
            patch, psi = self.tabulated(place, max(2 * self.order, self.degree))
            weighted = (psi[..., :k] * patch.weights[..., None]).swapaxes(1, 2)
            mass[place] = weighted @ psi
        low = np.linalg.inv(np.linalg.cholesky(mass[..., :k]))
        second = mass[:, None] @ t.jets[3:]
        return low, second, (mass[:, 0] / np.sqrt(2.0)) @ t.jets[0]  # psi_0 is the root of 2

    @property
    def up(self) -> Floats:
        """L^-1 (c, k, k)."""
        return self._bulk[0]

    @property
    def integrals(self) -> Floats:
        """(c, m) integrals of w, from c."""
        return self._bulk[2]

    def rows(self, strain_map: Floats, factor: Floats) -> Floats:
        """(c, 3 k, m) l as a matrix on the unknowns.

        Parameters
        ----------
        strain_map : (T, 3, 12) array
            Of `Triangles.strain_map`, for the straight edges.
        factor : (3, 3) or (T, 3, 3) array
            B.
        """
        t, straight = self.tables, self.straight
        up, second, _ = self._bulk
        n, k = len(up), up.shape[1]
        at, edges, along = self.pairs, self.pair_edges, self._alongside
        left = along.derivative(_across(along.speed))  # (pair, point, m)
        free = np.flatnonzero(~self.pure[at, edges])
        slopes = 3 * self.order + edges[:, None] * self.order + np.arange(self.order)
        left[np.arange(len(at))[:, None], :, slopes] -= along.polynomials[:, : self.order].T
        left[free, :, :3] -= self._plane(at[free], along.speed[free])
        nx, ny = _across(along.speed / np.hypot(along.speed[..., :1], along.speed[..., 1:])).transpose(
            2, 0, 1
        )
        outer = np.stack([nx * nx, ny * ny, 2 * nx * ny], axis=1)  # (pair, component, point)
        outer *= (along.weights * straight.outward[self.triangles[at], edges, None])[:, None]
        test = outer[:, :, None] * along.psi[..., :k].swapaxes(1, 2)[:, None]  # (pair, component, psi, point)
        on_edges = (test.reshape(len(at), 3 * k, -1) @ left).reshape(len(at), 3, k, t.count)
        components = (straight.curvature_map[self.triangles] @ second.reshape(n, 3, -1)).reshape(second.shape)
        np.subtract.at(components, at, on_edges)
        # straight edges, and what B makes of the rest
        root = np.sqrt(straight.area[self.triangles])[:, None, None]
        maps = strain_map[self.triangles] * root
        maps[..., :3] = 0.0
        maps[at[:, None], :, np.stack([3 + 2 * edges, 4 + 2 * edges, 9 + edges], axis=1)] = 0.0
        out = (maps.reshape(-1, 12) @ t.rows).reshape(n, 3, k, t.count)
        own = factor if factor.ndim == 2 else factor[self.triangles]
        out += (own @ components.reshape(n, 3, -1)).reshape(out.shape)
        scaled: Floats = up[:, None] @ (out.reshape(n, 3 * k, -1) @ self.back).reshape(out.shape)
        return scaled.reshape(n, 3 * k, t.count)

    def to_unknowns(self, local: Floats) -> None:
        """Turn forces on c into forces on the unknowns, in place: (T, m)."""
        local[self.triangles] = (local[self.triangles][:, None] @ self.back)[:, 0]

    def rows_on_unknowns(self, chosen: Ints, rows: Floats) -> Floats:
        """Rows (n, r, m) on c of some triangles (n,) as rows on the unknowns."""
        place = self.place[chosen]
        at = np.flatnonzero(place >= 0)
        rows = rows.copy()
        rows[at] = rows[at] @ self.back[place[at]]
        return rows

    def coefficients(self, local: Floats) -> Floats:
        """c of unknowns (T, m)."""
        out = local.copy()
        out[self.triangles] = (self.back @ local[self.triangles][..., None])[..., 0]
        return out


def _across(speed: Floats) -> Floats:
    """Vectors turned by -90 degrees: normals times |gamma'|."""
    return speed[..., ::-1] * TURN
