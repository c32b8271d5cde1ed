"""Membrane forces, moments, stresses and rotations of a solution, at any points of the triangles.

The frame of all tensors: e_1 is the projection of the global x on the tangent plane (of y where x is
normal), e_2 = n x e_1, and tensors are listed 11, 22, 12. Symbols as in section.py and koiter.py.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.shell.chart.energy import ChartKoiter
from kshell.shell.chart.surface import jets_of_basis
from kshell.shell.constitutive import section_at
from kshell.shell.frames import components, contravariant_to_frame, covariant_to_frame, tangent_frame
from kshell.shell.kinematics import curvature_change
from kshell.shell.koiter.energy import Koiter
from kshell.shell.koiter.surface import Surface
from kshell.shell.reference import first_derivatives, lagrange
from kshell.shell.section import Section
from kshell.shell.vectors import cross, dot, norm

Floats = NDArray[np.float64]


class Resultants(NamedTuple):
    """What the cross-section carries at points of triangles; arrays are (triangle, point, ...).

    Attributes
    ----------
    position : (..., 3)
    axes : (..., 3, 3)
        Rows e_1, e_2, n of the frame.
    membrane_force, moment : (..., 3)
        N and M in the frame: force per length, and moment per length, positive with the top in tension.
    strain, curvature : (..., 3)
        Elastic E and kappa in the *material* axes, the shear components doubled.
    to_frame : (..., 3, 3)
        Matrix that takes a tensor 11, 22, 12 from the material axes to the frame.
    """

    position: Floats
    axes: Floats
    membrane_force: Floats
    moment: Floats
    strain: Floats
    curvature: Floats
    to_frame: Floats

    def stress(self, stiffness: ArrayLike, height: ArrayLike) -> Floats:
        """Stress (..., 3) in the frame at a height above the meshed surface.

        Parameters
        ----------
        stiffness : (3, 3) or (triangle, 1, 3, 3)
            Plane-stress stiffness of the material there, in the material axes of the section.
        height : float or (triangle, 1)
        """
        z = np.asarray(height, dtype=float)[..., None]
        stress = np.asarray(stiffness, dtype=float) @ (self.strain + z * self.curvature)[..., None]
        return (self.to_frame @ stress)[..., 0]


def resultants(
    koiter: Koiter,
    strain: Floats,
    points: ArrayLike,
    triangles: NDArray | None = None,
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
    """
    surface, section = koiter.surface, koiter.section
    chosen = np.arange(len(surface.mesh.triangles)) if triangles is None else np.asarray(triangles)
    points = np.asarray(points, dtype=float).reshape(-1, 2)
    psi = lagrange(surface.order - 1, points)
    r = surface.reference.strains
    s = strain[chosen]
    m = np.matmul(koiter.stiffness[chosen], s[:, :, None])[:, r:, 0].reshape(len(chosen), -1, 3)

    x = surface.tangents(first_derivatives(surface.order, points), chosen)
    area = norm(cross(x[0], x[1]))
    covariant = np.einsum("pk,tkv->vtp", psi, s[:, :r].reshape(len(chosen), -1, 3))
    contravariant = np.einsum("pk,tkv->vtp", psi, m) / area**2
    position = np.einsum(
        "pn,tnx->tpx", lagrange(surface.order, points), surface.nodes[surface.triangle_nodes[chosen]]
    )
    _, b, d, angle = section_at(section, chosen, lambda: position)
    f = components(x, *tangent_frame(x, section.direction, angle)[:2])
    e = np.einsum("vwtp,wtp->tpv", covariant_to_frame(f), covariant)
    moment = np.einsum("vwtp,wtp->tpv", contravariant_to_frame(f), contravariant)
    bent = moment[..., None] - b @ e[..., None]
    kappa = np.linalg.solve(np.broadcast_to(d, (*moment.shape, 3)), bent)[..., 0]
    return _in_frame(section, chosen, position, x, e, kappa, moment)


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
        As in `resultants`.
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
    if initial is not None:
        between = lagrange(3, points) @ np.linalg.pinv(lagrange(3, surface.points))
        covariant -= np.einsum("pq,tqs->stp", between, initial[chosen].reshape(len(chosen), -1, 6))

    position = np.moveaxis(position, 0, 2)
    _, b, d, angle = section_at(section, chosen, lambda: position)
    to_frame = covariant_to_frame(components(first, *tangent_frame(first, section.direction, angle)[:2]))
    e, kappa = (np.einsum("vwtp,wtp->tpv", to_frame, part) for part in (covariant[:3], covariant[3:]))
    moment = (b @ e[..., None] + d @ kappa[..., None])[..., 0]
    return _in_frame(section, chosen, position, first, e, kappa, moment)


def _in_frame(
    section: Section, chosen: NDArray, position: Floats, x: Floats, e: Floats, kappa: Floats, moment: Floats
) -> Resultants:
    """Strains and moments in the material axes, turned into the frame of the results."""
    a, b, _, angle = section_at(section, chosen, lambda: position)
    force = a @ e[..., None] + b @ kappa[..., None]
    e1, e2, _ = tangent_frame(x, section.direction, angle)
    axes = np.stack(tangent_frame(x))
    turn = np.stack([np.stack([dot(axes[i], e1), dot(axes[i], e2)]) for i in range(2)])
    to_frame = np.moveaxis(contravariant_to_frame(turn), (0, 1), (2, 3))
    return Resultants(
        position=position,
        axes=np.moveaxis(axes, (0, 1), (2, 3)),
        membrane_force=(to_frame @ force)[..., 0],
        moment=(to_frame @ moment[..., None])[..., 0],
        strain=e,
        curvature=kappa,
        to_frame=to_frame,
    )


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


def finite_rotation(before: Floats, after: Floats) -> Floats:
    """Rotation vectors (triangle, point, 3) of the polar decomposition that takes tangents and normal to the new ones.

    Parameters
    ----------
    before, after : (2, 3, triangle, point)
        Tangents at rest and in the state.
    """
    from scipy.spatial.transform import Rotation

    frames = []
    for x in (before, after):
        normal = cross(x[0], x[1])
        frames.append(np.moveaxis(np.stack([x[0], x[1], normal / norm(normal)]), (0, 1), (3, 2)))
    gradient = frames[1] @ np.linalg.inv(frames[0])
    left, _, right = np.linalg.svd(gradient)
    vectors = Rotation.from_matrix((left @ right).reshape(-1, 3, 3)).as_rotvec()
    return np.asarray(vectors).reshape(gradient.shape[:3])


def energies(koiter: Koiter, strain: Floats) -> tuple[Floats, Floats]:
    """Membrane and bending energy of each triangle, 1/2 N . E and 1/2 M . kappa: two (triangle,) arrays."""
    r = koiter.surface.reference.strains
    work = 0.5 * strain * koiter.stress(strain)
    return work[:, :r].sum(axis=1), work[:, r:].sum(axis=1)
