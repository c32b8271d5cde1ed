"""Results as .vtu files for ParaView.

Point data have the names of `Result.fields`, columns have names too; tensors in the plane have the columns xx yy xy.
Title, units, case, analysis, model, frame and version are the names of field data, which ParaView lists ("case: snow"),
and stand in a comment in the head; the time or load factor of a state is the field TimeValue. Every group
is an array "group NAME" of zeros and ones, of points for curve and point groups, of cells for surfaces; of a curve
"edges of group NAME" tells which edges of each triangle are in it: 1 + 2 + 4 for those of its corners 01, 12 and 02.
Where sheets or sections meet there is a point for each row of the fields, at the same place; `vertex` and `patch` tell
them apart, `vertex` is -1 at mid-edge nodes. A comment in the head says how values at vertices are made.
Triangles of order 2 are written with their mid-edge nodes: there the displacement of a shell is that of the
solution, of a plate it follows from values and slopes at the edge's ends (cubic Hermite); the other fields are the
mean of the ends.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kshell.errors import SolveError
from kshell.mesh.mesh import Mesh
from kshell.result.vtu_file import Unstructured, write_triangles
from kshell.version import __version__

if TYPE_CHECKING:
    from kshell.result.result import Result
    from kshell.result.rows import Rows

Floats = NDArray[np.float64]

GROUP, EDGES_OF = "group ", "edges of group "
SPACE, PLANE = ("x", "y", "z"), ("xx", "yy", "xy")
ENVELOPE = re.compile("^(min|max)_(case_)?")
COLUMNS = {
    **dict.fromkeys(("displacement", "rotation", "frame_axis_1", "normal"), SPACE),
    **dict.fromkeys(
        (
            "moment",
            "membrane_force",
            "membrane_stress_resultant",
            "stress_top",
            "stress_middle",
            "stress_bottom",
        ),
        PLANE,
    ),
    "shear": ("x", "y"),
    **dict.fromkeys(("principal_moments", "principal_forces"), ("larger", "smaller")),
}


def facts(result: Result, case: str = "") -> list[str]:
    """What the values are of, in words: "title: Steel plate"."""
    model = result.model
    what = f"{model.get('kind', '')} {model.get('element', '')} of order {model.get('order', '')}"
    parts = {
        "title": result.title,
        "units": result.units,
        "case": case or result.case or "",
        "analysis": result.analysis,
        "model": what.strip(),
        "frame of tensors": result.frame,
        "values at vertices": result.nodal_values,
        "kshell": __version__,
    }
    return [f"{key}: {value}" for key, value in parts.items() if value]


def head(result: Result, case: str = "") -> str:
    """All of that in one line."""
    return "; ".join(facts(result, case))


def write_vtu(
    path: Path, result: Result, time: float | None = None, case: str = "", whole: Result | None = None
) -> None:
    """Write the mesh, fields and groups of a result.

    Parameters
    ----------
    time : float, optional
        Of a state its time or load factor.
    case : str
        What else than the name of its case the result is called.
    whole : Result, optional
        What a state is of, which knows the analysis and the model.

    Raises
    ------
    SolveError
        If a field has a value that is NaN or infinite.
    """
    of = result if whole is None else whole
    write_triangles(path, unstructured(result), head(of, case), facts(of, case), time)


def unstructured(result: Result) -> Unstructured:
    """Mesh, fields and groups of a result, as files have them.

    Raises
    ------
    SolveError
        If a field has a value that is NaN or infinite.
    """
    mesh = result.mesh
    for name, values in {**result.fields, **result.cell_fields}.items():
        if not np.isfinite(values).all():
            raise SolveError(f"the result is not usable: the field {name} has values that are not finite")
    rows = result.rows
    points, cells = rows.nodes, rows.cells
    point_data: dict[str, NDArray[np.generic]] = {
        name: at_nodes(rows, name, values, result.fields, result.edge_fields)
        for name, values in result.fields.items()
    }
    if rows.extra:
        for name, numbers in (("vertex", rows.vertex), ("patch", rows.patch)):
            ends = (
                rows.patch[rows.middle_ends[:, 1]] if name == "patch" else np.full(len(rows.middle_edge), -1)
            )
            beyond = ends[: len(points) - len(numbers)]
            point_data[name] = np.concatenate([numbers, beyond]).astype(np.int32)
    cell_data: dict[str, NDArray[np.generic]] = dict(result.cell_fields)
    for name, group in mesh.groups.items():
        if group.dimension == 2:
            marked = np.zeros(len(mesh.triangles), dtype=np.int32)
            marked[group.members] = 1
            cell_data[f"{GROUP}{name}"] = marked
        else:
            marked = np.zeros(len(points), dtype=np.int32)
            marked[_nodes_of(rows, group.dimension, group.members)] = 1
            point_data[f"{GROUP}{name}"] = marked
        if group.dimension == 1:
            bits = np.isin(mesh.triangle_edges, group.members) @ np.array([1, 2, 4], dtype=np.int32)
            cell_data[f"{EDGES_OF}{name}"] = bits.astype(np.int32)
    columns = {name: _columns(name) for name in {**point_data, **cell_data}}
    return Unstructured(points, cells, point_data, cell_data, columns)


def _columns(name: str) -> tuple[str, ...]:
    """Names of the columns of a field, or of its envelope."""
    if name.startswith("mode_"):
        return SPACE
    return COLUMNS.get(ENVELOPE.sub("", name), ())


def write_motion(path: Path, mesh: Mesh, displacement: Floats) -> None:
    """Write the mesh with one displacement (vertex, 3), for animations."""
    write_triangles(path, Unstructured(mesh.points, mesh.triangles, {"displacement": displacement}, {}))


def _nodes_of(rows: Rows, dimension: int, members: NDArray[np.int32]) -> NDArray[np.integer]:
    """Rows, and mid-edge nodes, of points or edges."""
    mesh = rows.mesh
    at = members if dimension == 0 else mesh.edges[members].ravel()
    nodes = [np.flatnonzero(np.isin(rows.vertex, at))]
    if dimension == 1 and mesh.midpoints is not None:
        nodes.append(np.flatnonzero(np.isin(rows.middle_edge, members)) + len(rows.vertex))
    return np.concatenate(nodes)


def at_nodes(
    rows: Rows,
    name: str,
    values: Floats,
    fields: Mapping[str, Floats],
    edge_fields: Mapping[str, Floats] | None = None,
) -> Floats:
    """Values at rows, and at mid-edge nodes where the mesh has them: `Rows.nodes`."""
    mesh = rows.mesh
    if mesh.midpoints is None:
        return np.ascontiguousarray(values)
    if edge_fields and name in edge_fields:
        return np.concatenate([values, edge_fields[name][rows.middle_edge]])
    start, end = rows.middle_ends.T
    if values.dtype.kind == "i":  # numbers of cases have no mean
        return np.concatenate([values, values[start]])
    middle = 0.5 * (values[start] + values[end])
    if name == "displacement" and "rotation" in fields:
        rotation = fields["rotation"]  # (w_y, -w_x, 0)
        slope = np.stack([-rotation[:, 1], rotation[:, 0]], axis=1)
        chord = (rows.points[end] - rows.points[start])[:, :2]
        middles = mesh.midpoints[rows.middle_edge, :2]
        aside = middles - 0.5 * (rows.points[start] + rows.points[end])[:, :2]
        middle[:, 2] += np.sum((slope[start] - slope[end]) * chord, axis=1) / 8.0
        middle[:, 2] += 0.5 * np.sum((slope[start] + slope[end]) * aside, axis=1)
    return np.concatenate([values, middle])
