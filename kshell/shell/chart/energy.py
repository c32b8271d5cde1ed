"""The Koiter energy on a chart with Argyris functions: strains at quadrature points, nothing interpolated.

Very accurate on smooth charts that are not too thin; without the Regge interpolation of koiter/energy.py it locks
where bending without stretching is possible and thickness is below about 1e-3 of the length.

Symbols as in koiter/energy.py; the strains of a triangle are s = (E_11, E_22, E_12, kappa_11, kappa_22, kappa_12)
at each quadrature point, in reference coordinates, and K is block diagonal.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.energy import StrainEnergy, in_blocks
from kshell.equilibrium.sparsity import Sparsity
from kshell.shell import kinematics
from kshell.shell.chart.surface import ChartSurface
from kshell.shell.frames import components, covariant_to_frame, tangent_frame
from kshell.shell.section import Section, section_at
from kshell.shell.vectors import dot

Floats = NDArray[np.float64]


class ChartState(NamedTuple):
    """Kinematics of a block of triangles."""

    shape: Floats  # (5, triangle, q, 21) derivatives 1, 2, 11, 22, 12 of the basis
    curvature: kinematics.Curvature
    strain: Floats  # (triangle, 6 q)


class ChartKoiter(StrainEnergy):
    """The energy of a chart surface with a section.

    Parameters
    ----------
    surface : ChartSurface
    section : Section
    block : int
        Triangles worked on at a time.
    """

    rest = None  # a smooth surface needs no directors

    def __init__(self, surface: ChartSurface, section: Section, block: int = 512) -> None:
        self.surface = surface
        self.section = section
        self.unknowns = surface.unknowns
        self.triangle_unknowns = surface.triangle_unknowns
        count, q = len(surface.scalar), len(surface.weights)
        self.blocks = in_blocks(count, block)
        self.stiffness = np.empty((count, q, 6, 6))  # K
        for triangles in self.blocks:
            self.stiffness[triangles] = self._point_stiffness(triangles)
        self.strains = 6 * q

    def _point_stiffness(self, triangles: slice) -> Floats:
        surface = self.surface
        x = surface.first[:, :, triangles]
        a, b, d, angle = section_at(
            self.section, triangles, lambda: np.moveaxis(surface.positions[:, triangles], 0, 2)
        )
        e1, e2, _ = tangent_frame(x, self.section.direction_of(triangles), angle)
        to_frame = np.moveaxis(covariant_to_frame(components(x, e1, e2)), (0, 1), (2, 3))
        left = np.swapaxes(to_frame, -1, -2)
        membrane, coupling, bending = (left @ m @ to_frame for m in (a, b, d))
        rows = [np.concatenate([membrane, coupling], axis=-1), np.concatenate([coupling, bending], axis=-1)]
        weight = surface.area_elements[triangles] * surface.weights
        return np.concatenate(rows, axis=-2) * weight[..., None, None]

    def _state(self, x: Floats, memory: object, triangles: slice) -> ChartState:
        surface = self.surface
        shape = surface.shape(surface.tables[1:], triangles)
        local = surface.local(x, triangles)
        jets = np.stack([np.matmul(d, local[..., None])[..., 0] for d in shape])  # (5, 3, triangle, q)
        big, second = surface.first[:, :, triangles], surface.second[:, :, triangles]
        curvature = kinematics.curvature_change(big, second, jets[:2], jets[2:])
        mean = big + 0.5 * jets[:2]
        e12 = 0.5 * (dot(mean[0], jets[1]) + dot(mean[1], jets[0]))
        membrane = np.stack([dot(mean[0], jets[0]), dot(mean[1], jets[1]), e12])
        strain = np.concatenate([membrane, -curvature.change])  # (6, triangle, q)
        return ChartState(shape, curvature, np.moveaxis(strain, 0, 2).reshape(len(shape[0]), -1))

    def _gradient(self, state: ChartState, triangles: slice) -> Floats:
        """(triangle, 6 q, 63)."""
        d1, d2, *second = state.shape
        x1, x2 = (x[..., None] for x in state.curvature.x)
        n = state.curvature.normal[..., None]
        by_x = kinematics.curvature_gradient(state.curvature)[..., None]
        count, q, dofs = d1.shape
        result = np.empty((count, q, 6, 3, dofs))
        for m in range(3):
            result[:, :, 0, m] = x1[m] * d1
            result[:, :, 1, m] = x2[m] * d2
            result[:, :, 2, m] = 0.5 * (x1[m] * d2 + x2[m] * d1)
            for v in range(3):
                result[:, :, 3 + v, m] = -(by_x[v, 0, m] * d1 + by_x[v, 1, m] * d2 + n[m] * second[v])
        return result.reshape(count, 6 * q, 3 * dofs)

    def _geometric(self, state: ChartState, stress: Floats, triangles: slice) -> Floats:
        """(triangle, 63, 63): the membrane part  sum N^ab u,a . u,b  and that of the curvature."""
        d1, d2, *second = state.shape
        count, q, dofs = d1.shape
        sigma = np.moveaxis(stress.reshape(count, q, 6), 2, 0)[..., None]  # (6, triangle, q, 1)
        by_x, normal_by_x = kinematics.curvature_hessian(state.curvature, -sigma[3:, ..., 0])
        first = (d1, d2)
        share = [1.0 if a != b else 0.5 for a, b in kinematics.PAIRS]
        left = [first[a] for a, _ in kinematics.PAIRS] + [d for d in second for _ in first]
        transposed = np.concatenate(left, axis=1).swapaxes(1, 2)  # (triangle, 21, 9 q)
        half = np.empty((count, 3, dofs, 3, dofs))
        for m in range(3):
            for l in range(3):  # noqa: E741
                right = [
                    s * h[m, l][..., None] * first[b]
                    for s, h, (_, b) in zip(share, by_x, kinematics.PAIRS, strict=True)
                ]
                right += [
                    -sigma[3 + v] * normal_by_x[a][m, l][..., None] * first[a]
                    for v in range(3)
                    for a in range(2)
                ]
                half[:, m, :, l] = np.matmul(transposed, np.concatenate(right, axis=1))
        membrane = np.matmul(d1.swapaxes(1, 2), 0.5 * sigma[0] * d1 + 0.5 * sigma[2] * d2)
        membrane += np.matmul(d2.swapaxes(1, 2), 0.5 * sigma[1] * d2)
        for m in range(3):
            half[:, m, :, m] += membrane
        flat = half.reshape(count, 3 * dofs, 3 * dofs)
        return flat + flat.swapaxes(1, 2)

    def _apply(self, triangles: slice, columns: Floats) -> Floats:
        stiffness = self.stiffness[triangles]
        count, q = stiffness.shape[:2]
        return np.matmul(stiffness, columns.reshape(count, q, 6, -1)).reshape(columns.shape)

    def translation_weights(self) -> Floats:
        vertices = len(self.surface.mesh.points)
        result = np.zeros((self.surface.scalars, 3))
        result[: 6 * vertices : 6] = 1.0 / vertices
        return result.ravel()

    @property
    def centres(self) -> Floats:
        """(triangle, 2) in the parameter plane."""
        return self.surface.affine.corners.mean(axis=1)

    @cached_property
    def sparsity(self) -> Sparsity:
        """Pattern of all matrices of this surface."""
        groups, sizes = self.surface.nodes.groups
        scalar = np.concatenate([np.repeat(np.arange(3), 6), [3, 4, 5]])
        return Sparsity(groups, 3 * sizes, self.surface.triangle_unknowns, np.tile(scalar, 3))
