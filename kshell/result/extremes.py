"""Where fields are largest, over all rows, with the face and the surface group."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.result.deferred import Deferred
from kshell.result.rows import Rows

Floats = NDArray[np.float64]

FACES = ("top", "middle", "bottom")


def find_extremes(rows: Rows, fields: Mapping[str, Floats]) -> Deferred[dict[str, Any]]:
    """Largest deflection in size and largest von Mises stress on any face, each with its place and surface group.

    Of a plate, whose displacement is all along z, the deflection has its sign.
    """
    makers: dict[str, Callable[[], dict[str, Any]]] = {}
    if "displacement" in fields:
        makers["deflection"] = lambda: _deflection(
            rows, fields["displacement"], "membrane_force" not in fields
        )
    if any(f"von_mises_{face}" in fields for face in FACES):
        makers["von_mises"] = lambda: largest_stress(rows, fields)
    return Deferred(makers)


def _deflection(rows: Rows, u: Floats, along_z: bool) -> dict[str, Any]:
    size = np.abs(u[:, 2]) if along_z else np.linalg.norm(u, axis=1)
    place = int(np.argmax(size))
    return {"value": float(u[place, 2] if along_z else size[place]), **_where(rows, place)}


def largest_stress(
    rows: Rows, fields: Mapping[str, Floats], left_out: NDArray[np.bool_] | None = None
) -> dict[str, Any]:
    """Largest von Mises stress on any face, with place, face and surface group, except at the rows left out (row,)."""
    faces = [face for face in FACES if f"von_mises_{face}" in fields]
    values = np.stack([np.ravel(fields[f"von_mises_{face}"]) for face in faces])
    seen = values if left_out is None else np.where(left_out, -np.inf, values)
    face, place = np.unravel_index(int(np.argmax(seen)), values.shape)
    return {"value": float(values[face, place]), "face": faces[face], **_where(rows, int(place))}


def _where(rows: Rows, place: int) -> dict[str, Any]:
    return {"at": rows.points[place].tolist(), "group": str(rows.group[place]) or None}
