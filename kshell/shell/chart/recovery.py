"""Membrane forces, moments, rotations and energies of a solution with Argyris elements on a chart."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.shell.chart.energy import ChartKoiter
from kshell.shell.chart.surface import ChartSurface, jets_of_basis
from kshell.shell.frames import components, covariant_to_frame, tangent_frame
from kshell.shell.kinematics import curvature_change
from kshell.shell.reference import lagrange
from kshell.shell.resultants import Resultants, finite_rotation, resultants_in_frame
from kshell.shell.section import section_at
from kshell.shell.vectors import cross, dot, norm

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


def chart_resultants(
    koiter: ChartKoiter,
    x: Floats,
    points: ArrayLike,
    triangles: NDArray | None = None,
    finite: bool = False,
    initial: Floats | None = None,
) -> Resultants:
    """N, M and strains of a state x of the Argyris discretisation, to first order in x or of finite strains.

    Parameters
    ----------
    x : (unknowns,)
    points, triangles :
        As in `kshell.shell.koiter.recovery.resultants`.
    initial : (triangle, 6 q), optional
        Strains without stress at the quadrature points; in between they are those of the nearest cubic.
    """
    surface, section = koiter.surface, koiter.section
    chosen = np.arange(len(surface.scalar)) if triangles is None else np.asarray(triangles)
    points = np.asarray(points, dtype=float).reshape(-1, 2)
    position, first, second = surface.geometry(points, chosen)
    local = surface.local(x, chosen)
    shape = surface.shape(jets_of_basis(points)[1:], chosen)
    u = np.stack([np.matmul(d, local[..., None])[..., 0] for d in shape])  # (5, 3, triangle, point)
    big_m = cross(first[0], first[1])
    n = big_m / norm(big_m)
    m_change = cross(u[0], first[1]) + cross(first[0], u[1])
    n_change = (m_change - n * dot(n, m_change)) / norm(big_m)
    membrane = [dot(first[0], u[0]), dot(first[1], u[1]), 0.5 * (dot(first[0], u[1]) + dot(first[1], u[0]))]
    bending = [-(dot(n, u[2 + v]) + dot(n_change, second[v])) for v in range(3)]
    if finite:
        squares = (dot(u[0], u[0]), dot(u[1], u[1]), dot(u[0], u[1]))
        membrane = [e + 0.5 * square for e, square in zip(membrane, squares, strict=True)]
        bending = list(-curvature_change(first, second, u[:2], u[2:]).change)
    covariant = np.stack(membrane + bending)
    second_form, stretched = np.stack([dot(n, second[v]) for v in range(3)]), None
    if finite:
        second_form, stretched = second_form - covariant[3:], covariant[:3].copy()
    if initial is not None:
        between = lagrange(3, points) @ np.linalg.pinv(lagrange(3, surface.points))
        covariant -= np.einsum("pq,tqs->stp", between, initial[chosen].reshape(len(chosen), -1, 6))

    position = np.moveaxis(position, 0, 2)
    _, b, d, angle = section_at(section, chosen, lambda: position)
    to_frame = covariant_to_frame(
        components(first, *tangent_frame(first, section.direction_of(chosen), angle)[:2])
    )
    e, kappa = (np.einsum("vwtp,wtp->tpv", to_frame, part) for part in (covariant[:3], covariant[3:]))
    moment = (b @ e[..., None] + d @ kappa[..., None])[..., 0]
    return resultants_in_frame(section, chosen, position, first, e, kappa, moment, second_form, stretched)


def _geometry(first: Floats) -> tuple[Floats, Floats]:
    """Normal (3, ...) and reciprocal tangents (2, 3, ...)."""
    normal = cross(first[0], first[1])
    j = norm(normal)
    n = normal / j
    return n, np.stack([cross(first[1], n) / j, cross(n, first[0]) / j])


class ChartRecovery:
    """Values of a solution inside triangles.

    Parameters
    ----------
    energy : ChartKoiter
    x : (unknowns,)
    finite : bool
        Whether strains and rotations are finite, not those to first order.
    initial : (triangle, 6 q), optional
        Strains without stress.
    """

    constant_moments = False

    def __init__(
        self, energy: ChartKoiter, x: Floats, finite: bool = False, initial: Floats | None = None
    ) -> None:
        self.energy, self.surface, self.x, self.finite = energy, energy.surface, x, finite
        self.initial = initial

    def _jets(self, points: Floats, triangles: Ints) -> Floats:
        """Value and derivatives by the reference coordinates of the displacement: (3, 3, triangle, point)."""
        shape = self.surface.shape(jets_of_basis(points)[:3], triangles)
        return np.einsum("dtqj,xtj->dxtq", shape, self.surface.local(self.x, triangles))

    def resultants(self, points: Floats, triangles: Ints) -> Resultants:
        """N, M and strains at reference points (point, 2) of triangles."""
        return chart_resultants(self.energy, self.x, points, triangles, self.finite, self.initial)

    def displacement(self, points: Floats, triangles: Ints) -> tuple[Floats, Floats]:
        """Displacement and rotation vector n x dn + 1/2 n (n . curl u), each (triangle, point, 3)."""
        _, first, _ = self.surface.geometry(points, triangles)
        u = self._jets(points, triangles)
        if self.finite:
            return np.moveaxis(u[0], 0, 2), finite_rotation(first, first + u[1:])
        n, reciprocal = _geometry(first)
        change = -(dot(n, u[1]) * reciprocal[0] + dot(n, u[2]) * reciprocal[1])
        drill = 0.5 * dot(n, cross(reciprocal[0], u[1]) + cross(reciprocal[1], u[2]))
        return np.moveaxis(u[0], 0, 2), np.moveaxis(cross(n, change) + n * drill, 0, 2)

    def energies(self) -> tuple[Floats, Floats]:
        """Membrane and bending energy of each triangle, 1/2 N . E and 1/2 M . kappa."""
        strain = self.energy.strain(self.x) if self.finite else self.energy.linear_strain(self.x)
        if self.initial is not None:
            strain = strain - self.initial
        work = (0.5 * strain * self.energy.stress(strain)).reshape(len(strain), -1, 6)
        return work[..., :3].sum(axis=(1, 2)), work[..., 3:].sum(axis=(1, 2))


def principal_curvature(surface: ChartSurface) -> Floats:
    """(triangle,) largest principal curvature, in size, at the quadrature points."""
    e1, e2, n = tangent_frame(surface.first)
    b = np.stack([dot(n, surface.second[v]) for v in range(3)])
    b11, b22, b12 = np.einsum("vwtq,wtq->vtq", covariant_to_frame(components(surface.first, e1, e2)), b)
    middle, radius = 0.5 * (b11 + b22), np.hypot(0.5 * (b11 - b22), 0.5 * b12)
    return (np.abs(middle) + radius).max(axis=1)
