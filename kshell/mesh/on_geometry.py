"""Meshes of order 1 put on the geometry they were made from: mid-edge nodes on its curves and surfaces.

gmsh evaluates the geometry; which vertex and edge lies on which of its entities is found here, by place, so the
mesh may come from anywhere and needs no numbers of gmsh in it:

- a vertex lies on every surface and curve that passes it at less than `OFF` of its shortest edge (to gmsh a plane
  has no end, so vertices of the border on none of the curves are asked for whether they lie within its face);
- an edge lies on a curve if its ends are neighbours along the curve, with no other vertex between them;
- every other edge lies on the surface of its triangles, which is the surface their corners have in common.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh import check
from kshell.mesh.geometry_file import IN_MILLIMETRES, is_discrete, opened
from kshell.mesh.mesh import Mesh
from kshell.mesh.words import count, place

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

OFF = 1e-3  # distance of a vertex from the geometry that is rounding, in its shortest edge
BULGE = 0.45  # distance of a mid-edge node from its chord, in the length of the chord; an arc of 168 degrees
SAMPLES = 9  # places along each parameter at which an entity is looked at to see where it lies
MARGIN = 0.3  # by which the box around these places is widened, in its diagonal
FOOT_STEPS = 4  # of the search for the foot of a perpendicular
HALVINGS = 50  # of the search for the middle of an arc


def put_on_geometry(mesh: Mesh, path: Path, allow_system: bool = False) -> Mesh:
    """The mesh of order 2 whose mid-edge nodes lie on a geometry.

    Parameters
    ----------
    mesh : Mesh
        Of order 1, its vertices on the geometry.
    path : Path
        .geo, .step, .brep or .iges.
    allow_system : bool
        Whether the geometry file may run programs and write files.

    Returns
    -------
    Mesh
        With the same vertices, triangles and groups; its last note says how far nodes were moved.

    Raises
    ------
    InputError
        If the mesh is of order 2 already, its vertices lie off the geometry, its triangles cross the edges of
        the geometry, or a triangle would be turned inside out.
    """
    if mesh.midpoints is not None:
        raise InputError(
            f"{mesh.source}: is of order 2 already, its own mid-edge nodes are used. Leave geometry = "
            f'"{path.name}" out'
        )
    with (
        tempfile.TemporaryDirectory(prefix="kshell-") as folder,
        opened(path, Path(folder), allow_system, "put the mesh on it") as gmsh,
    ):
        finder = _Finder(mesh, path, gmsh.model)
        midpoints, loose = finder.midpoints()
    lifted = replace(mesh, midpoints=midpoints)
    check.curved_triangles(lifted, midpoints)
    straight = mesh.points[mesh.edges].mean(axis=1)
    moved = np.linalg.norm(midpoints - straight, axis=1)
    worst = int(np.argmax(moved))
    note = (
        f"mid-edge nodes put on {path.name}: vertices lie within {finder.distance:.2g} of it, nodes moved by up to "
        f"{moved[worst]:.3g} at {place(straight[worst])}"
    )
    if loose:
        note += f"; {count(loose, 'edge')} of the border on none of its curves, put on its surfaces"
    return replace(lifted, notes=(*mesh.notes, note))


@dataclass
class _Entity:
    """A curve or surface, and the box it lies in."""

    dimension: int
    tag: int
    low: Floats
    high: Floats


class _Finder:
    """Where the parts of a mesh lie on the geometry open in gmsh."""

    def __init__(self, mesh: Mesh, path: Path, model: Any) -> None:
        self.mesh, self.path, self.model = mesh, path, model
        ends, lengths = mesh.edges, mesh.edge_lengths
        shortest = np.full(len(mesh.points), np.inf)
        np.minimum.at(shortest, ends.ravel(), np.repeat(lengths, 2))
        self.allowed = OFF * shortest
        self.surfaces = [self._entity(2, tag) for _, tag in model.getEntities(2)]
        if is_discrete(model):
            raise InputError(
                f"{path.name}: holds triangles instead of smooth surfaces (of an .stl file, perhaps): there is nothing "
                "to put the mesh on. Give the CAD geometry itself"
            )
        self.on_curve = np.zeros(len(mesh.points), dtype=bool)
        self.on_surface, self.distance = self._vertices_on_surfaces()
        self.surface_of = self._surfaces_of_triangles()

    def midpoints(self) -> tuple[Floats, int]:
        """(edge, 3) mid-edge nodes, and how many edges of the border lie on no curve."""
        mesh = self.mesh
        result = mesh.points[mesh.edges].mean(axis=1)
        done = np.zeros(len(mesh.edges), dtype=bool)
        for curve in self._curves():
            edges, middle = self._on_curve(curve, ~done)
            result[edges], done[edges] = middle, True
        loose = mesh.boundary_edges[~done[mesh.boundary_edges]]
        self._require_inside(np.unique(mesh.edges[loose]))
        self._on_surfaces(np.flatnonzero(~done), result)
        self._require_near(result)
        return result, len(loose)

    def _entity(self, dimension: int, tag: int) -> _Entity:
        points = self._sampled(dimension, tag)
        low, high = points.min(axis=0), points.max(axis=0)
        widened = MARGIN * float(np.linalg.norm(high - low)) + float(self.allowed.max())
        return _Entity(dimension, tag, low - widened, high + widened)

    def _sampled(self, dimension: int, tag: int, samples: int = SAMPLES) -> Floats:
        lower, upper = self.model.getParametrizationBounds(dimension, tag)
        axes = [np.linspace(a, b, samples) for a, b in zip(lower, upper, strict=True)]
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        return self._values(dimension, tag, grid.ravel())

    def _values(self, dimension: int, tag: int, parameters: Floats) -> Floats:
        return np.asarray(self.model.getValue(dimension, tag, parameters)).reshape(-1, 3)

    def _closest(self, entity: _Entity, points: Floats) -> Floats:
        if not len(points):
            return np.empty((0, 3))
        found = self.model.getClosestPoint(entity.dimension, entity.tag, points.ravel())[0]
        return np.asarray(found).reshape(-1, 3)

    def _near(self, entity: _Entity) -> tuple[Ints, Floats]:
        """Vertices in the box of an entity, and their distances from it."""
        points = self.mesh.points
        inside = np.flatnonzero(((points >= entity.low) & (points <= entity.high)).all(axis=1))
        return inside, np.linalg.norm(self._closest(entity, points[inside]) - points[inside], axis=1)

    def _vertices_on_surfaces(self) -> tuple[Bools, float]:
        """(surface, vertex) which lies on which, and the largest distance."""
        on = np.zeros((len(self.surfaces), len(self.mesh.points)), dtype=bool)
        nearest = np.full(len(self.mesh.points), np.inf)
        for row, surface in enumerate(self.surfaces):
            inside, distance = self._near(surface)
            on[row, inside] = distance <= self.allowed[inside]
            nearest[inside] = np.minimum(nearest[inside], distance)
        off = np.flatnonzero(~on.any(axis=0))
        if len(off):
            raise InputError(self._not_of_it(off))
        return on, float(nearest.max())

    def _not_of_it(self, off: Ints) -> str:
        """Words for vertices that lie off the geometry, with the distances of some of them."""
        mesh, some = self.mesh, off[:: max(1, len(off) // 100)]
        points = mesh.points[some]
        distance = np.min([self._distance(s, points) for s in self.surfaces], axis=0)
        worst = int(np.argmax(distance))
        sampled = np.concatenate([self._sampled(2, s.tag) for s in self.surfaces])
        boxes = [f"{place(p.min(axis=0))} to {place(p.max(axis=0))}" for p in (mesh.points, sampled)]
        unit = (
            "; of a file of this format gmsh makes millimetres"
            if self.path.suffix.lower() in IN_MILLIMETRES
            else ""
        )
        return (
            f"{mesh.source}: is no mesh of {self.path.name}: {len(off)} of {len(mesh.points)} "
            f"vertices lie off its surfaces, {place(points[worst])} by {distance[worst]:.3g}, more than "
            f"{self.allowed[some[worst]]:.2g} ({OFF:g} of the shortest edge there). The mesh reaches from {boxes[0]}, "
            f"the geometry about from {boxes[1]}{unit}. Give the geometry of this mesh, or mesh it again with "
            "mesh_order = 2"
        )

    def _distance(self, surface: _Entity, points: Floats) -> Floats:
        """Distance from a surface; outside the face of a plane from the places looked at on its border."""
        distance = np.linalg.norm(self._closest(surface, points) - points, axis=1)
        if self.model.getType(2, surface.tag) != "Plane":
            return distance
        outside = ~self._within(surface, points)
        curves = {abs(tag) for _, tag in self.model.getBoundary([(2, surface.tag)], False, False)}
        border = np.concatenate([self._sampled(1, tag, 25 * SAMPLES) for tag in sorted(curves)])
        distance[outside] = np.linalg.norm(points[outside, None] - border, axis=2).min(axis=1)
        return distance

    def _within(self, plane: _Entity, points: Floats) -> Bools:
        return np.array([self.model.isInside(2, plane.tag, x) > 0 for x in points], dtype=bool)

    def _require_inside(self, vertices: Ints) -> None:
        """Raise if vertices that lie on no curve, and on planes only, lie outside the faces there."""
        candidates = vertices[~self.on_curve[vertices]]
        inside = np.zeros(len(candidates), dtype=bool)
        for row, surface in enumerate(self.surfaces):
            mine = np.flatnonzero(self.on_surface[row, candidates])
            plane = self.model.getType(2, surface.tag) == "Plane"
            inside[mine] |= self._within(surface, self.mesh.points[candidates[mine]]) if plane else True
        if not inside.all():
            raise InputError(self._not_of_it(candidates[~inside]))

    def _surfaces_of_triangles(self) -> Ints:
        """(triangle,) row of the surface each lies on."""
        mesh = self.mesh
        candidate: Bools = np.all(self.on_surface[:, mesh.triangles], axis=2)  # (surface, triangle)
        number = candidate.sum(axis=0)
        nowhere = np.flatnonzero(number == 0)
        if len(nowhere):
            where = mesh.points[mesh.triangles[nowhere[0]]].mean(axis=0)
            raise InputError(
                f"{mesh.source}: {count(len(nowhere), 'triangle')} lie across an edge of {self.path.name}, corners on "
                f"different surfaces, e.g. at {place(where)}: the mesh does not follow the edges of the geometry. "
                "Mesh it again with mesh_order = 2, or join these surfaces in it"
            )
        result = np.argmax(candidate, axis=0)
        several = np.flatnonzero(number > 1)  # all corners on curves: the middle tells
        centres = mesh.points[mesh.triangles[several]].mean(axis=1)
        return self._nearest(several, centres, candidate[:, several], result)

    def _nearest(self, which: Ints, points: Floats, candidate: Bools, result: Ints) -> Ints:
        best = np.full(len(which), np.inf)
        for row in np.flatnonzero(candidate.any(axis=1)):
            mine = np.flatnonzero(candidate[row])
            distance = np.linalg.norm(self._closest(self.surfaces[row], points[mine]) - points[mine], axis=1)
            nearer = distance < best[mine]
            best[mine[nearer]] = distance[nearer]
            result[which[mine[nearer]]] = row
        return result

    def _curves(self) -> list[_Entity]:
        """Curves on surfaces, which are those that bound or divide one; points blown up to curves left out."""
        model = self.model
        tags = {abs(tag) for _, tag in model.getBoundary([(2, s.tag) for s in self.surfaces], False, False)}
        for surface in self.surfaces:
            tags |= {tag for dimension, tag in model.mesh.getEmbedded(2, surface.tag) if dimension == 1}
        sampled = {tag: self._sampled(1, tag) for tag in sorted(tags)}
        tiny = 1e-9 * self.mesh.size
        return [self._entity(1, tag) for tag, x in sampled.items() if np.ptp(x, axis=0).max() > tiny]

    def _on_curve(self, curve: _Entity, wanted: Bools) -> tuple[Ints, Floats]:
        """Wanted edges on a curve, and their midpoints."""
        mesh, tag = self.mesh, curve.tag
        inside, distance = self._near(curve)
        vertices = inside[distance <= self.allowed[inside]]
        self.on_curve[vertices] = True
        none: tuple[Ints, Floats] = np.empty(0, dtype=np.int64), np.empty((0, 3))
        if len(vertices) < 2:
            return none
        low, high = (float(bound[0]) for bound in self.model.getParametrizationBounds(1, tag))
        at = np.asarray(self.model.getParametrization(1, tag, mesh.points[vertices].ravel()))
        order = np.argsort(at, kind="stable")
        vertices, at = vertices[order], at[order]
        gap = np.linalg.norm(np.diff(mesh.points[vertices], axis=0), axis=1)
        # vertices at the same place, as at both sides of a slit, share a step
        step = np.concatenate([[0], np.cumsum(gap > self.allowed[vertices[1:]])])
        step_of = np.full(len(mesh.points), -1)
        at_of = np.zeros(len(mesh.points))
        step_of[vertices], at_of[vertices] = step, at
        edges = np.flatnonzero((step_of[mesh.edges] >= 0).all(axis=1) & wanted)
        ends = mesh.edges[edges]
        ends = np.where((step_of[ends[:, 0]] < step_of[ends[:, 1]])[:, None], ends, ends[:, ::-1])
        apart = step_of[ends[:, 1]] - step_of[ends[:, 0]]
        seam = self._values(1, tag, np.array([low, high]))
        closed = bool(np.linalg.norm(seam[1] - seam[0]) <= self.allowed.min())
        across = closed & (apart == step[-1]) & (apart > 1)
        chosen = (apart == 1) | across
        edges, ends, across = edges[chosen], ends[chosen], across[chosen]
        ends = np.where(across[:, None], ends[:, ::-1], ends)
        if not len(edges):
            return none
        begin, end = at_of[ends[:, 0]], at_of[ends[:, 1]] + across * (high - low)
        return edges, self._middles(tag, mesh.points[ends[:, 0]], mesh.points[ends[:, 1]], begin, end)

    def _middles(self, tag: int, a: Floats, b: Floats, begin: Floats, end: Floats) -> Floats:
        """Points of a curve between parameters `begin` and `end` as far from a as from b, by halving."""
        low, high = (float(bound[0]) for bound in self.model.getParametrizationBounds(1, tag))
        for _ in range(HALVINGS):
            middle = 0.5 * (begin + end)
            x = self._values(1, tag, np.where(middle > high, middle - (high - low), middle))
            ahead = np.sum((x - a) ** 2 - (x - b) ** 2, axis=1) > 0
            begin, end = np.where(ahead, begin, middle), np.where(ahead, middle, end)
        return x

    def _on_surfaces(self, edges: Ints, midpoints: Floats) -> None:
        """Replace straight midpoints by the closest points of the surfaces the triangles at the edge lie on."""
        mesh = self.mesh
        beside = np.zeros((len(self.surfaces), len(mesh.edges)), dtype=bool)
        beside[self.surface_of[:, None], mesh.triangle_edges] = True
        straight = midpoints[edges]
        best = np.full(len(edges), np.inf)
        for row, surface in enumerate(self.surfaces):
            mine = np.flatnonzero(beside[row, edges])
            found = self._foot(surface, straight[mine])
            distance = np.linalg.norm(found - straight[mine], axis=1)
            nearer = distance < best[mine]
            best[mine[nearer]] = distance[nearer]
            midpoints[edges[mine[nearer]]] = found[nearer]

    def _foot(self, surface: _Entity, points: Floats) -> Floats:
        """Feet of the perpendiculars of points on a surface.

        On surfaces of its own kernel gmsh's closest points lie on the surface, but beside the foot by up to a
        hundredth of the edge; a few steps of Gauss and Newton from its parameters bring them there.
        """
        if not len(points):
            return points
        tag, derivative = surface.tag, self.model.getDerivative
        found, parameters = (np.asarray(x) for x in self.model.getClosestPoint(2, tag, points.ravel()))
        best, uv = found.reshape(-1, 3), parameters.reshape(-1, 2)
        x = self._values(2, tag, uv.ravel())
        distance = np.linalg.norm(best - points, axis=1)
        for _ in range(FOOT_STEPS):
            tangents = np.nan_to_num(derivative(2, tag, uv.ravel())).reshape(-1, 2, 3)
            uv = uv + np.einsum("nxd,nx->nd", np.linalg.pinv(tangents), points - x)
            x = self._values(2, tag, uv.ravel())
            now = np.linalg.norm(x - points, axis=1)
            nearer = now < distance
            best[nearer], distance[nearer] = x[nearer], now[nearer]
        return best

    def _require_near(self, midpoints: Floats) -> None:
        mesh = self.mesh
        straight = mesh.points[mesh.edges].mean(axis=1)
        bulge = np.linalg.norm(midpoints - straight, axis=1) / mesh.edge_lengths
        far = np.flatnonzero(~(bulge <= BULGE))
        if len(far):
            worst = far[np.argmax(bulge[far])]
            raise InputError(
                f"{mesh.source}: {count(len(far), 'edge')} bulge by more than {BULGE:g} of their length from the "
                f"geometry {self.path.name}, e.g. at {place(straight[worst])} by {bulge[worst]:.3g}: the mesh is too "
                "coarse there to be curved. Mesh finer"
            )
