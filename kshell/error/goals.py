"""Quantities to be bounded: functionals of the deflection that are finite for every deflection of finite energy.

Deflections at vertices, means of rotations over triangles or edges, of moments over triangles, of deflections over
edges. Moments and rotations at a point are not among them: the energy of their duals is infinite.

Symbols
-------
J(w)      sum of forces at vertices times w + line weights int_E w + turning weights int_E dw/dn + int_T s : kappa(w)
kappa     (w_xx, w_yy, 2 w_xy)
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.mesh import Mesh
from kshell.mesh.select import select
from kshell.plate.problem import PlateProblem

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NONE = np.zeros(0, dtype=np.int64)
NOTHING = np.zeros(0)


@dataclass(frozen=True)
class Goal:
    """A linear functional of the deflection, plus a constant.

    Attributes
    ----------
    name : str
    vertices, forces : (n,) arrays
    lines, line_weights : (n,) arrays
        Edges, and the weights of the integral of w along them.
    turns, turn_weights : (n,) arrays
        Edges, and the weights of the integral of dw/dn; n is the tangent from the lower to the higher vertex turned
        by -90 degrees.
    stress : (T, 3) array or None
        s of each triangle.
    constant : float
    """

    name: str
    vertices: Ints = field(default_factory=lambda: NONE)
    forces: Floats = field(default_factory=lambda: NOTHING)
    lines: Ints = field(default_factory=lambda: NONE)
    line_weights: Floats = field(default_factory=lambda: NOTHING)
    turns: Ints = field(default_factory=lambda: NONE)
    turn_weights: Floats = field(default_factory=lambda: NOTHING)
    stress: Floats | None = None
    constant: float = 0.0

    @property
    def on_edges(self) -> list[tuple[Ints, Floats, bool]]:
        """Edges, weights, and whether slopes are meant, of what there is."""
        parts = [(self.lines, self.line_weights, False), (self.turns, self.turn_weights, True)]
        return [part for part in parts if len(part[0])]

    @classmethod
    def deflection(cls, mesh: Mesh, at: tuple[float, ...]) -> Goal:
        """w at the vertex at a place.

        Raises
        ------
        InputError
            If no vertex lies there: inside a triangle w is not a vertex value of the other side of the bounds.
        """
        found = select(mesh, at, dimensions=(0,), what="probe")
        if found.distance > 1e-9 * mesh.size:
            x, y = mesh.points[found.members[0], :2]
            raise InputError(
                f"no vertex of the mesh lies at {tuple(at)}: the nearest one is at ({x:g}, {y:g}); make the place "
                "a vertex"
            )
        return cls.at_vertex(int(found.members[0]))

    @classmethod
    def at_vertex(cls, vertex: int) -> Goal:
        """w at a vertex."""
        return cls(f"deflection at vertex {vertex}", vertices=np.array([vertex]), forces=np.ones(1))

    @classmethod
    def mean_deflection(cls, mesh: Mesh, edges: Ints) -> Goal:
        """Mean of w over edges."""
        edges = np.asarray(edges, dtype=np.int64)
        weights = np.full(len(edges), 1.0 / mesh.edge_lengths[edges].sum())
        return cls("mean deflection", lines=edges, line_weights=weights)

    @classmethod
    def mean_edge_rotation(cls, mesh: Mesh, edges: Ints) -> Goal:
        """Mean of dw/dn over edges, n the edges' own normals."""
        edges = np.asarray(edges, dtype=np.int64)
        weights = np.full(len(edges), 1.0 / mesh.edge_lengths[edges].sum())
        return cls("mean rotation", turns=edges, turn_weights=weights)

    @classmethod
    def mean_slope(cls, mesh: Mesh, triangles: Ints, direction: tuple[float, float]) -> Goal:
        """Mean over triangles of the derivative of w along a direction: by Gauss, an integral of w over their edges."""
        triangles = np.asarray(triangles, dtype=np.int64)
        x = mesh.points[mesh.triangles[triangles], :2]
        turned = np.array(
            [direction[1], -direction[0]]
        )  # d . n ds = turned . t ds with n = t turned by -90 degrees
        weights = np.zeros(len(mesh.edges))
        a, b = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]
        sense = np.sign(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
        for k, (i, j) in enumerate(
            ((0, 1), (1, 2), (2, 0))
        ):  # counterclockwise, the mesh's edges 0 1, 1 2, 0 2
            edge = mesh.triangle_edges[triangles, k]
            step = (x[:, j] - x[:, i]) / mesh.edge_lengths[edge][:, None]
            np.add.at(weights, edge, -sense * (step @ turned))
        weights /= mesh.areas[triangles].sum()
        lines = np.flatnonzero(np.abs(weights) > 1e-13 * np.abs(weights).max(initial=1e-300))
        return cls("mean slope", lines=lines, line_weights=weights[lines])

    @classmethod
    def mean_moment(cls, problem: PlateProblem, triangles: Ints, component: int) -> Goal:
        """Mean over triangles of M_xx, M_yy or M_xy (0, 1, 2), M = -D (kappa - initial curvature)."""
        mesh = problem.mesh
        triangles = np.asarray(triangles, dtype=np.int64)
        area = mesh.areas[triangles].sum()
        stress = np.zeros((len(mesh.triangles), 3))
        stress[triangles] = -problem.section.bending_per_triangle()[triangles, component] / area
        goal = cls(f"mean moment {component}", stress=stress)
        if not problem.loads.curvatures:
            return goal
        constant = 0.0
        for patch in problem.domain.patches(6, triangles):
            initial = problem.loads.initial_curvature(patch.triangles, patch.xy)
            constant -= float(np.einsum("tq,tqv,tv->", patch.weights, initial, stress[patch.triangles]))
        return replace(goal, constant=constant)
