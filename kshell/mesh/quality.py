"""What is in a mesh: counts, sizes of the groups, shape of the triangles, with the places of the worst."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.mesh import quadratic
from kshell.mesh.triangulation import Triangulation

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class GroupSummary:
    """One group: its kind, how many cells it has, its length or area (0 for points), and the box it lies in."""

    name: str
    kind: str
    members: int
    measure: float
    lower: tuple[float, ...]
    upper: tuple[float, ...]


@dataclass(frozen=True)
class Summary:
    """Counts and sizes. Lengths and areas follow the curved edges of a mesh of order 2."""

    source: str
    order: int
    vertices: int
    edges: int
    triangles: int
    area: float
    boundary_length: float
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    groups: tuple[GroupSummary, ...]
    notes: tuple[str, ...]


@dataclass(frozen=True)
class Quality:
    """Shape of the flat triangles between the vertices, and where the worst ones lie.

    Attributes
    ----------
    min_angle : float
        Smallest angle of all triangles, degrees; 60 at best.
    min_angle_at : (3,) tuple
    max_aspect : float
        Largest ratio of circumradius to twice the inradius; 1 at best.
    max_aspect_at : (3,) tuple
    shortest_edge, longest_edge : float
    shortest_edge_at, longest_edge_at : (3,) tuple
    """

    min_angle: float
    min_angle_at: tuple[float, ...]
    max_aspect: float
    max_aspect_at: tuple[float, ...]
    shortest_edge: float
    shortest_edge_at: tuple[float, ...]
    longest_edge: float
    longest_edge_at: tuple[float, ...]


def summary(mesh: Triangulation) -> Summary:
    """Counts and sizes of a mesh and its groups."""
    lengths, areas = edge_lengths(mesh), triangle_areas(mesh)
    measures = (np.zeros(len(mesh.points)), lengths, areas)  # by dimension
    groups = [
        GroupSummary(
            name,
            group.kind,
            len(group.members),
            float(measures[group.dimension][group.members].sum()),
            *_box(mesh, group.dimension, group.members),
        )
        for name, group in mesh.groups.items()
    ]
    return Summary(
        source=mesh.source,
        order=mesh.order,
        vertices=len(mesh.points),
        edges=len(mesh.edges),
        triangles=len(mesh.triangles),
        area=float(areas.sum()),
        boundary_length=float(lengths[mesh.boundary_edges].sum()),
        lower=tuple(mesh.points.min(axis=0).tolist()),
        upper=tuple(mesh.points.max(axis=0).tolist()),
        groups=tuple(groups),
        notes=mesh.notes,
    )


def _box(
    mesh: Triangulation, dimension: int, members: NDArray[np.integer]
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Corners of the box of the vertices of cells."""
    vertices = members if dimension == 0 else (mesh.edges if dimension == 1 else mesh.triangles)[members]
    x = mesh.points[vertices.ravel()]
    if not len(x):
        return (), ()
    return tuple(x.min(axis=0).tolist()), tuple(x.max(axis=0).tolist())


def quality(mesh: Triangulation) -> Quality:
    """Shape of the triangles, with the places of the worst."""
    corners = mesh.points[mesh.triangles]  # (triangle, corner, 3)
    middle = corners.mean(axis=1)
    a, b, c = np.linalg.norm(corners[:, [1, 2, 0]] - corners[:, [2, 0, 1]], axis=2).T  # opposite each corner
    area = mesh.areas
    # tan(A) = 4 area / (b^2 + c^2 - a^2): good for small angles too
    angles = np.arctan2(4 * area, np.stack([b**2 + c**2 - a**2, c**2 + a**2 - b**2, a**2 + b**2 - c**2]))
    smallest = np.degrees(angles.min(axis=0))
    # circumradius a b c / (4 area), inradius 2 area / (a + b + c)
    aspect = a * b * c * (a + b + c) / (16 * area**2)
    edge_middle = mesh.points[mesh.edges].mean(axis=1)
    length = mesh.edge_lengths
    worst_angle, worst_aspect = int(np.argmin(smallest)), int(np.argmax(aspect))
    short, long = int(np.argmin(length)), int(np.argmax(length))
    return Quality(
        min_angle=float(smallest[worst_angle]),
        min_angle_at=tuple(middle[worst_angle].tolist()),
        max_aspect=float(aspect[worst_aspect]),
        max_aspect_at=tuple(middle[worst_aspect].tolist()),
        shortest_edge=float(length[short]),
        shortest_edge_at=tuple(edge_middle[short].tolist()),
        longest_edge=float(length[long]),
        longest_edge_at=tuple(edge_middle[long].tolist()),
    )


def edge_lengths(mesh: Triangulation) -> Floats:
    """(edge,) length; of the parabola through the mid-edge node where the mesh is of order 2."""
    if mesh.midpoints is None:
        return mesh.edge_lengths
    start, end = mesh.points[mesh.edges[:, 0]], mesh.points[mesh.edges[:, 1]]
    s, weights = np.polynomial.legendre.leggauss(4)
    # x(s) = start s (s-1)/2 + end s (s+1)/2 + middle (1 - s^2), s in [-1, 1]
    tangent = (
        start[:, None] * (s - 0.5)[:, None]
        + end[:, None] * (s + 0.5)[:, None]
        - 2 * mesh.midpoints[:, None] * s[:, None]
    )
    lengths: Floats = np.linalg.norm(tangent, axis=2) @ weights
    return lengths


def triangle_areas(mesh: Triangulation) -> Floats:
    """(triangle,) area, of the curved triangle where the mesh is of order 2."""
    if mesh.midpoints is None:
        return mesh.areas
    nodes = quadratic.node_points(mesh, mesh.midpoints)
    density = np.linalg.norm(quadratic.normals(nodes, quadratic.RULE_POINTS), axis=2)  # (point, triangle)
    areas: Floats = 0.5 * quadratic.RULE_WEIGHTS @ density
    return areas
