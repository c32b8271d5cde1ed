"""Curvature measured in balls by normal cycles (Cohen-Steiner & Morvan, SoCG 2003).

For a ball B of radius r around a vertex

    int_B K dA           ->  sum of the angle defects of the vertices in B
    int_B 2 H dA         ->  sum over the edges e of  beta_e |e in B|
    int_B J^T b J dA     ->  sum over the edges e of  beta_e |e in B|  t (x) t

with beta the signed angle between the normals of the two triangles (positive where the surface bends
toward its normal), t the direction of the edge, and J the quarter turn in the tangent plane: an edge
carries curvature across itself. Divided by the area of the surface in B these are means of the curvature.
The error of the measures is of the order of the edge length on meshes whose normals converge, so r must
go to zero more slowly than the edges.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.geometry import principal_axes as axes
from kshell.geometry.components import Floats
from kshell.geometry.discrete.curvature import angle_defect
from kshell.geometry.discrete.fields import VertexCurvature
from kshell.geometry.discrete.topology import boundary_vertices, triangle_normals, vertex_normals
from kshell.mesh.mesh import Mesh

Ints = NDArray[np.int64]

BALLS_AT_ONCE = 4096


@dataclass(frozen=True)
class BallCurvature(VertexCurvature):
    """Mean curvature quantities in balls around the vertices.

    Attributes
    ----------
    defect : (vertex,) array
        Sum of the angle defects in the ball over its area, which measures K. The product of the principal
        curvatures, which come from the edges, is another approximation of K.
    """

    defect: Floats


def normal_cycle(mesh: Mesh, radius: float) -> BallCurvature:
    """Curvature in a ball around each vertex.

    A ball sees every sheet of the surface that it meets: keep the radius below half the distance of sheets.
    Boundary edges and vertices carry no curvature, so balls at the boundary see the part inside.

    Parameters
    ----------
    mesh : Mesh
    radius : float
        A few edge lengths.

    Raises
    ------
    InputError
        If the radius is not positive, or the mesh is no oriented surface.
    """
    if not np.isfinite(radius) or radius <= 0.0:
        raise InputError(f"radius = {radius!r} must be a positive length, a few times the edges")
    normal = vertex_normals(mesh)
    count = len(mesh.points)
    defect = np.where(boundary_vertices(mesh), 0.0, angle_defect(mesh))
    ends = mesh.points[mesh.edges]
    beta, along = _dihedral_angles(mesh), ends[:, 1] - ends[:, 0]
    along /= mesh.edge_lengths[:, None]
    corners = mesh.points[mesh.triangles]

    measure_K, area, tensor = np.zeros(count), np.zeros(count), np.zeros((count, 3, 3))
    for ball, vertex in _pairs(mesh.points, mesh.points[:, None], radius):
        measure_K += np.bincount(ball, weights=defect[vertex], minlength=count)
    for ball, edge in _pairs(mesh.points, ends, radius):
        inside = _length_in_ball(ends[edge], mesh.points[ball], radius) * beta[edge]
        for i in range(3):
            for j in range(i, 3):
                term = np.bincount(ball, weights=inside * along[edge, i] * along[edge, j], minlength=count)
                tensor[:, i, j] += term
                tensor[:, j, i] = tensor[:, i, j]
    for ball, triangle in _pairs(mesh.points, corners, radius):
        area += np.bincount(
            ball, weights=_area_in_ball(corners[triangle], mesh.points[ball], radius), minlength=count
        )

    e1 = axes.tangent_axis(normal)
    along1, mixed, along2 = axes.projected(tensor / area[:, None, None], e1, np.cross(normal, e1))
    form = [along2, -mixed, along1]  # turned by a quarter: curvature acts across the edges
    return BallCurvature(
        axes.principal_curvatures(form, (count,)),
        axes.principal_directions(form, e1, normal),
        normal,
        area,
        measure_K / area,
    )


def _dihedral_angles(mesh: Mesh) -> Floats:
    """(edge,) angle between the normals of its triangles, zero at the boundary."""
    normal = triangle_normals(mesh)
    ends = mesh.points[mesh.edges]
    along = (ends[:, 1] - ends[:, 0]) / mesh.edge_lengths[:, None]
    # the triangle that walks the edge from its lower to its higher vertex, and the other one
    ahead = mesh.triangles[:, [1, 2, 0]] > mesh.triangles
    first, second = np.full(len(along), -1), np.full(len(along), -1)
    triangle = np.repeat(np.arange(len(normal)), 3).reshape(-1, 3)
    first[mesh.triangle_edges[ahead]] = triangle[ahead]
    second[mesh.triangle_edges[~ahead]] = triangle[~ahead]
    a, b = normal[first], normal[second]
    turn = -np.arctan2(np.sum(np.cross(a, b) * along, axis=1), np.sum(a * b, axis=1))
    return np.where(mesh.edge_counts == 2, turn, 0.0)


def _pairs(centres: Floats, cells: Floats, radius: float) -> Iterator[tuple[Ints, Ints]]:
    """Pairs (ball, cell) that may meet, in portions; cells are (n, corners, 3)."""
    from scipy.spatial import KDTree

    middle = cells.mean(axis=1)
    reach = float(np.linalg.norm(cells - middle[:, None], axis=2).max())
    tree = KDTree(middle)
    within = radius if cells.shape[1] == 1 else radius + reach
    for start in range(0, len(centres), BALLS_AT_ONCE):
        balls = KDTree(centres[start : start + BALLS_AT_ONCE])
        found = balls.sparse_distance_matrix(tree, within, output_type="ndarray")
        yield found["i"] + start, found["j"]


def _clip(p: Floats, along: Floats, square: Floats | float) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Where the segment p + t along, t in [0, 1], is within the distance sqrt(square) of the origin."""
    a = np.sum(along * along, axis=-1)
    b = np.sum(p * along, axis=-1)
    c = np.sum(p * p, axis=-1) - square
    root = np.sqrt(np.maximum(b * b - a * c, 0.0))
    low, high = np.clip((-b - root) / a, 0.0, 1.0), np.clip((-b + root) / a, 0.0, 1.0)
    return low, high, (b * b > a * c) & (high > low)


