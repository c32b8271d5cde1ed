"""Principal curvatures and directions at vertices from a polynomial fitted to the neighbours.

Around each vertex the surface is the graph z = f(x, y) over a tangent plane, f a polynomial of degree n
without constant term fitted by least squares to the vertices within some rings ("osculating jets", Cazals
& Pouget 2005). Curvature has an error of order h^(n-1) on any mesh of shape-regular triangles.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.geometry import principal_axes as axes
from kshell.geometry.components import Floats
from kshell.geometry.discrete.curvature import vertex_areas
from kshell.geometry.discrete.fields import VertexCurvature
from kshell.geometry.discrete.topology import vertex_normals
from kshell.mesh.mesh import Mesh

Ints = NDArray[np.int64]

VERTICES_AT_ONCE = 8192
WORST_CONDITION = 1e9  # of the normal equations; beyond it the neighbours do not fix the polynomial
NEIGHBOURS = 1.8  # per coefficient; with fewer, as at a boundary, the fit follows the higher terms instead
MOST_MORE_RINGS = 3


def principal(mesh: Mesh, degree: int = 3, rings: int | None = None) -> VertexCurvature:
    """Principal curvatures and directions at each vertex, at the boundary too.

    Parameters
    ----------
    mesh : Mesh
        Only vertices are used, not the mid-edge nodes of order 2.
    degree : {2, 3, 4}
        Of the polynomial. Where noise matters more than convergence take 2 with more rings.
    rings : int, optional
        Of neighbours; `degree - 1`, at least 2, if left out. A vertex with fewer than 1.8 neighbours per
        coefficient of the polynomial, as on the boundary, gets up to three more.

    Raises
    ------
    InputError
        If the mesh is no oriented surface, or too small for the fit; the message says where.
    """
    if degree not in (2, 3, 4):
        raise InputError(f"degree = {degree!r} must be 2, 3 or 4")
    rings = max(2, degree - 1) if rings is None else rings
    if not isinstance(rings, (int, np.integer)) or rings < 1:
        raise InputError(f"rings = {rings!r} must be a whole number, at least 1")
    normal = vertex_normals(mesh)
    e1 = axes.tangent_axis(normal)
    e2 = np.cross(normal, e1)
    count = len(mesh.points)
    slope, hessian = np.zeros((count, 2)), np.zeros((count, 3))
    pending = np.arange(count)
    for more in range(MOST_MORE_RINGS + 1):
        reach = _neighbours(mesh, rings + more)
        failed = []
        for start in range(0, len(pending), VERTICES_AT_ONCE):
            some = pending[start : start + VERTICES_AT_ONCE]
            fit, good, crowd = _fit(
                mesh.points, some, reach, np.stack([e1, e2, normal], axis=1)[some], degree
            )
            if more < MOST_MORE_RINGS:
                good &= crowd
            slope[some[good]], hessian[some[good]] = fit[good, :2], fit[good, 2:]
            failed.append(some[~good])
        pending = np.concatenate(failed)
        if not len(pending):
            break
    else:
        where = ", ".join(f"{c:.6g}" for c in mesh.points[pending[0]])
        raise InputError(
            f"{mesh.source}: the neighbours of {len(pending)} vertices, one at ({where}), do not fix a "
            f"polynomial of degree {degree}: the mesh is too coarse; refine it or take a lower degree"
        )
    return _of_graph(slope, hessian, e1, e2, normal, vertex_areas(mesh))


def _neighbours(mesh: Mesh, rings: int) -> tuple[Ints, Ints]:
    """Start of each row and columns: the vertices within `rings` edges of each vertex, without itself."""
    from scipy.sparse import coo_array, eye_array

    n = len(mesh.points)
    a, b = mesh.edges.T.astype(np.int64)
    ones = np.ones(2 * len(a), dtype=np.int32)
    step = coo_array((ones, (np.concatenate([a, b]), np.concatenate([b, a]))), shape=(n, n)).tocsr()
    reach = step + eye_array(n, dtype=np.int32, format="csr")
    step = reach
    for _ in range(rings - 1):
        reach = (reach @ step).tocsr()
        reach.data[:] = 1
    reach = (reach - eye_array(n, dtype=np.int32, format="csr")).tocsr()
    reach.eliminate_zeros()
    return reach.indptr.astype(np.int64), reach.indices.astype(np.int64)


def _fit(
    points: Floats, some: Ints, reach: tuple[Ints, Ints], frame: Floats, degree: int
) -> tuple[Floats, NDArray[np.bool_], NDArray[np.bool_]]:
    """Slopes f_x, f_y, f_xx, f_xy, f_yy (vertex, 5); which fits are sound; which have many neighbours."""
    start, column = reach
    counts = start[some + 1] - start[some]
    first = np.concatenate([[0], np.cumsum(counts)[:-1]])
    owner = np.repeat(np.arange(len(some)), counts)
    other = column[np.repeat(start[some] - first, counts) + np.arange(counts.sum())]
    local = np.einsum("nij,nj->ni", frame[owner], points[other] - points[some][owner])
    size = np.sqrt(np.add.reduceat(np.sum(local**2, axis=1), first) / counts)
    x, y, z = (local / size[owner, None]).T

    powers = [(i, n - i) for n in range(1, degree + 1) for i in range(n, -1, -1)]
    terms = np.stack([x**i * y**j for i, j in powers], axis=1)
    matrix = np.add.reduceat(terms[:, :, None] * terms[:, None, :], first, axis=0)
    right = np.add.reduceat(terms * z[:, None], first, axis=0)
    eigenvalues = np.linalg.eigvalsh(matrix)
    good = eigenvalues[:, 0] * WORST_CONDITION > eigenvalues[:, -1]
    matrix[~good] = np.eye(len(powers))
    c = np.linalg.solve(matrix, right[..., None])[..., 0]
    at = {power: k for k, power in enumerate(powers)}
    second = np.stack([2.0 * c[:, at[2, 0]], c[:, at[1, 1]], 2.0 * c[:, at[0, 2]]], axis=1) / size[:, None]
    return (
        np.concatenate([c[:, [at[1, 0], at[0, 1]]], second], axis=1),
        good,
        counts >= NEIGHBOURS * len(powers),
    )


def _of_graph(
    slope: Floats, hessian: Floats, e1: Floats, e2: Floats, normal: Floats, area: Floats
) -> VertexCurvature:
    """Curvature of the graph z = f(x, y) in the frame e1, e2, normal at the origin."""
    p, q = slope.T
    tilt = np.sqrt(1.0 + p**2 + q**2)  # area element
    form = axes.in_orthonormal_basis([1.0 + p**2, p * q, 1.0 + q**2], list(hessian.T / tilt), tilt)
    along = e1 + p[:, None] * normal
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    new_normal = (normal - p[:, None] * e1 - q[:, None] * e2) / tilt[:, None]
    k = axes.principal_curvatures(form, (len(p),))
    return VertexCurvature(k, axes.principal_directions(form, along, new_normal), new_normal, area)
