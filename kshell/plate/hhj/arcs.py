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

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kshell.elements.hierarchic import hierarchic_jets, orthonormal, polynomial_count
from kshell.elements.jets import legendre
from kshell.elements.quadrature import interval_rule
from kshell.plate.domain import Patch
from kshell.plate.hhj.geometry import GRADIENTS, Triangles
from kshell.plate.hhj.tables import tables

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

BLOCK = 256  # triangles whose functions are tabulated at a time
BEYOND = 8  # points along an arc more than the order


class Arcs:
    """The triangles at curved edges of a domain.

    Parameters
    ----------
    triangles : Triangles
        With a domain.
    order : int
    held_slopes : (n,) int array
        Edges whose slope is held.

    Attributes
    ----------
    triangles : (c,) int array
    bent : (c, 3) bool array
        Which edges are curved.
    pure : (c, 3) bool array
        Which of them have alpha itself as their slope.
    back : (c, m, m) array
        Inverse of G.
    planes : (c, m, 3) array
        Unknowns of the plane through given values at the vertices.
    """

    def __init__(self, triangles: Triangles, order: int, held_slopes: Ints) -> None:
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
        self.pure = self.bent & np.isin(edges, held_slopes)
        self._functionals()

    def _functionals(self) -> None:
        """G of each triangle, its inverse, and the unknowns of planes."""
        t, n = self.tables, len(self.triangles)
        g = np.repeat(np.eye(t.count)[None], n, axis=0)
        self.planes = np.zeros((n, t.count, 3))
        self.planes[:, :3] = np.eye(3)
        plane_slopes = self.straight.plane_slopes[self.triangles]
        s, ws = interval_rule(self.order + BEYOND)
        k = np.arange(self.order)
        polynomials = legendre(self.order, s) * ws[:, None]
        for edge in range(3):
            self.planes[:, t.slopes(edge).start] = plane_slopes[:, edge]
            here = np.flatnonzero(self.bent[:, edge])
            if not len(here):
                continue
            _, speed, jets = self._along(here, edge, s)
            along = self._gradient(here, jets, speed)  # (n, point, m)
            scale = 2 * k[1:, None] + 1
            g[here, t.bubbles(edge)] = scale * (polynomials[:, 1 : self.order].T @ along)
            self.planes[here, t.bubbles(edge)] = g[here, t.bubbles(edge), :3]
            self.planes[here, t.slopes(edge)] = 0.0
            pure = np.flatnonzero(self.pure[here, edge])
            slope = self._plane(here, speed)[pure]
            self.planes[here[pure], t.slopes(edge)] = (2 * k[:, None] + 1) * (
                polynomials[:, : self.order].T @ slope
            )
        self.back: Floats = np.linalg.inv(g).astype(np.float64)

    def _along(self, here: Ints, edge: int, s: Floats) -> tuple[Floats, Floats, Floats]:
        """Points (n, point, 2) of curved edges, gamma' there, and jets (6, n, point, function) of w's functions."""
        chosen = self.triangles[here]
        numbers = self.straight.edges[chosen, edge]
        xy = self.domain.edge_points(numbers, s, s).xy
        speed = self.domain.edge_motion(numbers, s)[0]
        return xy, speed, hierarchic_jets(self.order, self.straight.reference(xy, chosen))

    def _gradient(self, here: Ints, jets: Floats, direction: Floats) -> Floats:
        """(n, point, m) derivatives of w along vectors (n, point, 2)."""
        reference = direction @ self.straight.inverse[self.triangles[here]].swapaxes(1, 2)
        out = np.zeros((*direction.shape[:2], self.tables.count))
        out[..., self.tables.deflection] = reference[..., :1] * jets[1] + reference[..., 1:] * jets[2]
        return out

    def _plane(self, here: Ints, speed: Floats) -> Floats:
        """(n, point, 3) alpha of the hats along curved edges."""
        gradient = GRADIENTS @ self.straight.inverse[self.triangles[here]]  # (n, vertex, xy)
        return _across(speed) @ gradient.swapaxes(1, 2)

    def slope_rows(self, here: Ints, edge: int, s: Floats) -> Floats:
        """(n, point, m) alpha at points of a curved edge, from c."""
        t = self.tables
        speed = self.domain.edge_motion(self.straight.edges[self.triangles[here], edge], s)[0]
        out = np.zeros((len(here), len(s), t.count))
        out[..., t.slopes(edge)] = legendre(self.order - 1, s)
        free = ~self.pure[here, edge]
        out[free, :, :3] = self._plane(here, speed)[free]
        return out

    def deflection_rows(self, here: Ints, edge: int, s: Floats) -> Floats:
        """(n, point, m) w at points of a curved edge, from c."""
        out = np.zeros((len(here), len(s), self.tables.count))
        out[..., self.tables.deflection] = self._along(here, edge, s)[2][0]
        return out

    def patch(self, place: Ints, degree: int) -> tuple[Patch, Floats]:
        """Quadrature over the true region of some of the triangles, and its reference coordinates here."""
        chosen = self.triangles[place]
        patch = self.domain.curved_patch(chosen, degree)
        return patch, self.straight.reference(patch.xy, chosen)

    @cached_property
    def _bulk(self) -> tuple[Floats, Floats]:
        """L (c, k, k), and (c, 3, k, m) integrals of psi with second derivatives 11, 22, 12, from c."""
        t, n, k = self.tables, len(self.triangles), polynomial_count(self.order - 1)
        low, integrals = np.empty((n, k, k)), np.zeros((n, 3, k, t.count))
        for start in range(0, n, BLOCK):
            place = np.arange(start, min(start + BLOCK, n))
            patch, xi = self.patch(place, 2 * self.order)
            psi = orthonormal(self.order - 1, xi)
            weighted = (psi * patch.weights[..., None]).swapaxes(1, 2)
            low[place] = np.linalg.cholesky(weighted @ psi)
            second = hierarchic_jets(self.order, xi)[3:]
            for component in range(3):
                integrals[place[:, None, None], component, np.arange(k)[:, None], t.deflection] = (
                    weighted @ second[component]
                )
        return low, integrals

    @property
    def low(self) -> Floats:
        """L (c, k, k)."""
        return self._bulk[0]

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
        low, integrals = self._bulk
        n, k = len(low), low.shape[1]
        root = np.sqrt(straight.area[self.triangles])[:, None, None]
        edges = strain_map[self.triangles] * root
        edges[..., :3] = 0.0
        for edge in range(3):
            here = np.flatnonzero(self.bent[:, edge])
            edges[here, :, 3 + 2 * edge : 5 + 2 * edge] = 0.0
            edges[here, :, 9 + edge] = 0.0
        out = (edges.reshape(-1, 12) @ t.rows).reshape(n, 3, k, t.count)
        components = (straight.curvature_map[self.triangles] @ integrals.reshape(n, 3, -1)).reshape(out.shape)
        s, ws = interval_rule(self.order + BEYOND)
        for edge in range(3):
            here = np.flatnonzero(self.bent[:, edge])
            if not len(here):
                continue
            xy, speed, jets = self._along(here, edge, s)
            left = self._gradient(here, jets, _across(speed)) - self.slope_rows(here, edge, s)
            normal = _across(speed) / np.linalg.norm(speed, axis=2, keepdims=True)
            nx, ny = normal[..., 0], normal[..., 1]
            outer = np.stack([nx * nx, ny * ny, 2 * nx * ny], axis=1)  # (n, component, point)
            outer = outer * (ws * straight.outward[self.triangles[here], edge, None])[:, None]
            psi = orthonormal(self.order - 1, straight.reference(xy, self.triangles[here]))
            test = outer[:, :, None] * psi.swapaxes(1, 2)[:, None]  # (n, component, psi, point)
            components[here] -= test @ left[:, None]
        own = factor if factor.ndim == 2 else factor[self.triangles]
        out += (own @ components.reshape(n, 3, -1)).reshape(out.shape)
        scaled: Floats = np.linalg.solve(low[:, None], out @ self.back[:, None]).astype(np.float64)
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
    return np.stack([speed[..., 1], -speed[..., 0]], axis=-1)
