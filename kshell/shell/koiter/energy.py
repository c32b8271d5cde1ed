"""The Koiter energy of a shell on triangles of order p = 1, 2, 3, with gradient and Hessian.

The energy of a thin shell (Koiter 1966) per area of its midsurface at rest is

    1/2 E . A E + E . B kappa + 1/2 kappa . D kappa,    E = (a - A) / 2,   kappa = -(b - B),

with the fundamental forms a = x,a . x,b and b = n . x,ab of the midsurface. On triangles (Neunteufel and
Schoeberl, arXiv:1904.04714, 1907.06232, 2304.13806) it becomes a sum over triangles of

    1/2 s . K s,    s = (c, l),
    c = Regge interpolant of E,
    l = -sum_q w_q tau : (b - B) / J + sum_g w_g tau(nu, nu) (theta - Theta + alpha) / |X'|,

so that the energy is a quadratic function of few strains per triangle (energy.py). `Koiter._state` is these
two lines, `_gradient` and `_geometric` are their derivatives. The angle theta from the normal to the director
of the edge gives the curvature of a surface whose normal jumps across edges; a fold keeps its angle, and any
number of sheets may meet at an edge.

Symbols
-------
X, x = X + u      position at rest and deformed; x,1 x,2 tangents; x,v second derivatives, v = 11, 22, 12
alpha             rotation of the director of an edge, an unknown at each Gauss point of the edge
theta, Theta      angle from the normal to the director across the edge, now and at rest
Phi_r, tau_r      membrane strain functions, and moment functions tau_r = Phi_r / J^2, r = 3 k + v
c_r               coefficients of the membrane strain, a quadratic function of the nodal positions
l_r               curvature measured by tau_r
K                 stiffness of the triangle in its strains, moments condensed (constitutive.py)
w_q, w_g          weights of interior points and of Gauss points of the edges; J, |X'| area and length elements
nu                outward normal of an edge of the reference triangle
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.energy import StrainEnergy, in_blocks
from kshell.equilibrium.reduction import Reduction
from kshell.equilibrium.sparsity import Sparsity
from kshell.shell import kinematics
from kshell.shell.koiter.constitutive import TriangleStiffness
from kshell.shell.koiter.edges import Directors, rest_directors, turn_directors
from kshell.shell.koiter.strain_tables import strain_tables
from kshell.shell.koiter.surface import Surface
from kshell.shell.section import Section

Floats = NDArray[np.float64]


def energy_density(
    rest: Sequence[Floats], deformed: Sequence[Floats], membrane: Floats, coupling: Floats, bending: Floats
) -> float:
    """The Koiter energy per area at one point of a smooth surface, as the formula above says it.

    Parameters
    ----------
    rest, deformed : five vectors (3,)
        Derivatives of the position: X,1 X,2 X,11 X,22 X,12 and the same of x.
    membrane, coupling, bending : (3, 3)
        A, B, D in the frame whose first axis lies along X,1.
    """

    def forms(x_1: Floats, x_2: Floats, x_11: Floats, x_22: Floats, x_12: Floats) -> tuple[Floats, Floats]:
        n = np.cross(x_1, x_2) / np.linalg.norm(np.cross(x_1, x_2))
        first = np.array([[x_1 @ x_1, x_1 @ x_2], [x_1 @ x_2, x_2 @ x_2]])
        return first, np.array([[n @ x_11, n @ x_12], [n @ x_12, n @ x_22]])

    (big_a, big_b), (a, b) = forms(*rest), forms(*deformed)
    to_frame = np.linalg.inv(np.linalg.cholesky(big_a))  # from components along X,a to the frame
    strain, curvature = (to_frame @ t @ to_frame.T for t in ((a - big_a) / 2, -(b - big_b)))
    e, kappa = (np.array([t[0, 0], t[1, 1], 2 * t[0, 1]]) for t in (strain, curvature))
    return float(e @ membrane @ e / 2 + e @ coupling @ kappa + kappa @ bending @ kappa / 2)


class State(NamedTuple):
    """Kinematics of a block of triangles in one state."""

    position: Floats  # (3, triangle, n) nodes, relative to the first
    curvature: kinematics.Curvature
    angle: kinematics.Angle
    strain: Floats  # (triangle, 2 r)


class Koiter(StrainEnergy):
    """The energy of a surface with a section.

    Parameters
    ----------
    surface : Surface
    section : Section
    block : int
        Triangles worked on at a time; bounds the memory of intermediate arrays.
    rest : Directors, optional
        Those at rest, where they are known from more triangles than the surface has.
    """

    def __init__(
        self, surface: Surface, section: Section, block: int = 2048, rest: Directors | None = None
    ) -> None:
        self.surface = surface
        self.section = section
        self.tables = strain_tables(surface.order)
        count = len(surface.mesh.triangles)
        self.blocks = in_blocks(count, block)
        self.unknowns = surface.unknowns
        self.triangle_unknowns = surface.triangle_unknowns
        self.strains = 2 * surface.reference.strains
        self.inner = surface.inner_columns
        self.rest = rest_directors(surface) if rest is None else rest
        self._both = np.concatenate([surface.reference.first, surface.reference.second])

    @cached_property
    def constitutive(self) -> TriangleStiffness:
        """K."""
        return TriangleStiffness.of(self.surface, self.section, self.blocks)

    def forget(self) -> None:
        self.__dict__.pop("constitutive", None)

    @property
    def stiffness(self) -> Floats:
        """(triangle, 2 r, 2 r) K."""
        return self.constitutive.whole()

    @cached_property
    def _at_rest(self) -> tuple[Floats, Floats]:
        """Derivatives of the position at interior points, and tangents at points of edges, at rest."""
        surface = self.surface
        return surface.jets(surface.nodes, self._both), surface.tangents(surface.reference.edge_first)

    def _rest(self, triangles: slice) -> tuple[Floats, Floats]:
        """The same of some triangles; of many they are made each time, which leaves room for the factor."""
        surface = self.surface
        if self.unknowns <= self.kept:
            jets, tangents = self._at_rest
            return jets[:, :, triangles], tangents[:, :, triangles]
        jets = surface.jets(surface.nodes, self._both, triangles)
        return jets, surface.tangents(surface.reference.edge_first, triangles)

    def _nodes(self, field: Floats, triangles: slice) -> Floats:
        """Nodal vectors (3, triangle, n), relative to the first node: only differences matter."""
        local = field[self.surface.triangle_nodes[triangles]]
        return np.ascontiguousarray(np.moveaxis(local - local[:, :1], 2, 0))

    def _state(self, x: Floats, memory: Directors, triangles: slice) -> State:
        surface, reference, tables = self.surface, self.surface.reference, self.tables
        u, _ = surface.split(x)
        big, small = self._nodes(surface.nodes, triangles), self._nodes(u, triangles)

        stretch = tables.membrane_gradient(big + 0.5 * small)
        c = np.einsum("xtrj,xtj->tr", stretch, small)

        moved = surface.jets(u, self._both, triangles)
        at_rest, base = self._rest(triangles)
        curvature = kinematics.curvature_change(at_rest[:2], at_rest[2:], moved[:2], moved[2:])

        moved = surface.jets(u, reference.edge_first, triangles)
        if memory.base.any():
            shift = surface.jets(memory.base, reference.edge_first, triangles)
            base, moved = base + shift, surface.jets(u - memory.base, reference.edge_first, triangles)
        rotation = surface.triangle_rotations[triangles]
        angle = kinematics.angle_change(base, moved, reference.edge_tangents.T, memory.vectors[:, rotation])
        turn = memory.angle[triangles] + angle.change
        turn += self._edge_signs(triangles) * x[surface.rotation_start + rotation]

        length = tables.bending(
            curvature.change / surface.area_elements[triangles], turn / surface.edge_stretch[triangles]
        )
        strain = np.concatenate([c, length], axis=1)
        return State(big + small, curvature, angle, strain)

    def _edge_signs(self, triangles: slice) -> Floats:
        return np.repeat(self.surface.edge_sign[triangles], self.surface.order, axis=1).astype(float)

    def _gradient(self, state: State, triangles: slice) -> Floats:
        """Derivative of the strains by the unknowns of the triangle: (triangle, 2 r, 3 n + 3 p)."""
        surface, tables = self.surface, self.tables
        area, stretch = surface.area_elements[triangles], surface.edge_stretch[triangles]
        count, n = state.position.shape[1:]
        r = surface.reference.strains
        result = np.zeros((count, 2 * r, 3 * n + 3 * surface.order))

        membrane = tables.membrane_gradient(state.position)
        curvature = kinematics.curvature_gradient(state.curvature) / area
        bending = tables.bending_gradient(
            curvature, state.curvature.normal / area, kinematics.angle_gradient(state.angle) / stretch
        )
        for m in range(3):
            columns = slice(m * n, (m + 1) * n)
            result[:, :r, columns] = membrane[m]
            for v in range(3):
                result[:, r + v :: 3, columns] = bending[v, m]
        result[:, r:, 3 * n :] = tables.edges * (self._edge_signs(triangles) / stretch)[:, None, :]
        return result

    def _geometric(self, state: State, stress: Floats, triangles: slice) -> Floats:
        """sum_r stress_r times the second derivative of s_r by the nodal positions: (triangle, 3 n, 3 n)."""
        surface, tables = self.surface, self.tables
        n = state.position.shape[2]
        r = surface.reference.strains
        at_points, at_edges = tables.weights_of(stress[:, r:])
        by_x, normal_by_x = kinematics.curvature_hessian(
            state.curvature, at_points / surface.area_elements[triangles]
        )
        edge_weight = at_edges / surface.edge_stretch[triangles]
        gradient = kinematics.angle_gradient(state.angle)
        by_edge = [h * edge_weight for h in kinematics.angle_hessian(state.angle, gradient)]
        weights = at_points / surface.area_elements[triangles]
        half = tables.half_hessian(by_x, [[w * h for h in normal_by_x] for w in weights], by_edge)
        half = half.reshape(3, 3, -1, n, n)  # (component m, component l, triangle, node i, node j)
        membrane = 0.5 * tables.membrane_hessian(stress[:, :r]).reshape(-1, n, n)
        for m in range(3):
            half[m, m] += membrane
        whole = np.ascontiguousarray(half.transpose(2, 0, 3, 1, 4)).reshape(-1, 3 * n, 3 * n)
        return whole + whole.swapaxes(1, 2)

    def _apply(self, triangles: slice, columns: Floats) -> Floats:
        return self.constitutive.times(triangles, columns)

    def settle(
        self, x: Floats, memory: Directors, reduction: Reduction, initial: Floats | None = None
    ) -> tuple[Floats, Directors]:
        """Directors take up the rotations, but for prescribed ones."""
        return turn_directors(self.surface, memory, x, reduction.rotations)

    def most_moved(self, motion: Floats) -> Floats:
        u, _ = self.surface.split(motion)
        place: Floats = self.surface.nodes[np.argmax(np.linalg.norm(u, axis=1))]
        return place

    def translation_weights(self) -> Floats:
        result = np.zeros(self.unknowns)
        result[: self.surface.rotation_start] = 1.0 / self.surface.node_count
        return result

    @property
    def centres(self) -> Floats:
        """(triangle, 3)."""
        return self.surface.nodes[self.surface.triangle_nodes[:, :3]].mean(axis=1)

    @cached_property
    def sparsity(self) -> Sparsity:
        """Pattern of all matrices of this surface."""
        surface, p = self.surface, self.surface.order
        n = surface.triangle_nodes.shape[1]
        groups = np.concatenate([surface.triangle_nodes, surface.node_count + surface.rotation_edge], axis=1)
        sizes = np.repeat([3, p], [surface.node_count, len(surface.rotation_owner)])
        member = np.concatenate([np.tile(np.arange(n), 3), n + np.repeat(np.arange(3), p)])
        return Sparsity(groups, sizes, surface.triangle_unknowns, member)
