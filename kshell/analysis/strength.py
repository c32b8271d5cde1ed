"""What is derived from the stresses of a result: those of layers at probes, and how far materials are used.

`utilisation` is the largest von Mises stress at the bottom, in the middle and at the top over the yield stress there;
in a row of values that several materials share the smallest yield stress counts.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.material.part import Layered
from kshell.material.plies import ply_stresses
from kshell.result.result import Result
from kshell.scene.loads import Load, Temperature
from kshell.scene.structure import Placed, Structure
from kshell.scene.thermal import layers_left

Floats = NDArray[np.float64]
Warmth = Sequence[Placed[Load]]

FACES = ("bottom", "middle", "top")


def add_strength(result: Result, structure: Structure, warmth: Warmth = ()) -> None:
    """Add `layers` to the probes on laminates, and the field, extreme and probe values `utilisation`.

    Parameters
    ----------
    warmth : sequence of Placed
        The temperatures that act.
    """
    if any(isinstance(part, Layered) for part in structure.section.parts) and structure.direction is None:
        _add_layers(result, structure, warmth)
    limits = {
        face: structure.section.yield_stress(side) for face, side in zip(FACES, (-1, 0, 1), strict=True)
    }
    if all(np.isinf(limit).all() for limit in limits.values()):
        return
    _add_utilisation(result, limits)


def _places(result: Result) -> Iterator[tuple[dict[str, Any], int]]:
    """Values at every probe, and of every sheet at probes where several meet, with their triangles."""
    for (name, group), triangle in result.probe_triangles.items():
        yield result.sheets[name][group] if group else result.probes[name], triangle


def _add_layers(result: Result, structure: Structure, warmth: Warmth) -> None:
    for probe, triangle in _places(result):
        part = structure.section.part_of(triangle)
        if isinstance(part, Layered) and "M" in probe:
            force = probe.get("membrane_stress_resultant", probe["N"])
            offset = float(structure.offset[triangle])
            left = sum(
                layers_left(placed.item, structure.section, triangle, np.asarray(probe["x"]), offset)
                for placed in warmth
                if isinstance(placed.item, Temperature) and triangle in placed.members(structure.space)
            )
            own = None if np.ndim(left) == 0 else np.asarray(left)
            probe["layers"] = ply_stresses(part.stack, force, probe["M"], probe.get("Q"), offset, own)


def _add_utilisation(result: Result, limits: dict[str, Floats]) -> None:
    faces = [face for face in FACES if f"von_mises_{face}" in result.fields]
    if not faces:
        return
    rows, used = result.rows, []
    for face in faces:
        limit = np.full(len(rows.vertex), np.inf)
        np.minimum.at(limit, rows.corner.ravel(), np.repeat(limits[face], 3))
        used.append(np.ravel(result.fields[f"von_mises_{face}"]) / limit)
    result.fields["utilisation"] = utilisation = np.max(used, axis=0)
    which, place = np.unravel_index(int(np.argmax(used)), np.shape(used))
    result.extremes["utilisation"] = {
        "value": float(utilisation[place]),
        "face": faces[which],
        "at": rows.points[place].tolist(),
        "group": str(rows.group[place]) or None,
    }
    for probe, triangle in _places(result):
        shares = [
            float(probe[f"von_mises_{face}"]) / float(limits[face][triangle])
            for face in faces
            if f"von_mises_{face}" in probe
        ]
        if shares:
            probe["utilisation"] = max(shares)
