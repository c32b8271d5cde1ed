"""The Argyris element on a chart as the words of a scene need it. See `kshell.shell.koiter.discretisation`."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.reduction import Reduction
from kshell.errors import InputError
from kshell.material.inelastic import Inelastic
from kshell.mesh.mesh import Mesh
from kshell.mesh.select import Selection
from kshell.shell.chart import loads as chart_loads
from kshell.shell.chart.edges import vertex_sizes
from kshell.shell.chart.energy import ChartKoiter
from kshell.shell.chart.initial import initial_strain
from kshell.shell.chart.lines import doubtful, has_curved_edges
from kshell.shell.chart.matrices import chart_foundation
from kshell.shell.chart.nodes import Flags
from kshell.shell.chart.recovery import ChartRecovery, principal_curvature
from kshell.shell.chart.supports import ChartSupports
from kshell.shell.chart.surface import ChartLike, ChartSurface, jets_of_basis
from kshell.shell.discretisation import Conditions, Discretisation
from kshell.shell.evaluate import OfPlace
from kshell.shell.initial import StressFree
from kshell.shell.limits import USE_KOITER
from kshell.shell.scatter import along_directions, scattered
from kshell.shell.section import Section
from kshell.shell.turning import require_curve, require_no_point
from kshell.shell.vectors import AXES

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


class ArgyrisDiscretisation(Discretisation):
    """Argyris elements on the parameter plane of a chart.

    Parameters
    ----------
    mesh : Mesh
        In the parameter plane.
    chart : Chart
    lines, held, hinged : (edge,) flags, optional
        Edges inside across which strains may jump, those that supports hold, and hinges.

    Attributes
    ----------
    surface : ChartSurface
    unknowns : int
    loads : module
        Functions that turn values into forces on the unknowns.
    """

    name = "argyris"
    order = 5
    loads = chart_loads

    def __init__(
        self,
        mesh: Mesh,
        chart: ChartLike,
        lines: Flags | None = None,
        held: Flags | None = None,
        hinged: Flags | None = None,
    ) -> None:
        if has_curved_edges(mesh):
            raise InputError(
                f"{mesh.source}: edges of the parameter mesh are curved (order 2), the Argyris element on a chart "
                f"takes straight ones: mesh with order 1, or {USE_KOITER}"
            )
        self.surface = ChartSurface(mesh, chart, lines, held, hinged)
        self.unknowns = self.surface.unknowns

    def energy(self, section: Section, inelastic: Inelastic | None = None) -> ChartKoiter:
        """The energy with a cross-section.

        Raises
        ------
        InputError
            If it yields or relaxes.
        """
        if inelastic:
            raise InputError(
                f"materials that yield (hardening) or relax (relaxation) are not for this element: {USE_KOITER}"
            )
        return ChartKoiter(self.surface, section)

    def initial_strain(self, energy: ChartKoiter, state: StressFree, triangles: Ints) -> Floats:
        """The strains of triangles in a state free of stress."""
        return initial_strain(energy, state, triangles)

    def warnings(self) -> list[str]:
        """Of lines inside that end, turn or are curved."""
        doubt = doubtful(self.surface.nodes, self._vertices()[0])
        return [f"{doubt}: values near it depend on the mesh; refine it there"] if doubt else []

    def conditions(self) -> ArgyrisConditions:
        """Empty conditions on the motion."""
        return ArgyrisConditions(self.surface)

    def recovery(
        self,
        energy: ChartKoiter,
        x: Floats,
        finite: bool = False,
        memory: object = None,
        initial: Floats | None = None,
    ) -> ChartRecovery:
        """Values of a solution inside triangles."""
        return ChartRecovery(energy, x, finite, initial)

    def interior_points(self, triangles: Ints) -> tuple[Floats, Floats]:
        """Quadrature points (n, q, 3) of triangles in space and weights (n, q) with the area element."""
        surface = self.surface
        return np.moveaxis(surface.positions[:, triangles], 0, 2), surface.area_elements[
            triangles
        ] * surface.weights

    def mass(self, density: Floats) -> sp.csr_matrix:
        return chart_foundation(self.surface, density, np.eye(3))

    def patches(self) -> tuple[Ints, Floats]:
        """(triangle,) one smooth piece, and (triangle, 3) equal weights of the corners."""
        count = len(self.surface.mesh.triangles)
        return np.zeros(count, dtype=np.int64), np.ones((count, 3))

    def largest_curvature(self) -> Floats:
        """(triangle,) largest principal curvature in size."""
        return principal_curvature(self.surface)

    def extent(self) -> tuple[Floats, float]:
        """Centre (3,) and size of the shell."""
        x = self._vertices()[0]
        low, high = x.min(axis=0), x.max(axis=0)
        return 0.5 * (low + high), float(np.linalg.norm(high - low))

    def _vertices(self) -> tuple[Floats, Floats, Floats]:
        u, v = self.surface.mesh.points[:, :2].T
        x, x_a, x_ab = self.surface.chart.derivatives(u, v, order=2)
        return x, x_a, x_ab

    def unbalanced(self) -> str:
        """Rigid turns of a chart are no polynomials of its parameters, and strain triangles that bend much."""
        return (
            "Argyris functions follow a turn of the chart no closer on these triangles, and moments balance no better; "
            'take more triangles, or element = "koiter"'
        )

    def rigid_motions(self, centre: Floats, size: float, moved: Floats | None = None) -> Floats:
        """(unknowns, 6): unit translations along x, y, z, and turns by 1 / size about axes through the centre.

        Turns are those of the shell at rest, or of the shell moved by (unknowns,) `moved`.
        """
        mesh = self.surface.mesh
        x, x_a, x_ab = self._vertices()
        jets = np.concatenate([(x - centre)[:, None], x_a, x_ab[:, [0, 0, 1], [0, 1, 1]]], axis=1) / size
        ends = mesh.points[mesh.edges][:, :, :2]
        along = ends[:, 1] - ends[:, 0]
        normal = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.linalg.norm(along, axis=1)[:, None]
        slopes = self.surface.chart.derivatives(*ends.mean(axis=1).T, order=1)[1]
        across = np.einsum("ea,eax->ex", normal, slopes) / size
        nodes = self.surface.nodes
        arms = nodes.spread(jets, across)
        if moved is not None:
            arms = arms + moved.reshape(arms.shape) / size
        value = np.zeros((len(mesh.points), 6))
        value[:, 0] = 1.0
        result = np.zeros((self.unknowns, 6))
        for axis in range(3):
            result[axis::3, axis] = nodes.spread(value, np.zeros(len(mesh.edges)))
            result[:, 3 + axis] = np.cross(np.eye(3)[axis], arms).ravel()
        return result

    def unknown_sizes(self) -> Floats:
        """(unknowns,) 1 of displacements, 1 / h and 1 / h^2 of derivatives, h the parameter length of edges."""
        mesh = self.surface.mesh
        at_vertices = vertex_sizes(mesh)[:, None] ** -np.array([0.0, 1.0, 1.0, 2.0, 2.0, 2.0])
        return np.repeat(self.surface.nodes.spread(at_vertices, 1.0 / mesh.edge_lengths), 3)

    def vertex_of_unknown(self) -> Ints:
        """(unknowns,) the vertex of each unknown, one end for those of edges."""
        mesh = self.surface.mesh
        at_vertices = np.repeat(np.arange(len(mesh.points))[:, None], 6, axis=1)
        return np.repeat(self.surface.nodes.spread(at_vertices, mesh.edges[:, 0]), 3)

    def translation_row(self, triangle: int, xi: Floats, axis: int) -> Floats:
        """(unknowns,) whose product with x is a component of the displacement at a reference point (2,)."""
        row = np.zeros(self.unknowns)
        shape = self.surface.shape(jets_of_basis(xi[None])[:1], np.array([triangle]))
        row[3 * self.surface.scalar[triangle].astype(np.int64) + axis] = shape[0, 0, 0]
        return row

    def spring(self, chosen: Selection, along: str | Floats, stiffness: OfPlace, what: str) -> sp.csr_matrix:
        """Stiffness of springs along a unit vector, along the normal, or against the rotation about an edge.

        Raises
        ------
        InputError
            For rotation springs elsewhere than on curves.
        """
        surface, members = self.surface, chosen.members
        if isinstance(along, str) and along == "r":
            return self._rotation_spring(chosen, stiffness, what)
        normal = isinstance(along, str)
        direction = np.zeros(3) if normal else np.asarray(along)
        if chosen.dimension == 0:
            x, x_a, _ = (value[members] for value in self._vertices())
            direction = _unit(np.cross(x_a[:, 0], x_a[:, 1]))[:, None] if normal else direction
            blocks = along_directions(stiffness(x)[:, None], np.ones((1, 1)), direction)
            return self._scatter(18 * members.astype(np.int64)[:, None] + np.arange(3), blocks)
        if chosen.dimension == 1:
            parts = []
            values, slopes = (f(surface, members) for f in (chart_loads.values_on_edges, chart_loads.slopes))
            for (triangles, points, weights, shape), (_, _, _, n, _) in zip(values, slopes, strict=True):
                here = np.moveaxis(n, 0, 2) if normal else direction
                blocks = along_directions(weights * stiffness(points), shape, here)
                parts.append(self._scatter(_components(surface.scalar[triangles]), blocks))
            return sum(parts[1:], parts[0])
        points, weight = self.interior_points(members)
        shape = surface.shape(surface.tables[:1], members)[0]
        if normal:
            x_1, x_2 = np.moveaxis(surface.first[:, :, members], 1, 3)
            direction = _unit(np.cross(x_1, x_2))
        blocks = along_directions(weight * stiffness(points), shape, direction)
        return self._scatter(_components(surface.scalar[members]), blocks)

    def moved_rigidly(self, chosen: Selection, what: str) -> Ints:
        """None: continuous curvature would stiffen what lies beside the link."""
        raise InputError(f"{what} is not for Argyris elements on a chart: {USE_KOITER}")

    def _rotation_spring(self, chosen: Selection, stiffness: OfPlace, what: str) -> sp.csr_matrix:
        """The turn about an edge is n . du/dmu, mu the conormal."""
        require_curve(chosen, what)
        parts = []
        for triangles, points, weights, n, slope in chart_loads.slopes(self.surface, chosen.members):
            # (triangle, q, 63), component by component as the unknowns of a triangle
            turn = np.concatenate([n[m][..., None] * slope for m in range(3)], axis=2)
            blocks = np.matmul(turn.swapaxes(1, 2), (weights * stiffness(points))[..., None] * turn)
            parts.append(self._scatter(self.surface.triangle_unknowns[triangles].astype(np.int64), blocks))
        return sum(parts[1:], parts[0])

    def _scatter(self, unknowns: NDArray[np.int64], blocks: Floats) -> sp.csr_matrix:
        return scattered(unknowns, blocks, self.unknowns)


def _components(scalars: Ints) -> NDArray[np.int64]:
    """(n, 3 k) unknowns of the components of scalar functions (n, k)."""
    unknowns = 3 * scalars.astype(np.int64)[:, :, None] + np.arange(3)
    return unknowns.reshape(len(scalars), -1)


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


class ArgyrisConditions(Conditions):
    """Conditions on the motion of a chart surface, from selections of a mesh."""

    def __init__(self, surface: ChartSurface) -> None:
        self.surface = surface
        self.kernel = ChartSupports(surface)

    def translations(self, chosen: Selection, letters: str, value: OfPlace, axes: Any = None) -> None:
        """Hold the components named by letters, in own axes (3, 3) if given, of vertices, edges or triangles."""
        for letter in letters:
            axis = np.eye(3)[AXES[letter]] if axes is None else np.array(axes["xyz".index(letter)])

            def along(x: Floats, axis: Floats = axis) -> Floats:
                return value(x) @ axis

            if chosen.dimension == 0:
                self.kernel.at_vertices(chosen.members, axis, along)
            elif chosen.dimension == 1:
                self.kernel.along_edges(chosen.members, axis, along)
            else:
                self.kernel.over_triangles(chosen.members, axis, along)

    def rotations(self, chosen: Selection, what: str, value: OfPlace | None = None) -> None:
        """Hold the rotation about edges."""
        require_no_point(chosen, what)
        if value is not None:
            raise InputError(f"{what}: a prescribed rotation is for Koiter elements: {USE_KOITER}")
        if chosen.dimension == 1:
            self.kernel.rotation(chosen.members)
        elif not self.kernel.at_rest(chosen.members):  # what is at rest does not turn
            raise InputError(
                f"{what}: the smooth functions of Argyris elements on a chart would not bend at all if no edge of a "
                f"surface may turn: hold its translations, too, hold the rotation on curves, or {USE_KOITER}"
            )

    def symmetry(self, edges: Ints, normal: Floats | None = None) -> Floats:
        """A plane of symmetry through edges; its normal (3,), which is found where none is given."""
        return self.kernel.symmetry(edges, normal)

    def reduction(self) -> Reduction:
        """The motions left."""
        return self.kernel.reduction()

    def alone(self) -> Reduction:
        """The motions that supports leave where nothing ties the sides of lines that they do not touch."""
        return self.kernel.reduction(tied=False)
