"""Deflection, rotation, moments, shear forces and stresses from a solution.

Moments are M = -D (kappa - kappa_0), kappa = (w_xx, w_yy, 2 w_xy); shear forces Q = div M. With Argyris
all of them come from the polynomial of the triangle, at vertices averaged over the triangles of a fan,
weighted by area: where lines of discontinuity meet a vertex there is a row for each fan. For points on such a line the
side with the largest stress is taken. Morley has one moment per
triangle: vertex values come from a linear least-squares fit over the triangles around each vertex
(Zienkiewicz & Zhu, Int. J. Numer. Meth. Eng. 33 (1992) 1331-1364), values between from the vertices.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.elements import matrices
from kshell.elements.reference import VERTICES
from kshell.material.section import BOTTOM, MIDDLE, TOP, Section
from kshell.mesh.connected import connected_parts
from kshell.plate.domain import BLOCK, Domain
from kshell.plate.forms import Bending
from kshell.plate.layout import Layout
from kshell.plate.line_points import LinePoints
from kshell.plate.loads import Loads
from kshell.plate.places import points_3d
from kshell.plate.points import Located, PlatePoints
from kshell.plate.sharing import Shared
from kshell.result.rows import Rows

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FEW = 16  # triangles that probes lie in
STEP = 1e-5  # of a triangle's size: differences of a varying stiffness


class Fields:
    """Everything that can be read off a solution, at vertices and anywhere.

    Parameters
    ----------
    d : (dof,) array
        Physical degrees of freedom.
    jump : (edge,) bool array, optional
        Edges across which moments may jump.
    """

    def __init__(
        self,
        domain: Domain,
        layout: Layout,
        bending: Bending,
        section: Section,
        loads: Loads,
        d: Floats,
        jump: NDArray[np.bool_] | None = None,
    ) -> None:
        self.domain, self.layout, self.bending = domain, layout, bending
        self.section, self.loads, self.d = section, loads, d
        self.element = layout.element
        self.polynomial_moments = self.smooth = (
            self.element.maxdeg > 2
        )  # smooth: w and its gradient nowhere jump
        self._jump = jump

    def derivatives(self, triangles: Ints, xi: Floats, order: int) -> Floats:
        """Derivatives of one order at reference points, (n, point, partial); order 2 is w_xx, w_yy, 2 w_xy."""
        table = self.element.basis.tabulate(xi, order)  # (..., point, partial, reference dof)
        parts = []
        for start in range(0, len(triangles), BLOCK):
            block = triangles if len(triangles) <= BLOCK else triangles[start : start + BLOCK]
            local = self._local(block)
            if xi.ndim == 2:
                found = (local @ table.reshape(-1, local.shape[1]).T).reshape(len(block), *table.shape[:2])
            else:
                found = (table[start : start + BLOCK] @ local[:, None, :, None])[..., 0]
            to_xy = matrices.derivative_map(self.domain.affine(block), order)
            parts.append(found if to_xy is None else found @ np.swapaxes(to_xy, 1, 2))
        return parts[0] if len(parts) == 1 else np.concatenate(parts)

    def _local(self, triangles: Ints) -> Floats:
        """(n, reference dof) the same of some triangles; of a few alone where the maps of all are kept."""
        if "_reference_dofs" in self.__dict__ or len(triangles) > FEW or not self.domain.few:
            return self._reference_dofs[triangles]
        m = self.element.transformation(self.domain.affine(self.domain.every))[triangles]
        return np.asarray((m @ self.d[self.layout.triangle_dofs(triangles)][:, :, None])[..., 0])

    @cached_property
    def _reference_dofs(self) -> Floats:
        """(triangle, reference dof) the solution on the reference triangle."""
        out = np.empty((len(self.domain.mesh.triangles), self.element.count))
        for block in self.domain.blocks():
            m = self.element.transformation(self.domain.affine(block))
            out[block] = (m @ self.d[self.layout.triangle_dofs(block)][:, :, None])[..., 0]
        return out

    def curvature(self, triangles: Ints, xi: Floats, xy: Floats) -> Floats:
        """Elastic curvature kappa - kappa_0 (n, point, 3) at points of triangles."""
        return self.derivatives(triangles, xi, 2) - self.loads.initial_curvature(triangles, xy)

    def moment(self, triangles: Ints, xi: Floats, xy: Floats) -> Floats:
        """M_xx, M_yy, M_xy (n, point, 3) from the polynomials of the triangles."""
        kappa = self.curvature(triangles, xi, xy)
        return -(self.bending.at(triangles, xy) @ kappa[..., None])[..., 0]

    def shear(self, triangles: Ints, xi: Floats, xy: Floats) -> Floats:
        """Q_x, Q_y (n, point, 2), the divergence of the moments."""
        third = self.derivatives(triangles, xi, 3)  # xxx, xxy, xyy, yyy
        constant = self.bending.constant
        if constant is None:
            q = (shear_rows(self.bending.at(triangles, xy)) @ third[..., None])[..., 0]
        else:
            q = third @ np.swapaxes(shear_rows(constant[triangles]), 1, 2)
        if not self.section.constant_per_triangle or self.loads.curvatures:
            second = self.derivatives(triangles, xi, 2)
            dx = self._change(triangles, xy, second, np.array([1.0, 0.0]))
            dy = self._change(triangles, xy, second, np.array([0.0, 1.0]))
            q = q + np.stack([dx[..., 0] + dy[..., 2], dx[..., 2] + dy[..., 1]], axis=-1)
        return np.asarray(q)

    def _change(self, triangles: Ints, xy: Floats, second: Floats, direction: Floats) -> Floats:
        """How M changes along a direction because the stiffness or the initial curvature does."""
        size = np.sqrt(np.abs(self.domain.affine(triangles).determinant))[:, None, None]
        step = STEP * size * direction

        def moment(at: Floats) -> Floats:
            kappa = second - self.loads.initial_curvature(triangles, at)
            return -(self.bending.at(triangles, at) @ kappa[..., None])[..., 0]

        return (moment(xy + step) - moment(xy - step)) / (2 * STEP * size)

    @cached_property
    def _triangles(self) -> Ints:
        return np.arange(len(self.domain.mesh.triangles))

    @cached_property
    def vertex_displacement(self) -> Floats:
        """(vertex, 3), along z."""
        out = np.zeros((self.layout.vertex_count, 3))
        out[:, 2] = self.d[: self.layout.per_vertex * len(out) : self.layout.per_vertex]
        return out

    @cached_property
    def vertex_rotation(self) -> Floats:
        """(vertex, 3) rotation vector, (w_y, -w_x, 0)."""
        b, out = self.layout.per_vertex, np.zeros((self.layout.vertex_count, 3))
        if b > 1:
            gradient = self.d[: b * len(out)].reshape(-1, b)[:, 1:3]
        else:
            gradient = self._average(self.derivatives(self._triangles, VERTICES, 1))
        out[:, 0], out[:, 1] = gradient[:, 1], -gradient[:, 0]
        return out

    @cached_property
    def fan_forces(self) -> tuple[Floats, Floats]:
        """Moments (fan, 3) and shear forces (fan, 2) at the vertices, of each fan (`Layout.fans`)."""
        if not self.polynomial_moments:
            return self._fitted_moments
        xy = self.domain.points[self.domain.mesh.triangles]
        moment = self._average(self.moment(self._triangles, VERTICES, xy))
        return moment, self._average(self.shear(self._triangles, VERTICES, xy))

    @cached_property
    def fan_stresses(self) -> tuple[Floats, Floats]:
        """Stresses (fan, 3) at the top and the bottom."""
        fans = self.layout.fans
        first = np.zeros(len(fans.vertex), dtype=np.int64)
        first[fans.corner.ravel()] = np.repeat(self._triangles, 3)
        return self.stresses(self.fan_forces[0], first, self.domain.points[fans.vertex])

    @cached_property
    def rows(self) -> Rows:
        """The fans as rows of fields; pieces are what edges without a jump join."""
        fans, mesh = self.layout.fans, self.domain.mesh
        if not fans.extra:
            return Rows.of_vertices(mesh)
        edges = np.flatnonzero((mesh.edge_counts == 2) & (True if self._jump is None else ~self._jump))
        links = self.domain.sides(edges)
        pieces = connected_parts(len(mesh.triangles), *links)[1]
        return Rows(mesh, fans.corner, fans.vertex, pieces)

    def _average(self, values: Floats) -> Floats:
        """Mean over the triangles of each fan, by area, of values (triangle, corner, component)."""
        corner, n = self.layout.fans.corner.ravel(), len(self.layout.fans.vertex)
        weight = np.repeat(self.domain.mesh.areas, 3)
        total = np.bincount(corner, weight, n)
        flat = values.reshape(len(corner), -1)
        sums = [np.bincount(corner, weight * flat[:, k], n) for k in range(flat.shape[1])]
        return np.stack(sums, axis=1) / np.where(total > 0, total, 1.0)[:, None]

    @cached_property
    def centroid_moments(self) -> Floats:
        """(triangle, 3) moments at the centroids."""
        mesh = self.domain.mesh
        xi = np.array([[1 / 3, 1 / 3]])
        xy = self.domain.points[mesh.triangles].mean(axis=1)[:, None]
        return self.moment(self._triangles, xi, xy)[:, 0]

    @cached_property
    def _fitted_moments(self) -> tuple[Floats, Floats]:
        """Vertex moments and shear forces by a linear fit of triangle moments around each vertex."""
        mesh = self.domain.mesh
        n = len(mesh.points)
        corner = mesh.triangles.ravel()
        triangle = np.repeat(np.arange(len(mesh.triangles)), 3)
        near = sp.csr_matrix((np.ones(len(corner)), (corner, triangle)), shape=(n, len(mesh.triangles)))
        few = np.flatnonzero(np.diff(near.indptr) < 5)  # at the boundary: take one more ring
        ring = (near[few] @ near.T) @ near
        link = sp.vstack([near, sp.csr_matrix(ring)]).tocoo()
        vertex = np.concatenate([np.arange(n), few])[link.row]
        drop = np.isin(vertex, few) & (link.row < n)
        vertex, triangle = vertex[~drop], link.col[~drop]
        h = self.layout.vertex_sizes
        offset = self.domain.points[mesh.triangles].mean(axis=1)[triangle] - self.domain.points[vertex]
        basis = np.concatenate([np.ones((len(vertex), 1)), offset / h[vertex, None]], axis=1)
        gram = np.zeros((n, 3, 3))
        right = np.zeros((n, 3, 3))
        moments = self.centroid_moments
        for i, j in np.ndindex(3, 3):  # one column of the products at a time: all take 80 B of each pair
            gram[:, i, j] = np.bincount(vertex, basis[:, i] * basis[:, j], n)
            right[:, i, j] = np.bincount(vertex, basis[:, i] * moments[triangle, j], n)
        gram += 1e-10 * np.trace(gram, axis1=1, axis2=2)[:, None, None] * np.eye(3)
        unused = gram[:, 0, 0] == 0
        gram[unused] = np.eye(3)
        c: Floats = np.linalg.solve(gram, right).astype(np.float64)  # (vertex, 1 x y, moment)
        slope = c[:, 1:] / h[:, None, None]
        shear = np.stack([slope[:, 0, 0] + slope[:, 1, 2], slope[:, 0, 2] + slope[:, 1, 1]], axis=1)
        return c[:, 0], shear

    def stresses(self, moment: Floats, triangles: Ints, points: Floats) -> tuple[Floats, Floats]:
        """Stresses (n, 3) at the top (z = +t/2) and the bottom from moments (n, 3) at points (n, 2)."""
        top, bottom = self._stresses((TOP, BOTTOM), moment, triangles, points)
        return top, bottom

    def _stresses(
        self, faces: Sequence[int], moment: Floats, triangles: Ints, points: Floats
    ) -> list[Floats]:
        xy = points[:, None]
        at = points_3d(self.domain, xy)
        kappa = np.linalg.solve(self.bending.at(triangles, xy)[:, 0], moment[:, :, None])
        out = [(self.section.stress(face, triangles, at)[1][:, 0] @ kappa)[..., 0] for face in faces]
        if not self.loads.warmth:
            return out
        return [
            stress + self.loads.left_stress(face, triangles, xy)[:, 0]
            for face, stress in zip(faces, out, strict=True)
        ]

    @cached_property
    def locator(self) -> PlatePoints:
        """For values anywhere."""
        return PlatePoints(self.domain)

    @cached_property
    def lines(self) -> LinePoints:
        """Which side points on lines of discontinuity belong to."""
        return LinePoints(self, self._jump)

    def at(self, points: Floats) -> dict[str, Floats]:
        """Fields at points (n, 3) or (n, 2), or at the nearest points of the plate.

        Returns
        -------
        dict
            x (n, 3), u (n, 3), rotation (n, 3), M (n, 3), Q (n, 2), stress_top, stress_bottom (n, 3), triangle (n,) and
            distance (n,) to the point used.
        """
        return self.values_at(self.lines.find(points))

    def motion(self, points: Floats) -> Floats:
        """(n, 3) the displacement u of `at` alone."""
        return self._motion(self.lines.find(points))

    def _motion(self, found: Located) -> Floats:
        """(n, 3) at located points; on edges that w jumps across, the mean of both triangles."""
        shared = None if self.smooth else self.lines.both(found)
        at = found if shared is None else shared.located
        w = self.derivatives(at.triangles, at.xi, 0)[:, 0, 0]
        w = w if shared is None else shared.mean(w)
        return np.stack([0.0 * w, 0.0 * w, w], axis=1)

    def all_at(self, points: Floats) -> dict[str, Floats]:
        """As `at`, and stress_middle (n, 3), which layers that warm leave."""
        found = self.lines.find(points)
        values = self.values_at(found)
        if self.section.has_stress:
            (values["stress_middle"],) = self._stresses((MIDDLE,), values["M"], found.triangles, found.xy)
        return values

    def values_at(self, found: Located) -> dict[str, Floats]:
        """The same at located points."""
        shared = self.lines.around(found)
        at = found if self.smooth else shared.located
        gradient = self.derivatives(at.triangles, at.xi, 1)[:, 0]
        gradient = gradient if self.smooth else shared.mean(gradient)
        moment, shear = self._forces(found, shared)
        stresses = {}
        if self.section.has_stress:
            top, bottom = self.stresses(moment, found.triangles, found.xy)
            stresses = {"stress_top": top, "stress_bottom": bottom}
        return {
            "x": points_3d(self.domain, found.xy),
            "u": self._motion(found),
            "rotation": np.stack([gradient[:, 1], -gradient[:, 0], 0.0 * gradient[:, 0]], axis=1),
            "M": moment,
            "Q": shear,
            **stresses,
            "triangle": found.triangles.astype(np.float64),
            "distance": found.distance,
        }

    def forces(self, found: Located) -> tuple[Floats, Floats]:
        """Moments (n, 3) and shear forces (n, 2) at located points."""
        return self._forces(found, self.lines.around(found))

    def _forces(self, found: Located, shared: Shared) -> tuple[Floats, Floats]:
        if self.polynomial_moments:  # the means of all triangles there, whichever of them was found
            at = shared.located
            moment, shear = (f(at.triangles, at.xi, at.xy[:, None])[:, 0] for f in (self.moment, self.shear))
            return shared.mean(moment), shared.mean(shear)
        x, y = found.xi[:, 0].T
        weights = np.stack([1 - x - y, x, y], axis=1)[:, None]  # (n, 1, corner)
        corners = self.domain.mesh.triangles[found.triangles]
        moment, shear = self._fitted_moments
        return (weights @ moment[corners])[:, 0], (weights @ shear[corners])[:, 0]


def shear_rows(stiffness: Floats) -> Floats:
    """(..., 2, 4) Q = div (- D kappa) from w_xxx, w_xxy, w_xyy, w_yyy, for a constant stiffness D (..., 3, 3)."""
    d = stiffness
    qx = np.stack(
        [d[..., 0, 0], 2 * d[..., 0, 2] + d[..., 2, 0], d[..., 0, 1] + 2 * d[..., 2, 2], d[..., 2, 1]], -1
    )
    qy = np.stack(
        [d[..., 2, 0], 2 * d[..., 2, 2] + d[..., 1, 0], d[..., 2, 1] + 2 * d[..., 1, 2], d[..., 1, 1]], -1
    )
    return -np.stack([qx, qy], axis=-2)