def _length_in_ball(ends: Floats, centre: Floats, radius: float) -> Floats:
    """(pair,) length of the segment inside the ball."""
    along = ends[:, 1] - ends[:, 0]
    low, high, meets = _clip(ends[:, 0] - centre, along, radius**2)
    return np.where(meets, (high - low) * np.linalg.norm(along, axis=1), 0.0)


def _area_in_ball(corners: Floats, centre: Floats, radius: float) -> Floats:
    """(pair,) area of the triangle inside the ball.

    The plane cuts a disc out of the ball. Seen from its centre each side p q of the triangle adds, with the
    sign of its turn, the sector from p to where it enters, the triangle over the chord, and the sector from
    where it leaves to q.
    """
    x = corners - centre[:, None]
    normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    height = np.sum(x[:, 0] * normal, axis=1)
    square = np.maximum(radius**2 - height**2, 0.0)
    e1 = (x[:, 1] - x[:, 0]) / np.linalg.norm(x[:, 1] - x[:, 0], axis=1, keepdims=True)
    frame = np.stack([e1, np.cross(normal, e1)], axis=1)
    flat = np.einsum("nci,nki->nck", x, frame)  # (pair, corner, 2) about the centre of the disc

    total = np.zeros(len(x))
    for k in range(3):
        p, q = flat[:, k], flat[:, (k + 1) % 3]
        low, high, meets = _clip(p, q - p, square)
        enter, leave = p + low[:, None] * (q - p), p + high[:, None] * (q - p)
        through = _sector(p, enter, square) + 0.5 * _turn(enter, leave) + _sector(leave, q, square)
        total += np.where(meets, through, _sector(p, q, square))
    return np.maximum(total, 0.0)


def _turn(p: Floats, q: Floats) -> Floats:
    return p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]


def _sector(p: Floats, q: Floats, square: Floats) -> Floats:
    return 0.5 * square * np.arctan2(_turn(p, q), np.sum(p * q, axis=1))
