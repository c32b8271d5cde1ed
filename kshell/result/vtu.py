"""Results as .vtu files for ParaView, written through meshio.

Point data have the names of `Result.fields`; tensors in the plane have the columns xx yy xy. Every group
is an array "group NAME" of zeros and ones, of points for curve and point groups, of cells for surfaces.
Triangles of order 2 are written with their mid-edge nodes: there the displacement of a shell is that of the
solution, of a plate it follows from values and slopes at the edge's ends (cubic Hermite); the other fields are the
mean of the ends.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kshell.errors import SolveError
from kshell.mesh.mesh import Mesh

if TYPE_CHECKING:
    from kshell.result.result import Result

Floats = NDArray[np.float64]


def write_vtu(path: Path, result: Result) -> None:
    """Write the mesh, fields and groups of a result.

    Raises
    ------
    SolveError
        If a field has a value that is NaN or infinite.
    """
    import meshio

    mesh = result.mesh
    for name, values in {**result.fields, **result.cell_fields}.items():
        if not np.isfinite(values).all():
            raise SolveError(f"the result is not usable: the field {name} has values that are not finite")
    points, cells, kind = mesh.points, mesh.triangles, "triangle"
    if mesh.midpoints is not None:
        points = np.concatenate([mesh.points, mesh.midpoints])
        edges = mesh.triangle_edges[:, [0, 1, 2]] + len(mesh.points)  # nodes on (0, 1), (1, 2), (0, 2)
        cells, kind = np.concatenate([mesh.triangles, edges], axis=1), "triangle6"
    point_data: dict[str, NDArray[np.generic]] = {
        name: at_nodes(mesh, name, values, result.fields, result.edge_fields)
        for name, values in result.fields.items()
    }
    cell_data: dict[str, list[NDArray[np.generic]]] = {
        name: [np.ascontiguousarray(values)] for name, values in result.cell_fields.items()
    }
    for name, group in mesh.groups.items():
        if group.dimension == 2:
            marked = np.zeros(len(mesh.triangles), dtype=np.int32)
            marked[group.members] = 1
            cell_data[f"group {name}"] = [marked]
        else:
            marked = np.zeros(len(points), dtype=np.int32)
            marked[_nodes_of(mesh, group.dimension, group.members)] = 1
            point_data[f"group {name}"] = marked
    meshio.write(path, meshio.Mesh(points, [(kind, cells)], point_data, cell_data), file_format="vtu")


def write_motion(path: Path, mesh: Mesh, displacement: Floats) -> None:
    """Write the mesh with one displacement (vertex, 3), for animations."""
    import meshio

    data = {"displacement": np.ascontiguousarray(displacement)}
    cells = [("triangle", mesh.triangles)]
    meshio.write(path, meshio.Mesh(mesh.points, cells, data), file_format="vtu")


def _nodes_of(mesh: Mesh, dimension: int, members: NDArray[np.int32]) -> NDArray[np.int32]:
    if dimension == 0:
        return members
    nodes = [mesh.edges[members].ravel()]
    if mesh.midpoints is not None:
        nodes.append(members + len(mesh.points))
    return np.concatenate(nodes)


def at_nodes(
    mesh: Mesh,
    name: str,
    values: Floats,
    fields: Mapping[str, Floats],
    edge_fields: Mapping[str, Floats] | None = None,
) -> Floats:
    """Values at vertices, and at mid-edge nodes where the mesh has them."""
    if mesh.midpoints is None:
        return np.ascontiguousarray(values)
    if edge_fields and name in edge_fields:
        return np.concatenate([values, edge_fields[name]])
    start, end = mesh.edges.T
    if values.dtype.kind == "i":  # numbers of cases have no mean
        return np.concatenate([values, values[start]])
    middle = 0.5 * (values[start] + values[end])
    if name == "displacement" and "rotation" in fields:
        rotation = fields["rotation"]  # (w_y, -w_x, 0)
        slope = np.stack([-rotation[:, 1], rotation[:, 0]], axis=1)
        chord = (mesh.points[end] - mesh.points[start])[:, :2]
        aside = mesh.midpoints[:, :2] - 0.5 * (mesh.points[start] + mesh.points[end])[:, :2]
        middle[:, 2] += np.sum((slope[start] - slope[end]) * chord, axis=1) / 8.0
        middle[:, 2] += 0.5 * np.sum((slope[start] + slope[end]) * aside, axis=1)
    return np.concatenate([values, middle])
