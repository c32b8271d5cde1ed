"""The Koiter element on a mesh as the words of a scene need it: places of conditions, loads, springs, rigid motion.

`kshell.shell.chart.discretisation` does the same for the Argyris element on a chart; what builds a problem
from a scene works with either.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, partial
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.reduction import Reduction
from kshell.material.inelastic import Inelastic
from kshell.mesh.mesh import Mesh
from kshell.mesh.select import Selection
from kshell.mesh.vectors import cross
from kshell.shell.discretisation import Conditions, Discretisation, Distribution
from kshell.shell.evaluate import OfPlace
from kshell.shell.initial import StressFree
from kshell.shell.koiter import loads
from kshell.shell.koiter.along import along_edges
from kshell.shell.koiter.energy import Koiter
from kshell.shell.koiter.initial import initial_strain
from kshell.shell.koiter.loads import (
    edge_normals,
    edge_rotations,
    edge_table,
    surface_normals,
    surface_points,
)
from kshell.shell.koiter.matrices import mass
from kshell.shell.koiter.reactions import rotation_axes
from kshell.shell.koiter.recovery import KoiterRecovery
from kshell.shell.koiter.relaxing import RelaxingKoiter
from kshell.shell.koiter.supports import Supports
from kshell.shell.koiter.surface import Surface
from kshell.shell.koiter.topology import largest_curvature, smooth_patches
from kshell.shell.koiter.yielding import YieldingKoiter
from kshell.shell.reference import lagrange
from kshell.shell.scatter import along_directions, scattered
from kshell.shell.section import Section
from kshell.shell.turning import require_curve, require_no_point

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# neighbours that meet at a smaller angle belong to one smooth patch; flat facets of a curved surface meet at some
FOLD = np.radians(10.0)
FLAT = 1e-6
FACET = np.radians(35.0)


class KoiterDiscretisation(Discretisation):
    """Koiter elements of order p.

    Parameters
    ----------
    mesh : Mesh
        In space, or in the parameter plane of a chart.
    order : int
        From 1 to 6.
    lift : function or None
        From parameters to the chart.
    hinges : (n,) int array
        Edges about which the sheets turn freely.
    offsets : (node, 3), optional
        By which the nodes are moved.

    Attributes
    ----------
    surface : Surface
    unknowns : int
    loads : module
        Functions that turn values into forces on the unknowns.
    """

    name = "koiter"
    loads = loads

    def __init__(
        self,
        mesh: Mesh,
        order: int,
        lift: Callable[[Floats], Floats] | None,
        hinges: Ints,
        offsets: Floats | None = None,
    ) -> None:
        self.surface = Surface(mesh, order, lift, hinges, offsets)
        self.order = order
        self.unknowns = self.surface.unknowns

    def energy(self, section: Section, inelastic: Inelastic | None = None) -> Koiter:
        """The energy with a cross-section, and with what it remembers of its past."""
        if inelastic is not None and inelastic.yielding is not None:
            return YieldingKoiter(self.surface, section, inelastic.yielding)
        if inelastic is not None and inelastic.relaxation:
            return RelaxingKoiter(self.surface, section, inelastic.relaxation)
        return Koiter(self.surface, section)

    def initial_strain(self, energy: Koiter, state: StressFree, triangles: Ints) -> Floats:
        """The strains of triangles in a state free of stress."""
        return initial_strain(energy, state, triangles)

    def conditions(self) -> KoiterConditions:
        """Empty conditions on the motion."""
        return KoiterConditions(self.surface)

    def interior_points(self, triangles: Ints) -> tuple[Floats, Floats]:
        """Quadrature points (n, q, 3) of triangles in space and weights (n, q) with the area element."""
        ref = self.surface.reference
        return surface_points(self.surface, triangles), self.surface.area_elements[triangles] * ref.weights

    def recovery(
        self,
        energy: Koiter,
        x: Floats,
        finite: bool = False,
        memory: Any = None,
        initial: Floats | None = None,
    ) -> KoiterRecovery:
        """Values of a solution inside triangles."""
        return KoiterRecovery(energy, x, finite, memory, initial)

    def mass(self, density: Floats) -> sp.csr_matrix:
        return mass(self.surface, density)

    @property
    def true_shape(self) -> bool:
        """Whether the triangles follow a curved surface: of order 2, or on a chart."""
        return self.surface.mesh.order == 2 or self.surface.nodes is not self.surface.flat_nodes

    def patches(self) -> tuple[Ints, Floats]:
        """(triangle,) smooth piece of each triangle, and (triangle, 3) angles at the corners."""
        return self._patches, self.surface.corner_angles

    @cached_property
    def _patches(self) -> Ints:
        curving = self.surface.mesh.curving
        if curving is not None and curving.polygonal and not self.true_shape:
            return smooth_patches(self.surface, FLAT)
        return smooth_patches(self.surface, FOLD if self.true_shape else FACET)

    def largest_curvature(self) -> Floats:
        """(triangle,) largest principal curvature in size."""
        return (
            largest_curvature(self.surface) if self.order > 1 else np.zeros(len(self.surface.mesh.triangles))
        )

    def rigid_motions(self, centre: Floats, size: float, moved: Floats | None = None) -> Floats:
        """(unknowns, 6): unit translations along x, y, z, and turns by 1 / size about axes through the centre.

        Turns are those of the shell at rest, or of the shell moved by (unknowns,) `moved`.
        """
        surface = self.surface
        result = np.zeros((self.unknowns, 6))
        u = np.zeros_like(surface.nodes) if moved is None else surface.split(moved)[0]
        arm = (surface.nodes + u - centre) / size
        for axis in range(3):
            result[axis : surface.rotation_start : 3, axis] = 1.0
            turn = cross(np.eye(3)[axis], arm)
            result[: surface.rotation_start, 3 + axis] = turn.ravel()
        result[surface.rotation_start :, 3:] = rotation_axes(surface, u) / size
        return result

    def extent(self) -> tuple[Floats, float]:
        """Centre (3,) and size of the shell."""
        low, high = self.surface.nodes.min(axis=0), self.surface.nodes.max(axis=0)
        return 0.5 * (low + high), float(np.linalg.norm(high - low))

    def unknown_sizes(self) -> Floats:
        """(unknowns,) 1 of displacements, 1 / size of the shell of rotations."""
        out = np.ones(self.unknowns)
        out[self.surface.rotation_start :] = 1.0 / self.extent()[1]
        return out

    def vertex_of_unknown(self) -> Ints:
        """(unknowns,) some vertex of the triangles that each unknown belongs to."""
        surface = self.surface
        result = np.zeros(self.unknowns, dtype=np.int64)
        result[surface.triangle_unknowns] = surface.mesh.triangles[:, :1]
        return result

    def translation_row(self, triangle: int, xi: Floats, axis: int) -> Floats:
        """(unknowns,) whose product with x is a component of the displacement at a reference point (2,)."""
        row = np.zeros(self.unknowns)
        nodes = self.surface.triangle_nodes[triangle].astype(np.int64)
        row[3 * nodes + axis] = lagrange(self.order, xi[None])[0]
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
            nodes = members.astype(np.int64)[:, None]
            shape, weight, points = np.ones((1, 1)), np.ones(nodes.shape), surface.nodes[nodes]
            direction = surface.vertex_normals[members][:, None] if normal else direction
        elif chosen.dimension == 1:
            nodes, shape, weight, points = edge_table(surface, members, surface.order + 1)
            direction = edge_normals(surface, members, surface.order + 1) if normal else direction
        else:
            points, weight = self.interior_points(members)
            nodes, shape = surface.triangle_nodes[members], surface.reference.values
            direction = surface_normals(surface, members) if normal else direction
        blocks = along_directions(weight * stiffness(points), shape, direction)
        unknowns = 3 * nodes.astype(np.int64)[:, :, None] + np.arange(3)
        return scattered(unknowns.reshape(len(nodes), -1), blocks, self.unknowns)

    def distribution(self) -> Distribution:
        return partial(along_edges, self.surface)

    def moved_rigidly(self, chosen: Selection, what: str) -> Ints:
        """Translations of the nodes, and rotations of the edges."""
        surface, edges = self.surface, chosen.members
        if chosen.dimension == 2:
            edges = np.unique(surface.mesh.triangle_edges[chosen.members])
            nodes = surface.nodes_of_triangles(chosen.members)
        else:
            nodes = surface.nodes_of_edges(edges)
        translations = 3 * nodes.astype(np.int64)[:, None] + np.arange(3)
        return np.concatenate([translations.ravel(), surface.rotations_of_edges(edges)])

    def _rotation_spring(self, chosen: Selection, stiffness: OfPlace, what: str) -> sp.csr_matrix:
        require_curve(chosen, what)
        surface = self.surface
        _, _, weight, points = edge_table(surface, chosen.members, surface.order)
        unknowns, _ = edge_rotations(surface, chosen.members)
        diagonal = np.zeros(self.unknowns)
        np.add.at(diagonal, unknowns, weight * stiffness(points))
        return sp.diags(diagonal).tocsr()


class KoiterConditions(Conditions):
    """Conditions on the motion of a Koiter surface, from selections of a mesh."""

    def __init__(self, surface: Surface) -> None:
        self.surface = surface
        self.kernel = Supports(surface)

    def translations(self, chosen: Selection, letters: str, value: OfPlace, axes: Any = None) -> None:
        """Hold the components named by letters, in own axes (3, 3) if given, at nodes of vertices, edges, triangles."""
        surface = self.surface
        if chosen.dimension == 0:
            nodes: Any = chosen.members
        elif chosen.dimension == 1:
            nodes = surface.nodes_of_edges(chosen.members)
        else:
            nodes = surface.nodes_of_triangles(chosen.members)
        values = value(surface.nodes[nodes])
        if axes is None:
            self.kernel.translation(nodes, letters, values)
            return
        for letter in letters:
            axis = np.array(axes["xyz".index(letter)])
            self.kernel.along(nodes, axis, values @ axis)

    def rotations(self, chosen: Selection, what: str, value: OfPlace | None = None) -> None:
        """Hold the rotation about edges, in a surface about all of its edges."""
        require_no_point(chosen, what)
        edges = chosen.members
        if chosen.dimension == 2:
            edges = np.unique(self.surface.mesh.triangle_edges[chosen.members])
        if value is None:
            self.kernel.rotation(edges)
            return
        unknowns, sign = edge_rotations(self.surface, edges)
        points = edge_table(self.surface, edges, self.surface.order)[3]
        given = np.zeros(self.surface.unknowns)
        given[unknowns] = sign * value(points)
        self.kernel.rotation(edges, given[self.surface.rotations_of_edges(edges)])

    def symmetry(self, edges: Ints, normal: Floats | None = None) -> Floats:
        """A plane of symmetry through edges; its normal (3,), which is found where none is given."""
        return self.kernel.symmetry(edges, normal)

    def reduction(self) -> Reduction:
        """The motions left."""
        return self.kernel.reduction()
