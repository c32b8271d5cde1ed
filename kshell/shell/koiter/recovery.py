"""Membrane forces, moments, stresses and rotations of a solution, at any points of the triangles.

The frame of all tensors: e_1 is the projection of the global x on the tangent plane (of y where x is
normal), e_2 = n x e_1, and tensors are listed 11, 22, 12. Symbols as in section.py and koiter/energy.py.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.equilibrium.energy import inelastic_of
from kshell.shell.frames import components, contravariant_to_frame, covariant_to_frame, tangent_frame
from kshell.shell.koiter.energy import Koiter
from kshell.shell.koiter.surface import Surface
from kshell.shell.reference import first_derivatives, lagrange, second_derivatives
from kshell.shell.resultants import Resultants, finite_rotation, resultants_in_frame
from kshell.shell.section import section_at
from kshell.shell.vectors import cross, dot, norm

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


def resultants(
    koiter: Koiter,
    strain: Floats,
    points: ArrayLike,
    triangles: NDArray | None = None,
    total: Floats | None = None,
    stress: Floats | None = None,
    total_stress: Floats | None = None,
) -> Resultants:
    """N, M and strains from the strains s of `Koiter.strain` or `Koiter.linear_strain`.

    Moments are those of the element, of degree p - 1; membrane forces follow from the Regge interpolant of
    the strain and the moments.

    Parameters
    ----------
    strain : (triangle, 2 r)
    points : (point, 2)
        Reference coordinates, the same in all triangles.
    triangles : (n,) int array, optional
        All if absent.
    total : (triangle, 2 r), optional
        Strains with those without stress, where deflections are large and forces in cuts are those of the deformed
        surface.
    stress, total_stress : (triangle, 2 r), optional
        K times `strain` and `total`, where they are known.
    """
    surface, section = koiter.surface, koiter.section
    chosen = np.arange(len(surface.mesh.triangles)) if triangles is None else np.asarray(triangles)
    points = np.asarray(points, dtype=float).reshape(-1, 2)
    psi = lagrange(surface.order - 1, points)
    x = surface.tangents(first_derivatives(surface.order, points), chosen)
    area = norm(cross(x[0], x[1]))
    position = np.einsum(
        "pn,tnx->tpx", lagrange(surface.order, points), surface.nodes[surface.triangle_nodes[chosen]]
    )
    _, b, d, angle = section_at(section, chosen, lambda: position)
    f = components(x, *tangent_frame(x, section.direction_of(chosen), angle)[:2])
    to_frame = covariant_to_frame(f)

    def strains(all_strains: Floats, known: Floats | None) -> tuple[Floats, Floats, Floats, Floats]:
        """Membrane strain along the element coordinates; it, kappa and M in the material axes."""
        r, s = surface.reference.strains, all_strains[chosen]
        if known is None:
            m = koiter.constitutive.times(chosen, s[:, :, None])[:, r:, 0].reshape(len(chosen), -1, 3)
        else:
            m = known[chosen, r:].reshape(len(chosen), -1, 3)
        covariant = np.einsum("pk,tkv->vtp", psi, s[:, :r].reshape(len(chosen), -1, 3))
        contravariant = np.einsum("pk,tkv->vtp", psi, m) / area**2
        e = np.einsum("vwtp,wtp->tpv", to_frame, covariant)
        moment = np.einsum("vwtp,wtp->tpv", contravariant_to_frame(f), contravariant)
        bent = moment[..., None] - b @ e[..., None]
        kappa = np.linalg.solve(np.broadcast_to(d, (*moment.shape, 3)), bent)[..., 0]
        return covariant, e, kappa, moment

    covariant, e, kappa, moment = strains(strain, stress)
    second_form, stretched = rest_second_form(surface, points, chosen, x), None
    if total is not None and surface.order > 1:
        stretched, _, change, _ = (
            (covariant, e, kappa, moment) if total is strain else strains(total, total_stress)
        )
        back = np.linalg.inv(np.moveaxis(to_frame, (0, 1), (2, 3)))
        second_form = second_form - np.moveaxis((back @ change[..., None])[..., 0], 2, 0)
    return resultants_in_frame(section, chosen, position, x, e, kappa, moment, second_form, stretched)


def rest_second_form(surface: Surface, points: Floats, triangles: NDArray, x: Floats) -> Floats:
    """B_11, B_22, B_12 along the element coordinates at reference points: (3, triangle, point).

    Triangles of order 1 are flat, they bend at their edges only: the force in a cut is what their strain works against.

    Parameters
    ----------
    x : (2, 3, triangle, point)
        Tangents there.
    """
    if surface.order == 1:
        return np.zeros((3, len(triangles), len(points)))
    normal = cross(x[0], x[1])
    normal = normal / norm(normal)
    second = surface.jets(surface.nodes, second_derivatives(surface.order, points), triangles)
    return np.stack([dot(normal, y) for y in second])


def displacement(
    surface: Surface, x: Floats, points: ArrayLike, triangles: NDArray, finite: bool = False
) -> tuple[Floats, Floats]:
    """Displacement and rotation vector at reference points: both (triangle, point, 3).

    The small rotation has the tangential part n x dn and half the curl of u about n; the finite one is that of
    `finite_rotation`.
    """
    points = np.asarray(points, dtype=float).reshape(-1, 2)
    u, _ = surface.split(x)
    value = np.einsum("pn,tnx->tpx", lagrange(surface.order, points), u[surface.triangle_nodes[triangles]])
    tables = first_derivatives(surface.order, points)
    big, small = surface.tangents(tables, triangles), surface.jets(u, tables, triangles)
    if finite:
        return value, finite_rotation(big, big + small)
    normal = cross(big[0], big[1])
    j = norm(normal)
    n = normal / j
    rotation = (big[0] * dot(n, small[1]) - big[1] * dot(n, small[0])) / j
    rotation += n * (0.5 * (dot(small[0], big[1]) - dot(small[1], big[0])) / j)
    return value, np.moveaxis(rotation, 0, 2)


def energies(koiter: Koiter, strain: Floats, stress: Floats | None = None) -> tuple[Floats, Floats]:
    """Membrane and bending energy of each triangle, 1/2 N . E and 1/2 M . kappa: two (triangle,) arrays.

    `stress` (triangle, 2 r) is K times the strain, where it is known.
    """
    r = koiter.surface.reference.strains
    work = 0.5 * strain * (koiter.stress(strain) if stress is None else stress)
    return work[:, :r].sum(axis=1), work[:, r:].sum(axis=1)


class KoiterRecovery:
    """Values of a solution inside triangles.

    Parameters
    ----------
    koiter : Koiter
    x : (unknowns,)
    finite : bool
        Whether strains and rotations are finite, not those to first order.
    memory : Directors, optional
        Of a finite state.
    initial : (triangle, 2 r), optional
        Strains without stress.
    """

    def __init__(
        self,
        koiter: Koiter,
        x: Floats,
        finite: bool = False,
        memory: Any = None,
        initial: Floats | None = None,
    ) -> None:
        self.koiter, self.x, self.finite = koiter, x, finite
        inelastic = inelastic_of(memory)
        if finite and inelastic is not None:
            initial = inelastic if initial is None else initial + inelastic
        self._memory, self._initial = memory, initial
        self._stress: Floats | None = None
        self._total_stress: Floats | None = None

    @cached_property
    def _total(self) -> Floats:
        """(triangle, 2 r) strains, found when they are looked at: the displacement of a mode needs none."""
        return self.koiter.strain(self.x, self._memory) if self.finite else self.koiter.linear_strain(self.x)

    @cached_property
    def strain(self) -> Floats:
        """(triangle, 2 r) those with stress."""
        return self._total if self._initial is None else self._total - self._initial

    def know_stress(self) -> None:
        """Find the stresses of all triangles once, so that they are not found anew for each place."""
        self._stress = self.koiter.stress(self.strain)
        self._total_stress = self._stress if self.strain is self._total else self.koiter.stress(self._total)

    def resultants(self, points: Floats, triangles: Ints) -> Resultants:
        """N, M and strains at reference points (point, 2) of triangles."""
        total = self._total if self.finite else None
        known = (self._stress, self._total_stress)
        return resultants(self.koiter, self.strain, points, triangles, total, *known)

    @property
    def constant_moments(self) -> bool:
        """Whether moments do not change inside triangles."""
        return self.koiter.surface.order == 1

    def displacement(self, points: Floats, triangles: Ints) -> tuple[Floats, Floats]:
        """Displacement and rotation vector, each (triangle, point, 3)."""
        return displacement(self.koiter.surface, self.x, points, triangles, self.finite)

    def energies(self) -> tuple[Floats, Floats]:
        """Membrane and bending energy of each triangle."""
        return energies(self.koiter, self.strain, self._stress)
