"""Membrane forces, moments and rotations of a solution with Argyris elements on a chart.

Symbols
-------
X,a  X,ab   derivatives of the chart by the reference coordinates of a triangle, u,a u,ab of the displacement
X^a         reciprocal tangents, n the normal
E_ab        1/2 (X,a . u,b + X,b . u,a)
kappa_ab    -n . (u,ab - (X^c . X,ab) u,c), minus the change of the second fundamental form
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.shell.argyris import ChartKoiter
from kshell.shell.chart_surface import ChartSurface, jets_of_basis
from kshell.shell.constitutive import section_at
from kshell.shell.frames import components, contravariant_to_frame, covariant_to_frame, tangent_frame
from kshell.shell.recovery import Resultants
from kshell.shell.vectors import cross, dot, norm

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


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
    """

    def __init__(self, energy: ChartKoiter, x: Floats) -> None:
        self.energy, self.surface, self.x = energy, energy.surface, x

    def _jets(self, points: Floats, triangles: Ints) -> Floats:
        """Value, 1, 2, 11, 22, 12 of the displacement: (6, 3, triangle, point)."""
        shape = self.surface.shape(jets_of_basis(points), triangles)
        return np.einsum("dtqj,xtj->dxtq", shape, self.surface.local(self.x, triangles))

    def _strains(self, points: Floats, triangles: Ints) -> tuple[Floats, Floats, Floats, Floats]:
        """Position, tangents, E and kappa (3, triangle, point) in reference coordinates, as 11, 22, 12."""
        position, first, second = self.surface.geometry(points, triangles)
        u = self._jets(points, triangles)
        n, reciprocal = _geometry(first)
        e12 = 0.5 * (dot(first[0], u[2]) + dot(first[1], u[1]))
        strain = np.stack([dot(first[0], u[1]), dot(first[1], u[2]), e12])
        kappa = [
            -dot(n, u[3 + v]) + sum(dot(reciprocal[c], second[v]) * dot(n, u[1 + c]) for c in range(2)) for v in range(3)
        ]
        return position, first, strain, np.stack(kappa)

    def resultants(self, points: Floats, triangles: Ints) -> Resultants:
        """N, M and strains at reference points (point, 2) of triangles."""
        position, first, strain, kappa = self._strains(points, triangles)
        section = self.energy.section
        a, b, d, angle = section_at(section, triangles)
        e1, e2, _ = tangent_frame(first, section.direction, angle)
        f = components(first, e1, e2)
        matrix = np.moveaxis(covariant_to_frame(f), (0, 1), (2, 3))
        e, k = ((matrix @ np.moveaxis(part, 0, 2)[..., None])[..., 0] for part in (strain, kappa))
        force = (a @ e[..., None] + b @ k[..., None])[..., 0]
        moment = (b @ e[..., None] + d @ k[..., None])[..., 0]
        axes = np.stack(tangent_frame(first))
        turn = np.stack([np.stack([dot(axes[i], e1), dot(axes[i], e2)]) for i in range(2)])
        to_frame = np.moveaxis(contravariant_to_frame(turn), (0, 1), (2, 3))
        return Resultants(
            position=np.moveaxis(position, 0, 2),
            axes=np.moveaxis(axes, (0, 1), (2, 3)),
            membrane_force=(to_frame @ force[..., None])[..., 0],
            moment=(to_frame @ moment[..., None])[..., 0],
            strain=e,
            curvature=k,
            to_frame=to_frame,
        )

    def displacement(self, points: Floats, triangles: Ints) -> tuple[Floats, Floats]:
        """Displacement and rotation vector n x dn + 1/2 n (n . curl u), each (triangle, point, 3)."""
        _, first, _ = self.surface.geometry(points, triangles)
        u = self._jets(points, triangles)
        n, reciprocal = _geometry(first)
        change = -sum(dot(n, u[1 + c]) * reciprocal[c] for c in range(2))
        drill = 0.5 * dot(n, sum(cross(reciprocal[c], u[1 + c]) for c in range(2)))
        return np.moveaxis(u[0], 0, 2), np.moveaxis(cross(n, change) + n * drill, 0, 2)

    def energies(self) -> tuple[Floats, Floats]:
        """Membrane and bending energy of each triangle, 1/2 N . E and 1/2 M . kappa."""
        strain = self.energy.linear_strain(self.x)
        work = (0.5 * strain * self.energy.stress(strain)).reshape(len(strain), -1, 6)
        return work[..., :3].sum(axis=(1, 2)), work[..., 3:].sum(axis=(1, 2))


def principal_curvature(surface: ChartSurface) -> Floats:
    """(triangle,) largest principal curvature, in size, at the quadrature points."""
    e1, e2, n = tangent_frame(surface.first)
    b = np.stack([dot(n, surface.second[v]) for v in range(3)])
    b11, b22, b12 = np.einsum("vwtq,wtq->vtq", covariant_to_frame(components(surface.first, e1, e2)), b)
    middle, radius = 0.5 * (b11 + b22), np.hypot(0.5 * (b11 - b22), 0.5 * b12)
    return (np.abs(middle) + radius).max(axis=1)
