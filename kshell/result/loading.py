"""A result read back from the files of `Result.save`."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import fields
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.closest import Locator
from kshell.mesh.mesh import Mesh
from kshell.result.pieces import INDEX, read_pieces
from kshell.result.rows import Rows
from kshell.result.saving import case_stem
from kshell.result.vtu import EDGES_OF, GROUP

if TYPE_CHECKING:
    from kshell.scene.scene import Scene

Floats = NDArray[np.float64]

# field at vertices: what it is called at points
AT_POINTS = {
    "displacement": "u",
    "rotation": "rotation",
    "moment": "M",
    "membrane_force": "N",
    "shear": "Q",
    "stress_top": "stress_top",
    "stress_middle": "stress_middle",
    "stress_bottom": "stress_bottom",
    "frame_axis_1": "axis_1",
    "normal": "normal",
}
# entries of result.json that are arrays in a result, at the probes and of the reactions
WORDS = ("frame",)
# keys of a scene by which its mesh is made
OF_MESH = ("mesh_size", "mesh_order", "geometry", "imperfection", "top_towards")


def load_result(path: str | os.PathLike[str], cls: type[Any]) -> Any:
    """The result in a folder, made of the class of results. See `Result.load`."""
    folder = Path(path)
    document = read_document(folder)
    names = list(document.get("cases", {}))
    parted = document.get("solver", {}).get("processes") is not None
    result = _result(folder / (INDEX if parted else "result.vtu"), document, cls)
    for name in names:
        own = {
            **{key: document[key] for key in ("title", "units") if key in document},
            **document["cases"][name],
        }
        own["mesh"] = document["mesh"]
        result.cases[name] = _result(folder / f"{case_stem(name)}.vtu", own, cls)
        if "combination" in own:
            result.combinations[name] = own["combination"]
    result.case = document.get("case")
    result.scene = _scene(document.get("input"), result.mesh)
    for name, case in result.cases.items():
        case.scene = None if result.scene is None else result.scene.of_case(name)
    return result


def _scene(data: Any, mesh: Mesh) -> Scene | None:
    """The scene of a result on its mesh; None where it is not known, or has functions, which no file holds."""
    from kshell.scene.scene import Scene

    if not isinstance(data, Mapping):
        return None
    # what made the mesh is done, and its files may be gone
    rest = {key: value for key, value in data.items() if key not in OF_MESH}
    try:
        return Scene.from_dict({**rest, "mesh": mesh}, source="result.json")
    except InputError:
        return None


def read_document(folder: Path) -> dict[str, Any]:
    """The content of result.json in a folder.

    Raises
    ------
    InputError
        If there is none, or it is damaged.
    """
    file = folder / "result.json" if folder.is_dir() else folder
    try:
        document = json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(
            f"{file}: no such file: give the folder that result.save(...) or kshell solve -o wrote"
        ) from None
    except (OSError, ValueError) as error:
        raise InputError(f"{file}: cannot be read as a result ({error})") from None
    if not isinstance(document, dict) or "kshell" not in document or "model" not in document:
        raise InputError(f"{file}: is not a result of kshell")
    return document


def _result(file: Path, document: Mapping[str, Any], cls: type[Any]) -> Any:
    rows, point_fields, cell_fields = _read_vtu(file)
    known = {f.name for f in fields(cls)} - {"mesh", "cases", "case", "scene", "series", "fields", "rows"}
    given = {key: value for key, value in document.items() if key in known}
    probes = document.get("probes", {})
    frame = next((values["frame"] for values in probes.values() if "frame" in values), None)
    given["probes"] = {name: _arrays(values) for name, values in probes.items()}
    given["lines"] = {name: _arrays(values) for name, values in document.get("lines", {}).items()}
    given["reactions"] = {name: _arrays(values) for name, values in document.get("reactions", {}).items()}
    if frame is not None:
        given["frame"] = frame
    result = cls(
        mesh=rows.mesh,
        rows=rows,
        fields=point_fields,
        cell_fields=cell_fields,
        unknowns=document["mesh"]["unknowns"],
        **given,
    )
    result.evaluate = partial(_interpolated, result)
    return result


def _arrays(values: Mapping[str, Any]) -> dict[str, Any]:
    return {
        key: np.array(value) if isinstance(value, list) and _all_numbers(value) else value
        for key, value in values.items()
        if key not in WORDS
    }


def _all_numbers(value: Any) -> bool:
    if isinstance(value, list):
        return all(map(_all_numbers, value))
    return isinstance(value, int | float) and not isinstance(value, bool)


def _read_vtu(file: Path) -> tuple[Rows, dict[str, Floats], dict[str, Floats]]:
    """Mesh and rows, fields at rows, and fields of triangles."""
    from xml.etree.ElementTree import ParseError

    from meshio import ReadError, vtu

    try:
        read = read_pieces(file) if file.suffix == ".pvtu" else vtu.read(str(file))
        (block,) = read.cells
    except (OSError, ValueError, KeyError, ParseError, ReadError) as error:
        raise InputError(f"{file}: cannot be read ({error})") from None
    cells = block.data.astype(np.int64)
    corner = cells[:, :3]
    count = int(corner.max(initial=-1)) + 1
    vertex = read.point_data.pop("vertex", np.arange(count))[:count].astype(np.int64)
    patch = read.point_data.pop("patch", np.zeros(count, dtype=np.int64))[:count]
    mesh = _mesh(read, cells, vertex)
    if not np.array_equal(mesh.triangles, vertex[corner]):
        raise InputError(f"{file}: its triangles are not those of a result of kshell")
    at_rows = {name: part[:count] for name, part in read.point_data.items() if not name.startswith(GROUP)}
    of_cells = {
        name: part for name, (part,) in read.cell_data.items() if not name.startswith((GROUP, EDGES_OF))
    }
    return Rows(mesh, corner, vertex, patch[corner[:, 0]]), at_rows, of_cells


def _mesh(read: Any, cells: NDArray[np.int64], vertex: NDArray[np.int64]) -> Mesh:
    """The mesh of a file, from cells of rows and mid-edge nodes, and the vertex of each row."""
    triangles = vertex[cells[:, :3]]
    points = read.points[: int(vertex.max(initial=-1)) + 1]
    groups: dict[str, Any] = {}
    ends = triangles[:, [[0, 1], [1, 2], [0, 2]]]
    for name, (marks,) in read.cell_data.items():
        if name.startswith(EDGES_OF):
            chosen = (marks[:, None] >> np.arange(3)) & 1
            groups[name.removeprefix(EDGES_OF)] = ends[chosen.astype(bool)]
        elif name.startswith(GROUP):
            groups[name.removeprefix(GROUP)] = triangles[marks.astype(bool)]
    for name, marks in read.point_data.items():
        own = name.removeprefix(GROUP)
        if name.startswith(GROUP) and own not in groups:
            groups[own] = np.flatnonzero(marks[: len(points)])
    if cells.shape[1] == 3:
        return Mesh.from_arrays(points, triangles, groups)
    edges = Mesh.from_arrays(points, triangles)
    midpoints = np.zeros((len(edges.edges), 3))
    midpoints[edges.triangle_edges] = read.points[cells[:, 3:]]
    return Mesh.from_arrays(points, triangles, groups, midpoints)


def _interpolated(result: Any, points: Floats) -> dict[str, Floats]:
    """Values between the vertices, linear in each triangle."""
    mesh = result.mesh
    found = Locator.of(mesh).find(points)
    xi = found.xi
    weights = np.column_stack([1.0 - xi.sum(axis=1), xi])
    corners = result.rows.corner[found.triangles]
    out = {"x": found.x, "distance": found.distance}
    for name, key in AT_POINTS.items():
        if name in result.fields:
            out[key] = np.einsum("nc,nck->nk", weights, result.fields[name][corners])
    return out
