"""Area, angle defect and cotangent mean curvature at the vertices of a mesh.

They use the vertices only (not the mid-edge nodes of order 2). Where they converge is known and narrow:
the angle defect over the barycentric area tends to K only at regular vertices of valence 6 (Borrelli,
Cazals & Morvan 2003), and the area itself only where the normals converge (the Schwarz lantern's do not).
Pointwise convergence on any mesh is what `principal` is for; the sums are right on any mesh.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from kshell.errors import InputError
from kshell.geometry.components import Floats
from kshell.geometry.discrete.topology import (
    at_vertices,
    boundary_vertices,
    corner_angles,
    corner_cotangents,
    edge_vectors,
    require_closed,
    require_surface,
    vertex_normals,
)
from kshell.mesh.mesh import Mesh

AreaKind = Literal["mixed", "voronoi", "barycentric"]


def area(mesh: Mesh) -> float:
    """Sum of the areas of the flat triangles."""
    return float(mesh.areas.sum())


def volume(mesh: Mesh) -> float:
    """Volume inside a closed mesh, positive if the normals point outward.

    Raises
    ------
    InputError
        If the mesh is not a closed oriented surface; the message says where.
    """
    require_surface(mesh)
    require_closed(mesh, "a volume")
    x = (mesh.points - mesh.points.mean(axis=0))[mesh.triangles]
    return float(np.sum(x[:, 0] * np.cross(x[:, 1], x[:, 2])) / 6.0)


def vertex_areas(mesh: Mesh, kind: AreaKind = "mixed") -> Floats:
    """(vertex,) the part of the area that belongs to each vertex.

    Parameters
    ----------
    mesh : Mesh
    kind : {"mixed", "voronoi", "barycentric"}
        Voronoi cells, except in obtuse triangles, where the obtuse corner takes half and the others a
        quarter (Meyer, Desbrun, Schroeder & Barr 2003); Voronoi cells throughout, which may be negative;
        or a third of each triangle.
    """
    require_surface(mesh)
    if kind == "barycentric":
        return at_vertices(mesh, np.repeat(mesh.areas[:, None] / 3.0, 3, axis=1))
    if kind not in ("mixed", "voronoi"):
        raise InputError(f'kind = "{kind}" must be mixed, voronoi or barycentric')
    cot = corner_cotangents(mesh)
    weighted = np.sum(edge_vectors(mesh) ** 2, axis=2) * cot  # |side opposite k|^2 cot(angle k)
    # corner k gets an eighth of the terms of the two sides that meet in it
    share = (np.roll(weighted, -1, axis=1) + np.roll(weighted, -2, axis=1)) / 8.0
    if kind == "mixed":
        obtuse = cot < 0.0
        mixed = mesh.areas[:, None] * np.where(obtuse, 0.5, 0.25)
        share = np.where(obtuse.any(axis=1, keepdims=True), mixed, share)
    return at_vertices(mesh, share)


def angle_defect(mesh: Mesh) -> Floats:
    """(vertex,) 2 pi minus the sum of the angles, at a boundary vertex pi minus it (its turning angle)."""
    require_surface(mesh)
    whole = np.where(boundary_vertices(mesh), np.pi, 2.0 * np.pi)
    return whole - at_vertices(mesh, corner_angles(mesh))


def total_curvature(mesh: Mesh) -> float:
    """Sum of the angle defects: 2 pi times the Euler characteristic, on any mesh (Gauss-Bonnet)."""
    return float(angle_defect(mesh).sum())


def gaussian_curvature(mesh: Mesh, kind: AreaKind = "mixed") -> Floats:
    """(vertex,) angle defect over vertex area; NaN at boundary vertices, where it is not defined.

    Parameters
    ----------
    mesh : Mesh
    kind : {"mixed", "voronoi", "barycentric"}
        See `vertex_areas`.

    Raises
    ------
    InputError
        If the mesh is no oriented surface of proper triangles; the message says where.
    """
    return np.where(boundary_vertices(mesh), np.nan, angle_defect(mesh) / vertex_areas(mesh, kind))


def mean_curvature_vector(mesh: Mesh, kind: AreaKind = "mixed") -> Floats:
    """(vertex, 3) 2 H N, the cotangent Laplacian of the position; NaN at boundary vertices.

    At vertex i: sum over neighbours j of (cot a_ij + cot b_ij) (x_j - x_i) / (2 area_i), with a and b the
    angles opposite the edge (Pinkall & Polthier 1993).
    """
    require_surface(mesh)
    half_cot = 0.5 * corner_cotangents(mesh)[..., None]
    pull = half_cot * edge_vectors(mesh)  # side k runs from corner k + 1 to corner k + 2
    total = at_vertices(mesh, np.roll(pull, 1, axis=1) - np.roll(pull, 2, axis=1))
    total = total / vertex_areas(mesh, kind)[:, None]
    total[boundary_vertices(mesh)] = np.nan
    return total


def mean_curvature(mesh: Mesh, kind: AreaKind = "mixed") -> Floats:
    """(vertex,) H: half of `mean_curvature_vector` along the vertex normal; NaN at boundary vertices."""
    return 0.5 * np.sum(mean_curvature_vector(mesh, kind) * vertex_normals(mesh), axis=1)
