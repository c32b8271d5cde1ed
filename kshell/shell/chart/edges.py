"""What conditions along straight edges of the parameter plane need: directions, derivatives along and across.

Symbols
-------
T          direction of the edge in the parameter plane, d/dT = T^a d/dx^a
n          normal of the surface
m^a        direction in the parameter plane across the edge: at right angles to it on the surface
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.mesh.mesh import Mesh
from kshell.shell.chart.surface import ChartLike, ChartSurface
from kshell.shell.evaluate import OfPlace

Floats = NDArray[np.float64]

# positions of the second derivatives uu, uv, vv among the unknowns of a vertex
SECOND = np.array([[3, 4], [4, 5]])


def vertex_sizes(mesh: Mesh) -> Floats:
    """(vertex,) mean length of the edges at each vertex."""
    total = np.bincount(mesh.edges.ravel(), np.repeat(mesh.edge_lengths, 2), len(mesh.points))
    return np.asarray(total / np.bincount(mesh.edges.ravel(), minlength=len(mesh.points)))


def edge_ends(surface: ChartSurface, edges: ArrayLike) -> list[tuple[NDArray, NDArray, Floats]]:
    """For both ends of edges, on both sides of lines: vertices, their fans there, and the directions T."""
    mesh, nodes = surface.mesh, surface.nodes
    edges = np.atleast_1d(np.asarray(edges, dtype=np.int64))
    ends = mesh.edges[edges]
    t = mesh.points[ends[:, 1], :2] - mesh.points[ends[:, 0], :2]
    t = t / np.linalg.norm(t, axis=1, keepdims=True)
    first, second = nodes.fans_at(edges, 0), nodes.fans_at(edges, 1)
    out = []
    for end in range(2):
        out.append((ends[:, end], first[:, end], t))
        other = np.flatnonzero(first[:, end] != second[:, end])
        if len(other):
            out.append((ends[other, end], second[other, end], t[other]))
    return out


def across(chart: ChartLike, uv: Floats, t: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """n, dn/dT, m, dm/dT, and the unit conormal, at parameters (n, 2) of edges with directions t (n, 2).

    m^1 = -A_2b T^b, m^2 = A_1b T^b with the first fundamental form A, so m and T are at right angles.
    """
    _, x_a, x_ab = chart.derivatives(uv[:, 0], uv[:, 1], order=2)
    x_t = np.einsum("nax,na->nx", x_a, t)
    x_at = np.einsum("nabx,nb->nax", x_ab, t)
    x_tt = np.einsum("nax,na->nx", x_at, t)
    lowered = np.einsum("nax,nx->na", x_a, x_t)
    lowered_t = np.einsum("nax,nx->na", x_at, x_t) + np.einsum("nax,nx->na", x_a, x_tt)
    m = np.stack([-lowered[:, 1], lowered[:, 0]], axis=1)
    m_t = np.stack([-lowered_t[:, 1], lowered_t[:, 0]], axis=1)
    normal = np.cross(x_a[:, 0], x_a[:, 1])
    area = np.linalg.norm(normal, axis=1, keepdims=True)
    n = normal / area
    n_t = (np.cross(x_at[:, 0], x_a[:, 1]) + np.cross(x_a[:, 0], x_at[:, 1])) / area
    n_t -= n * np.sum(n * n_t, axis=1, keepdims=True)
    conormal = np.einsum("nax,na->nx", x_a, m)
    return n, n_t, m, m_t, conormal / np.linalg.norm(conormal, axis=1, keepdims=True)


def main_conormal(surface: ChartSurface, edges: ArrayLike) -> Floats:
    """(3,) the unit direction in the surface across edges, in the mean."""
    mesh = surface.mesh
    conormals = np.concatenate(
        [across(surface.chart, mesh.points[v, :2], t)[4] for v, _, t in edge_ends(surface, edges)]
    )
    return np.linalg.svd(conormals, full_matrices=False)[2][0]


def coefficients_along(t: Floats) -> list[Floats]:
    """Coefficients (n, 6) of u, u,T and u,TT in the degrees of freedom of a vertex."""
    value, first, second = np.zeros((3, len(t), 6))
    value[:, 0] = 1.0
    first[:, 1:3] = t
    second[:, 3], second[:, 4], second[:, 5] = t[:, 0] ** 2, 2 * t[:, 0] * t[:, 1], t[:, 1] ** 2
    return [value, first, second]


def coefficients_across(t: Floats, m: Floats, m_t: Floats, c: Floats, c_t: Floats) -> list[Floats]:
    """Coefficients (n, 6, 3) of c . u,m and its derivative along the edge; c (n, 3) has the derivative c_t."""
    rate, slope = np.zeros((2, len(t), 6, 3))
    rate[:, 1:3] = m[:, :, None] * c[:, None]
    slope[:, 1:3] = m[:, :, None] * c_t[:, None] + m_t[:, :, None] * c[:, None]
    for a in range(2):
        for b in range(2):
            slope[:, SECOND[a, b]] += (m[:, a] * t[:, b])[:, None] * c
    return [rate, slope]


def along_edge(
    surface: ChartSurface, vertices: NDArray, t: Floats, step: Floats, value: OfPlace
) -> list[Floats]:
    """`value` of the places, its d/dT and d2/dT2 at vertices, by central differences of order 6 with steps (n,)."""
    offsets = step[:, None] * np.arange(-3, 4)  # (vertex, 7)
    uv = surface.mesh.points[vertices, None, :2] + offsets[..., None] * t[:, None]
    x = surface.chart.derivatives(uv[..., 0].ravel(), uv[..., 1].ravel(), order=0)[0]
    values = value(x).reshape(len(vertices), 7)
    values_less = values - values[:, 3:4]  # exact zeros for constants
    first = values_less @ np.array([-1, 9, -45, 0, 45, -9, 1]) / 60
    second = values_less @ np.array([2, -27, 270, -490, 270, -27, 2]) / 180
    return [values[:, 3], first / step, second / step**2]
