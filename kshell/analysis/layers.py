"""Stresses of laminates at the faces of all layers, at the rows of fields: the largest need not be at an outer face."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.material.part import Layered
from kshell.material.plies import stresses_of_layers
from kshell.material.tensors import von_mises
from kshell.result.peaks import NO_CORNERS, near_peaks
from kshell.result.result import Result
from kshell.scene.loads import Load, Temperature
from kshell.scene.placed import Placed
from kshell.scene.structure import Structure
from kshell.scene.thermal import layers_left

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Warmth = Sequence[Placed[Load]]


@dataclass(frozen=True, eq=False)
class LayersAtRows:
    """Stresses of one laminate.

    Attributes
    ----------
    part : Layered
    rows : (n,) int array
        Rows of the fields.
    von_mises : (n, layer, 2)
        At the bottom and the top of every layer.
    """

    part: Layered
    rows: Ints
    von_mises: Floats

    def words(self, layer: int) -> str:
        """A layer for people, counted from the bottom."""
        return f"layer {layer + 1} of {len(self.part.stack.layers)}"


def left_in_layers(
    part: Layered, structure: Structure, warmth: Warmth, triangles: Ints, points: Floats
) -> Floats:
    """(n, layer, 2, 3) stresses that the layers of a part keep, at points (n, 3) of triangles (n,)."""
    out = np.zeros((len(triangles), len(part.stack.layers), 2, 3))
    offset = np.broadcast_to(structure.offset, (len(structure.space.triangles),))[triangles]
    for placed in warmth:
        if isinstance(placed.item, Temperature):
            here = np.isin(triangles, placed.members(structure.space))
            out[here] += layers_left(placed.item, part, points[here], offset[here])
    return out


def layers_at_rows(result: Result, structure: Structure, warmth: Warmth) -> list[LayersAtRows]:
    """Of every laminate, at the rows that its triangles have."""
    rows, fields, section = result.rows, result.fields, structure.section
    moment = np.asarray(fields["moment"])
    name = "membrane_stress_resultant"
    force = np.asarray(fields[name]) if name in fields else np.zeros_like(moment)
    count = len(structure.space.triangles)
    offset = np.broadcast_to(structure.offset, (count,))
    out = []
    for number, part in enumerate(section.parts):
        if not isinstance(part, Layered):
            continue
        mine = np.flatnonzero(section.part_numbers == number)
        row, first = np.unique(rows.corner[mine].ravel().astype(np.int64), return_index=True)
        triangle = np.repeat(mine, 3)[first]
        stress = left_in_layers(part, structure, warmth, triangle, rows.points[row])
        for height in np.unique(offset[triangle]):
            here = offset[triangle] == height
            some = row[here]
            stress[here] += stresses_of_layers(part.stack, force[some], moment[some], float(height))
        out.append(LayersAtRows(part, row, np.asarray(von_mises(stress))))
    return out


def add_largest(
    result: Result, structure: Structure, found: list[LayersAtRows], corners: Mapping[int, str] = NO_CORNERS
) -> None:
    """Add the extreme `von_mises_layers`, the largest at any face of any layer, farther from peaks than these reach."""
    far = ~near_peaks(result, structure, corners)
    best: dict[str, object] | None = None
    for layers in found:
        seen = np.where(far[layers.rows, None, None], layers.von_mises, -np.inf)
        n, k, side = np.unravel_index(int(np.argmax(seen)), seen.shape)
        value, row = float(seen[n, k, side]), int(layers.rows[n])
        if np.isfinite(value) and (best is None or value > float(best["value"])):  # type: ignore[arg-type]
            best = {
                "value": value,
                "face": f"{('bottom', 'top')[int(side)]} of {layers.words(int(k))}",
                "at": result.rows.points[row].tolist(),
                "group": str(result.rows.group[row]) or None,
            }
    if best is not None:
        result.extremes["von_mises_layers"] = best
