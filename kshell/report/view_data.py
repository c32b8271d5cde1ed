"""What the view of a report shows: nodes, triangles, and the fields of every load case, mode or step.

Numbers are 32-bit floats and integers, little endian, as base64 text: what is read from a point of the view has 7
digits. Fields are added in their order until the file would grow beyond MOST_BYTES.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.draw.canvas import flat_triangles
from kshell.draw.drawn import Drawn
from kshell.draw.pictures import MODAL, pictures
from kshell.draw.strokes import spread, strokes_at
from kshell.result.result import Result
from kshell.result.vtu import at_nodes

Floats = NDArray[np.float64]

MOST_BYTES = 6_000_000  # of numbers; a third more as text
MOST_NODES = 40_000  # with more, nodes on edges are left out
MOST_STATES = 24
SHOWN = 0.1  # of the size of the mesh: the largest displacement as drawn at first
FEW_EDGES = 20_000

# fields in the order of their importance: words, names of the components
FIELDS: dict[str, tuple[str, tuple[str, ...]]] = {
    "displacement": ("displacement", ("x", "y", "z")),
    "von_mises_top": ("von Mises stress at the top", ()),
    "von_mises_bottom": ("von Mises stress at the bottom", ()),
    "moment": ("moment M", ("xx", "yy", "xy")),
    "membrane_force": ("membrane force N", ("xx", "yy", "xy")),
    "stress_top": ("stress at the top", ("xx", "yy", "xy")),
    "stress_bottom": ("stress at the bottom", ("xx", "yy", "xy")),
    "shear": ("shear force Q", ("x", "y")),
    "von_mises_middle": ("von Mises stress in the middle", ()),
    "principal_moments": ("principal moment", ("larger", "smaller")),
    "principal_forces": ("principal force", ("larger", "smaller")),
    "stress_middle": ("stress in the middle", ("xx", "yy", "xy")),
    "rotation": ("rotation", ("x", "y", "z")),
}
# pictures of strokes: words
STROKES = {
    "principal_moments": "principal moments, directions",
    "principal_forces": "principal forces, directions",
    "shear": "shear force, directions",
}
THICK = 0.11  # of the distance between places: width of a stroke


def view_data(result: Result) -> dict[str, Any]:
    """Everything the view needs, as numbers and text.

    Returns
    -------
    dict
        nodes (n, 3), triangles (m, 3), lines (k, 2) and outline (k, 2) as base64; size; count of nodes; states: per
        load case, mode or step its name, scale and fields, each of label and columns (n,), and strokes, each of label,
        longest and lines: colour, words and ends (k, 2, 3), sides (k, 3) across and moved (k, 3) one after the other;
        left_out: labels of fields for which the file has no room.
    """
    rows = result.rows
    fine = len(rows.nodes) <= MOST_NODES
    nodes = rows.nodes if fine else rows.nodes[: len(rows.vertex)]
    triangles = flat_triangles(result.mesh, rows)[1] if fine else rows.cells[:, :3]
    lines, outline = _lines(triangles)
    states, left_out = _states(result, len(nodes))
    return {
        "nodes": _text(nodes, "<f4"),
        "triangles": _text(triangles, "<u4"),
        "lines": _text(lines if len(lines) <= FEW_EDGES else outline, "<u4"),
        "outline": _text(outline, "<u4"),
        "size": float(result.mesh.size),
        "states": states,
        "what": _what(result),
        "left_out": left_out,
    }


def _lines(triangles: NDArray[np.integer]) -> tuple[NDArray[np.integer], NDArray[np.integer]]:
    """All sides of triangles, and those of one triangle only."""
    sides = np.sort(
        np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [0, 2]]]), axis=1
    )
    lines, counts = np.unique(sides, axis=0, return_counts=True)
    return lines, lines[counts == 1]


def _what(result: Result) -> str:
    if result.analysis in MODAL:
        return "mode"
    return "case" if result.cases else "step" if len(result.series) > 1 else "state"


def _parts(result: Result) -> Iterator[tuple[str, Result, str]]:
    """Name, result and field of displacements of every state of the view."""
    if result.analysis in MODAL:
        for number, entry in enumerate(result.eigen[:MOST_STATES], 1):
            value = entry["value"] if result.analysis == "buckling" else entry["frequency"]
            words = entry.get("name") or f"{value:.5g}{'' if result.analysis == 'buckling' else ' Hz'}"
            yield f"{number}: {words}", result, f"mode_{number}"
    elif result.cases:
        for name, case in list(result.cases.items())[:MOST_STATES]:
            yield name, case, "displacement"
    elif len(result.series) > 1:
        chosen = np.unique(np.linspace(0, len(result.series) - 1, MOST_STATES // 2).astype(int))
        for number in chosen.tolist():
            factor, make = result.series[number]
            yield f"{number}: {factor:.5g}", make(), "displacement"
    else:
        yield "result", result, "displacement"


def _largest(result: Result, field: str) -> float:
    return float(np.linalg.norm(result.fields[field], axis=1).max()) if field in result.fields else 0.0


def _states(result: Result, count: int) -> tuple[list[dict[str, Any]], list[str]]:
    parts, room = list(_parts(result)), MOST_BYTES
    states: list[dict[str, Any]] = []
    left_out: list[str] = []
    most = [_largest(part, moved) for _, part, moved in parts]
    if result.analysis not in MODAL:  # cases and steps are compared, shapes of modes have no size
        most = [max(most)] * len(most)
    for (name, _, _), size in zip(parts, most, strict=True):
        scale = SHOWN * result.mesh.size / size if size > 0 else 0.0
        states.append({"name": name, "scale": scale, "fields": [], "strokes": []})
    for field, (label, names) in FIELDS.items():
        found = [moved if field == "displacement" else field for _, _, moved in parts]
        modal = result.analysis in MODAL and field != "displacement"
        if modal or not all(key in part.fields for key, (_, part, _) in zip(found, parts, strict=True)):
            continue
        room -= 4 * count * max(1, len(names)) * len(parts)
        if room < 0 and field != "displacement":
            left_out.append(label)
            continue
        for state, key, (_, part, _) in zip(states, found, parts, strict=True):
            values = part.fields[key].reshape(len(part.fields[key]), -1)
            values = at_nodes(part.rows, key, values, part.fields, part.edge_fields)[:count]
            columns = [_text(column, "<f4") for column in values.T]
            state["fields"].append({"name": field, "label": label, "of": list(names), "columns": columns})
    if result.analysis not in MODAL and all(part.evaluate for _, part, _ in parts):
        for state, (_, part, _) in zip(states, parts, strict=True):
            state["strokes"] = _strokes(part)
    return states, left_out


def _strokes(result: Result) -> list[dict[str, Any]]:
    """Crosses and arrows at rest, and how their places move."""
    places = spread(Drawn(result, divided=False), 1.0)  # on the surface of the view
    moved = places.drawn - places.rest
    places = places._replace(drawn=places.rest, stretch=np.broadcast_to(np.eye(3), (len(moved), 3, 3)))
    values, out = result.at(places.rest), []
    for what, label in STROKES.items():
        found = strokes_at(places, values, what) if what in pictures(result) else []
        lines = []
        for each in found:
            side = np.cross(each.normals, each.lines[:, 1] - each.lines[:, 0])
            side *= 0.5 * THICK * places.apart / np.linalg.norm(side, axis=1, keepdims=True)
            numbers = np.concatenate([each.lines[:, 0], each.lines[:, 1], side, moved[each.place]], axis=1)
            lines.append({"colour": each.colour, "words": each.words, "numbers": _text(numbers, "<f4")})
        if lines:
            out.append({"label": label, "longest": found[0].longest, "lines": lines})
    return out


def _text(values: Any, kind: str) -> str:
    return b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode()
