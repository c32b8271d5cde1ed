"""Where the forces of a plate are looked at for its transverse shear, and the places where they grow without bound.

Farther than CUT thicknesses from singular corners and point forces, where a plate with shear has no singularity.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.error.plates import AT_VERTEX
from kshell.error.tractions import Tractions
from kshell.plate.loading import PointLoad
from kshell.plate.places import points_3d
from kshell.plate.problem import PlateProblem
from kshell.scene.supports import Clamped, Elastic, Fixed, SimplySupported, SoftSupported, Symmetry

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CUT = 0.35  # thicknesses from singular places
DEGREE = 4  # of the quadrature of products of shear forces, which are quadratic in a triangle
EDGE_POINTS = 4
THICKEST = (
    0.25  # thickness over the root of the area that counts for that: what is cut out must leave something
)
STRAIGHT, RIGHT, HARMLESS = np.radians(181.0), np.radians(91.0), np.radians(100.0)


@dataclass(frozen=True)
class Part:
    """Some points at which products are summed.

    Attributes
    ----------
    triangles : (n,) int array
    xi : (point, 2) or (n, point, 2)
    weights : (n, point) of the first deflection with itself, and with others
    beside : (n,) bool array
        Whether forces there are not to be relied on.
    compliance : (n or 1, point or 1, 2, 2), optional
        S^-1, inside; one where it is the same everywhere.
    twist : (n, point, 3), optional
        On edges, what takes m_nt from moments.
    """

    triangles: Ints
    xi: Floats
    weights: tuple[Floats, Floats]
    beside: NDArray[np.bool_]
    compliance: Floats | None = None
    twist: Floats | None = None

    def sampled(self, tractions: Tractions) -> Floats:
        """Q (n, k, point, 2), or m_nt (n, k, point), of each deflection."""
        if self.twist is None:
            return tractions.shear_at(self.triangles, self.xi)
        moment = tractions.at(self.triangles, self.xi)[0]
        return np.asarray((moment * self.twist[:, None]).sum(axis=-1))

    def between(self, first: Floats, second: Floats) -> Floats:
        """(n, point) the density of the product of two of them."""
        if self.compliance is None:
            return first * second
        c = self.compliance
        strain = c[..., 0] * second[..., :1] + c[..., 1] * second[..., 1:]
        return np.asarray(first[..., 0] * strain[..., 0] + first[..., 1] * strain[..., 1])


@dataclass(frozen=True)
class Weights:
    """Of one plate and its singular places."""

    key: tuple[bytes, ...]
    parts: list[Part]

    def sampled(self, tractions: Tractions) -> list[Floats]:
        return [part.sampled(tractions) for part in self.parts]


def weights_of(
    problem: PlateProblem, centres: Floats, strong: NDArray[np.bool_], near: Floats | None
) -> Weights:
    """What does not depend on deflections; the last ones of a plate are kept, for further loads."""
    key = tuple(part.tobytes() for part in (centres, strong, np.zeros(0) if near is None else near))
    known: Weights | None = problem.shared.get("shear")
    if known is not None and known.key == key:
        return known
    beside = _beside(problem, centres[strong])
    most = THICKEST * float(np.sqrt(problem.mesh.areas.sum()))

    def both(xy: Floats, thickness: Floats, weights: Floats) -> tuple[Floats, Floats]:
        first = weights * _far(xy, centres, thickness)
        return first, first if near is None else first * _far(xy, near, thickness)

    def of_section(triangles: Ints, xy: Floats) -> tuple[Ints, Floats]:
        """What a section is asked at: where it is the same everywhere, of one point."""
        some = slice(1 if problem.section.uniform else None)
        return triangles[some], points_3d(problem.domain, xy[some, some])

    parts = []
    for patch in problem.domain.patches(DEGREE):
        at = of_section(patch.triangles, patch.xy)
        thickness = np.minimum(problem.section.thickness(*at), most)
        compliance = np.asarray(np.linalg.inv(problem.section.shear(*at)), dtype=np.float64)
        weights = both(patch.xy, thickness, patch.weights)
        parts.append(Part(patch.triangles, patch.xi, weights, beside[patch.triangles], compliance))
    edges = _soft_edges(problem)
    if len(edges):
        line = problem.domain.edge_patch(edges, EDGE_POINTS)
        at = of_section(line.triangles, line.xy)
        thickness = np.minimum(problem.section.thickness(*at), most)
        n = line.normal
        t = np.stack([-n[..., 1], n[..., 0]], axis=-1)
        nx, ny, tx, ty = n[..., 0], n[..., 1], t[..., 0], t[..., 1]
        twist = np.stack([nx * tx, ny * ty, nx * ty + ny * tx], axis=-1)
        d66 = (twist[..., None, :] @ problem.section.bending(*at) @ twist[..., None])[..., 0, 0]
        along = (t[..., None, :] @ problem.section.shear(*at) @ t[..., None])[..., 0, 0]
        weights = both(line.xy, thickness, line.weights * np.sqrt(d66 / along) / d66)
        parts.append(Part(line.triangles, line.xi, weights, beside[line.triangles], twist=twist))
    found = problem.shared["shear"] = Weights(key, parts)
    return found


def _beside(problem: PlateProblem, centres: Floats) -> NDArray[np.bool_]:
    """(triangle,) the triangles at centres (n, 2) that reach farther than CUT thicknesses, and those around them."""
    points, mesh = problem.domain.points, problem.mesh
    at = np.zeros(len(points), dtype=bool)
    for centre in centres:
        at |= np.hypot(*(points - centre).T) <= AT_VERTEX * mesh.size
    chosen = np.flatnonzero(at[mesh.triangles].any(axis=1))
    middle = points_3d(problem.domain, points[mesh.triangles[chosen]].mean(axis=1)[:, None])
    reach = mesh.edge_lengths[mesh.triangle_edges[chosen]].max(axis=1)
    chosen = chosen[reach > CUT * problem.section.thickness(chosen, middle)[:, 0]]
    near = np.zeros(len(points), dtype=bool)
    near[mesh.triangles[chosen]] = True
    return np.asarray(near[mesh.triangles].any(axis=1))


def _far(xy: Floats, centres: Floats, thickness: Floats) -> NDArray[np.bool_]:
    """Whether points (n, q, 2) are farther than CUT thicknesses from all centres (k, 2)."""
    far = np.ones(xy.shape[:-1], dtype=bool)
    reach, x, y = (CUT * thickness) ** 2, xy[..., 0], xy[..., 1]
    for centre in centres:
        far &= (x - centre[0]) ** 2 + (y - centre[1]) ** 2 > reach
    return far


def _soft_edges(problem: PlateProblem) -> Ints:
    """Boundary edges along which the twist is not held: free, on springs, and soft supports."""
    mesh = problem.mesh
    hard = np.zeros(len(mesh.edges), dtype=bool)
    for support in problem.structure.supports:
        item, selection = support.item, support.place
        if selection is None or selection.dimension == 0 or isinstance(item, SoftSupported | Elastic):
            continue
        if isinstance(item, SimplySupported | Clamped | Symmetry | Fixed) and set(item.freedoms) & set("zr"):
            members = selection.members
            hard[members if selection.dimension == 1 else mesh.triangle_edges[members].ravel()] = True
    boundary = mesh.boundary_edges
    return boundary[~hard[boundary]].astype(np.int64)


def singular_places(problem: PlateProblem) -> tuple[Floats, NDArray[np.bool_]]:
    """(k, 2) places where shear forces grow without bound, and (k,) whether their energy does so fast.

    Corners, where supports change, and points that are held or loaded; corners of about 90 degrees between edges that
    are held differently are harmless: on meshes that do not resolve them predictions were right within 15 %.
    """
    if "singular places" not in problem.shared:
        problem.shared["singular places"] = _singular_vertices(problem)
    vertices, its = problem.shared["singular places"]
    loaded = [np.reshape(form.xy, (1, 2)) for form in problem.loads.forms if isinstance(form, PointLoad)]
    places = np.concatenate([problem.domain.points[vertices], *loaded])
    return places, np.append(its, np.ones(len(loaded), dtype=bool))


def _singular_vertices(problem: PlateProblem) -> tuple[Ints, NDArray[np.bool_]]:
    """The same of vertices, whatever the loads."""
    mesh, supports = problem.mesh, problem.supports
    held, turned = (np.zeros(len(mesh.edges), dtype=bool) for _ in range(2))
    found = {int(v): True for group in supports.held for v in group.points}
    found |= {int(v): True for v in problem.layout.fans.ends}
    for group in supports.held:
        held[group.line] = True
        turned[group.edges] = True
    boundary = mesh.boundary_edges
    kinds = np.stack([held[boundary], turned[boundary]], axis=1).astype(float)
    both = np.zeros((2, len(mesh.points), 2))  # the sum, and the number, over the edges at each vertex
    for ends in mesh.edges[boundary].T:
        np.add.at(both[0], ends, kinds)
        np.add.at(both[1], ends, 1.0)
    mean = both[0] / np.maximum(both[1], 1.0)
    mixed = ((mean > 0.0) & (mean < 1.0)).any(axis=1)
    simple = (mean == [1.0, 0.0]).all(axis=1)
    angles = problem.corner_angles
    for v in np.flatnonzero(mixed).tolist():
        found[v] = found.get(v, False) or angles.get(v, np.pi) > HARMLESS
    for v, angle in angles.items():
        if angle > (RIGHT if simple[v] else STRAIGHT):
            found[v] = True
    vertices = np.array(sorted(found), dtype=np.int64)
    return vertices, np.array([found[v] for v in vertices.tolist()], dtype=bool)
